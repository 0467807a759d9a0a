"""PF6: finite elements to material points and back, under half the capacity of a strip footing.

The stress goes to points that stand elsewhere and from them back to the same mesh, by the transfer
of the hand-over each time, and is brought to equilibrium with the footing held.  The footing is
then pushed on.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from handoff.admissible import admissible_state
from handoff.equilibration import equilibrate
from handoff.fe_mesh import FEMesh
from handoff.fe_state_file import FEState
from handoff.geostatic import elastic_strain_of
from handoff.options import HandoffOptions
from handoff.transfer import transfer_least_squares
from install_mpm.constitutive.parameters import CoulombInterface, Tresca
from install_mpm.conventions import Unit
from install_mpm.ground import Ground
from service_fe.options import ServiceNumerics
from service_fe.problem import ServiceProblem, roller_supports
from service_fe.rigid_pile import held
from service_fe.step import Step
from workflows.verification.body import ProblemNotSolvedError
from workflows.verification.problem import Outcome, Problem, Series, relative
from workflows.verification.strip_footing_fe import EXACT, footing_mesh

SIZE, POINT_SIZE, SIZE_FAR = 0.01, 0.005, 0.35
"""Cells of the mesh, and of the one whose integration points are the material points, over B."""

SETTLEMENT, STEPS = 40.0, 40
"""Settlement E / (s_u B) at the end, and steps to it."""

NEIGHBOURS = 8


class Footing(NamedTuple):
    """A rough strip footing on clay."""

    problem: ServiceProblem
    is_under: np.ndarray
    """Nodes (node,) below the footing."""
    motion: np.ndarray
    """Of a step, (node, 2) in m."""

    def push(self, state: FEState, guess: Step | None, share: float = 1.0) -> Step:
        """Return the step that pushes the footing down, or by none if ``share`` is zero."""
        return self.problem.solve(
            state, held(), support_motion=share * self.motion,
            guess=guess.increment if guess else None,
        )  # fmt: skip

    def load(self, step: Step) -> float:
        """Return the load in N per metre run on the whole footing."""
        return float(-2.0 * step.support_reaction[self.is_under, 1].sum())


def pf6(
    *,
    B: Annotated[float, Unit("m")] = 1.0,
    su: Annotated[float, Unit("Pa")] = 10e3,
    gamma: Annotated[float, Unit("N/m^3")] = 18e3,
    E_over_su: float = 500.0,
    nu: float = 0.49,
) -> Outcome:
    """A footing under half its capacity (2 + pi) su B goes through a zero increment of remeshing.

    Its load may change by 1 %, the capacity that it reaches afterwards by 2 %.
    """
    soil = Tresca(E_over_su * su, nu, su)
    footing = _footing(B, Ground(gamma, 1.0, soil))
    half = _to_load(footing, 0.5 * EXACT * su * B)
    carried = _carried(footing.problem, half[-1].state, B)
    before = footing.load(half[-1])
    restart = footing.push(carried, None, 0.0)
    steps = STEPS - len(half)
    alone = half + _pushed(footing, half[-1].state, steps, half[-1])
    after = [restart, *_pushed(footing, restart.state, steps, None)]
    capacity, kept = footing.load(after[-1]), footing.load(alone[-1])
    place = SETTLEMENT * np.arange(len(half), STEPS + 1) / STEPS
    return Outcome(
        (
            relative("load on restart (N/m)", footing.load(restart), before, 0.01),
            relative("capacity after the round trip (N/m)", capacity, kept, 0.02),
        ),
        (Series("Load of the footing after the round trip", "settlement E / (su B)", "load (kN/m)",
                tuple(place), tuple(1e-3 * footing.load(step) for step in after),
                tuple(1e-3 * footing.load(step) for step in alone[len(half) - 1:])),),
        residual_histories=tuple(step.residuals for step in (*alone, *after[1:])),
    )  # fmt: skip


def _footing(width: float, ground: Ground) -> Footing:
    mesh = footing_mesh(width, SIZE * width, SIZE_FAR * width)
    x, z = mesh.nodes.T
    is_under = (np.abs(z) < 1e-9 * width) & (x < (0.5 + 1e-9) * width)
    is_fixed = roller_supports(mesh)
    is_fixed[is_under] = True
    problem = ServiceProblem(
        mesh, ground, CoulombInterface(1.0, 1.0),
        numerics=ServiceNumerics(max_iterations=30), is_fixed=is_fixed,
    )  # fmt: skip
    soil = ground.soil
    assert isinstance(soil, Tresca)
    motion = np.zeros_like(mesh.nodes)
    end = SETTLEMENT * soil.undrained_shear_strength / soil.youngs_modulus * width
    motion[is_under, 1] = -end / STEPS
    return Footing(problem, is_under, motion)


def _to_load(footing: Footing, wanted: float) -> list[Step]:
    """Return the steps up to the first that carries more than ``wanted`` in N/m.

    Raises
    ------
    ProblemNotSolvedError
        If none does.
    """
    state, accepted = footing.problem.wished_in_place_state(), list[Step]()
    at_rest = footing.load(footing.push(state, None, 0.0))
    while len(accepted) < STEPS:
        accepted += _pushed(footing, state, 1, accepted[-1] if accepted else None)
        state = accepted[-1].state
        if footing.load(accepted[-1]) - at_rest >= wanted:
            return accepted
    raise ProblemNotSolvedError("PF6: the footing does not reach half its capacity")


def _pushed(footing: Footing, state: FEState, steps: int, guess: Step | None) -> list[Step]:
    accepted = list[Step]()
    for _ in range(steps):
        guess = footing.push(state, guess)
        accepted.append(guess)
        state = guess.state
    return accepted


def _carried(problem: ServiceProblem, state: FEState, width: float) -> FEState:
    """Return ``state`` after its way to material points and back, admissible and in equilibrium."""
    places, volumes = _material_points(footing_mesh(width, POINT_SIZE * width, SIZE_FAR * width))
    here, weights = problem.integration_positions, problem.integration_volumes
    geostatic = problem.wished_in_place_state()
    change = state.cauchy_stress - geostatic.cauchy_stress
    at_points = transfer_least_squares(here, weights, change, places, NEIGHBOURS)
    back = transfer_least_squares(places, volumes, at_points, here, NEIGHBOURS)
    stress = geostatic.cauchy_stress + back
    strain = elastic_strain_of(problem.ground, state.material, stress, state.state_variables)
    raw = state._replace(cauchy_stress=stress, elastic_strain=strain)
    law, surface = CoulombInterface(1.0, 1.0), problem.interface_positions
    share = problem.interface_strength_share
    admissible, _ = admissible_state(problem.ground, law, surface, share, raw)
    options = HandoffOptions(size_at_pile=SIZE * width, size_far=SIZE_FAR * width)
    return equilibrate(problem, admissible, options)[0]


def _material_points(mesh: FEMesh) -> tuple[np.ndarray, np.ndarray]:
    """Return places (n, 2) in m and volumes (n,) of three points in each cell."""
    corners = mesh.nodes[mesh.cell_nodes[:, :3]]
    shares = np.full((3, 3), 1.0 / 6.0) + 0.5 * np.eye(3)
    areas = 0.5 * np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1]))
    places = np.einsum("qk,ckd->cqd", shares, corners).reshape(-1, 2)
    return places, np.repeat(areas / 3.0, 3)


PROBLEM = Problem("PF6", "Round trip under half the capacity", pf6, is_quick=False)
