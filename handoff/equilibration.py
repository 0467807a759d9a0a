"""Equilibration: the out-of-balance force of the transferred state is released in ramps.

The transferred stresses balance gravity only up to the error of the transfer,

    r_0 = f_ext - f_int(state_0) .

The residual force is kept on the model as an artificial load and removed in ramps, r = (1 - lambda)
r_0 with lambda from 0 to 1, while the soil deforms elastoplastically.  A pile in the rig's grip
stays in its place.  One that the rig has let go of carries a known load, so it is free to move, and
what the soil does to it goes to that load in the same ramps.  Displacements are then set to zero;
stress, state and interface traction are kept.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from handoff.fe_state_file import FEState
from handoff.options import HandoffOptions

HALVINGS = 4
"""How often a ramp that does not converge is halved."""


class EquilibrationError(RuntimeError):
    """The transferred state cannot be brought to equilibrium; the message says what to change."""


class ReleasedState(NamedTuple):
    """What ``EquilibriumProblem.release`` returns."""

    state: FEState
    displacement: np.ndarray
    """Displacement (node, dim) in m of this release alone."""
    pile_displacement: np.ndarray
    """Displacement (n_i, dim) in m of the pile beside the interface points in it."""
    iterations: int
    """Newton iterations."""


class EquilibriumProblem(Protocol):
    """A finite-element model with a rigid pile, as the hand-over sees it.

    ``service_fe.problem`` satisfies it.  Points keep their order for the life of the object; forces
    and areas are those of the modelled half of a wall, or of the whole pile.
    """

    @property
    def integration_positions(self) -> np.ndarray:
        """Positions (n_q, dim) in m of the integration points of the soil."""

    @property
    def integration_volumes(self) -> np.ndarray:
        """Integration weights (n_q,) in m^3, per metre run."""

    @property
    def own_points(self) -> np.ndarray:
        """Integration points (n,) that this rank of MPI maps; all of them if there is one rank."""

    def whole(self, values: np.ndarray) -> np.ndarray:
        """Return values (n_q, ...) of all integration points from those (n, ...) of each rank."""

    @property
    def interface_positions(self) -> np.ndarray:
        """Positions (n_i, dim) in m of the integration points of the interface."""

    @property
    def interface_areas(self) -> np.ndarray:
        """Integration weights (n_i,) in m^2, per metre run."""

    @property
    def interface_normals(self) -> np.ndarray:
        """Exact unit normals (n_i, dim) from soil to pile."""

    @property
    def interface_facet_normals(self) -> np.ndarray:
        """Unit normals (n_i, dim) of the facets, which are plane."""

    @property
    def interface_strength_share(self) -> np.ndarray:
        """Shear strength (n_i,) of the exact surface over that of the facets."""

    @property
    def interface_parts(self) -> np.ndarray:
        """Part of the pile (n_i,) int64 of each interface point."""

    def out_of_balance(self, state: FEState) -> float:
        """Return |f_ext - f_int(state)| at the free nodes over the weight of the soil, pile held.

        f_ext is gravity, f_int comes from the soil's stress and the interface's traction.
        """

    def release(
        self, state: FEState, share: float, on_pile: np.ndarray | None = None
    ) -> ReleasedState:
        """Return the state when ``share`` (0 to 1] of the out-of-balance force has gone.

        Solves f_int(new) = f_ext - (1 - share) (f_ext - f_int(state)), elastoplastically.  The pile
        is held, or moves so that force and moment of the soil on it, (n_motions,) in N and N m,
        have gone by the same share to ``on_pile``.

        Raises
        ------
        EquilibrationError
            If Newton's method does not converge.
        """


class EquilibrationReport(NamedTuple):
    """What the equilibration changed."""

    out_of_balance_before: float
    """Out-of-balance force of the transferred state over the weight of the soil."""
    out_of_balance_after: float
    """The same at the end."""
    stress_change: float
    """Norm of the stress change over the norm of the stress (L2 over the soil)."""
    largest_displacement: float
    """Largest nodal displacement in m."""
    pile_displacement: float
    """Largest displacement in m of the surface of the pile."""
    iterations: tuple[int, ...]
    """Newton iterations of each ramp."""


def equilibrate(
    problem: EquilibriumProblem,
    state: FEState,
    options: HandoffOptions,
    on_pile: np.ndarray | None = None,
) -> tuple[FEState, EquilibrationReport]:
    """Return the state in equilibrium with gravity, and what that changed.

    ``on_pile`` is what the soil does to a pile that is free to move, see ``release``; by default it
    is held, and a state that balances gravity to ``max_out_of_balance`` is returned as it is.

    Raises
    ------
    EquilibrationError
        If a ramp does not converge after ``HALVINGS`` halvings, or if the out-of-balance force left
        exceeds ``max_out_of_balance``.
    """
    before = problem.out_of_balance(state)
    if on_pile is None and before <= options.max_out_of_balance:
        return state, EquilibrationReport(before, before, 0.0, 0.0, 0.0, ())
    balanced, moved, iterations = _released(problem, state, options.equilibration_steps, on_pile)
    after = problem.out_of_balance(balanced)
    if not after <= options.max_out_of_balance:
        raise EquilibrationError(
            f"after equilibration {after:.2g} of the soil's weight is out of balance, more than"
            f" handoff.max_out_of_balance = {options.max_out_of_balance:.2g};"
            " tighten service.tolerance"
        )
    report = EquilibrationReport(
        out_of_balance_before=before,
        out_of_balance_after=after,
        stress_change=_stress_change(problem.integration_volumes, state, balanced),
        largest_displacement=_largest(moved.soil),
        pile_displacement=_largest(moved.pile),
        iterations=iterations,
    )
    return balanced._replace(pile_displacement=np.zeros_like(state.pile_displacement)), report


class _Moved(NamedTuple):
    """Displacements in m since the transfer, of nodes (node, dim) and of the pile (n_i, dim)."""

    soil: np.ndarray
    pile: np.ndarray


def _released(
    problem: EquilibriumProblem, state: FEState, n_ramps: int, on_pile: np.ndarray | None
) -> tuple[FEState, _Moved, tuple[int, ...]]:
    """Return the state with nothing left out of balance, the displacements and the iterations."""
    lifted, ramp = 0.0, 1.0 / n_ramps
    moved = _Moved(np.zeros(1), np.zeros(1))
    iterations: list[int] = []
    while lifted < 1.0:
        target = lifted + ramp if lifted + 1.001 * ramp < 1.0 else 1.0
        try:
            step = problem.release(state, (target - lifted) / (1.0 - lifted), on_pile)
        except EquilibrationError as error:
            ramp *= 0.5
            if ramp * n_ramps < 0.5**HALVINGS:
                raise EquilibrationError(
                    f"the transferred state cannot be equilibrated: Newton's method failed after"
                    f" {lifted:.0%} of the out-of-balance force was released ({error});"
                    " refine the finite-element mesh or increase handoff.equilibration_steps"
                ) from error
            continue
        state, lifted = step.state, target
        moved = _Moved(moved.soil + step.displacement, moved.pile + step.pile_displacement)
        iterations.append(step.iterations)
    return state, moved, tuple(iterations)


def _largest(displacement: np.ndarray) -> float:
    """Return the largest length in m of displacements (n, dim)."""
    return float(np.linalg.norm(displacement, axis=-1).max(initial=0.0))


def _stress_change(volumes: np.ndarray, before: FEState, after: FEState) -> float:
    """Return the volume-weighted norm of the stress change over that of the stress before."""
    change = ((after.cauchy_stress - before.cauchy_stress) ** 2).sum(axis=(1, 2))
    stress = (before.cauchy_stress**2).sum(axis=(1, 2))
    return float(np.sqrt((volumes @ change) / (volumes @ stress)))
