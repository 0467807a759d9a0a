"""Equilibration: the out-of-balance force of the transferred state is released in ramps, pile held.

The transferred stresses balance gravity only up to the error of the transfer,

    r_0 = f_ext - f_int(state_0) .

The residual force is kept on the model as an artificial load and removed in ramps, r = (1 - lambda)
r_0 with lambda from 0 to 1, while the pile is held and the soil deforms elastoplastically.
Displacements are then set to zero; stress, state and interface traction are kept.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from handoff.fe_state_file import FEState


class EquilibrationError(RuntimeError):
    """The transferred state cannot be brought to equilibrium; the message says what to change."""


class ReleasedState(NamedTuple):
    """What ``EquilibriumProblem.release`` returns."""

    state: FEState
    displacement: np.ndarray
    """Displacement (node, 2) in m of this release alone."""
    iterations: int
    """Newton iterations."""


class EquilibriumProblem(Protocol):
    """A finite-element model with a rigid pile, as the hand-over sees it.

    ``service_fe.problem`` satisfies it.  Points keep their order for the life of the object; forces
    and areas are those of the modelled half.
    """

    @property
    def integration_positions(self) -> np.ndarray:
        """Positions (n_q, 2) in m of the integration points of the soil."""

    @property
    def integration_volumes(self) -> np.ndarray:
        """Integration weights (n_q,) in m^3, per metre run."""

    @property
    def interface_positions(self) -> np.ndarray:
        """Positions (n_i, 2) in m of the integration points of the interface."""

    @property
    def interface_areas(self) -> np.ndarray:
        """Integration weights (n_i,) in m^2, per metre run."""

    @property
    def interface_normals(self) -> np.ndarray:
        """Exact unit normals (n_i, 2) from soil to pile."""

    @property
    def interface_parts(self) -> np.ndarray:
        """``PilePart`` (n_i,) int64 of each interface point."""

    def out_of_balance(self, state: FEState) -> float:
        """Return |f_ext - f_int(state)| at the free nodes over the weight of the soil, pile held.

        f_ext is gravity, f_int comes from the soil's stress and the interface's traction.
        """

    def release(self, state: FEState, share: float) -> ReleasedState:
        """Return the state when ``share`` (0 to 1] of the out-of-balance force has gone, pile held.

        Solves f_int(new) = f_ext - (1 - share) (f_ext - f_int(state)), elastoplastic from ``state``.

        Raises
        ------
        EquilibrationError
            If Newton's method does not converge.
        """
