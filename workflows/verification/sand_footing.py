"""Rigid footings on Mohr-Coulomb sand with associated flow, finite elements in small strain.

The limit load of a footing of width (diameter) B under one cause of strength at a time:

    p = q N_q ,   p = c N_c ,   p = (gamma B / 2) N_gamma

with a surcharge q on weightless soil without cohesion, with cohesion alone, or with weight alone.
No cohesion is added where there is none.  The undisturbed stress is isotropic in the horizontal
and vertical direction (K0 = 1), far from yield; the limit load does not depend on it.  As on clay,
finite elements approach the limit load from above, with an error of first order in the size of the
elements at the edge of the footing.
"""

from __future__ import annotations

from enum import Enum

import numpy as np

from handoff.fe_mesh import FEMesh
from handoff.fe_state_file import FEState
from handoff.geostatic import elastic_strain_of
from install_mpm.constitutive.parameters import CoulombInterface, MohrCoulomb
from install_mpm.conventions import Kinematics
from install_mpm.ground import Ground
from service_fe.newton import StepNotConvergedError
from service_fe.options import ServiceNumerics
from service_fe.problem import ServiceProblem
from service_fe.rigid_pile import held
from service_fe.step import Step, Unknowns
from workflows.verification.circular_footing import footing_supports
from workflows.verification.footing_curve import FootingCurve
from workflows.verification.strip_footing_fe import footing_mesh

SIZE_FAR, GROWTH = 0.5, 0.1
"""Edge length far away over B, and its growth with the distance from the footing's edge."""
STEPS = 20
MOST_HALVINGS = 6
"""A step that does not converge is cut into at most two to this power."""


class Strength(Enum):
    """What carries the footing."""

    SURCHARGE = "N_q"
    COHESION = "N_c"
    WEIGHT = "N_gamma"


def sand_footing(
    size_at_edge: float,
    strength: Strength,
    expected: float,
    *,
    friction_angle: float,
    is_rough: bool,
    kinematics: Kinematics = Kinematics.PLANE_STRAIN,
    width: float = 1.0,
    unit: float = 10e3,
    cohesion: float = 0.0,
    rigidity_index: float = 1e4,
    poissons_ratio: float = 0.3,
    relative_settlement: float = 8.0,
) -> FootingCurve:
    """Return the curve of a rigid footing that is pushed down in steps that grow.

    Parameters
    ----------
    size_at_edge
        Edge length of the elements at the edge of the footing over its width.
    expected
        Bearing capacity factor by which the settlement is scaled.
    friction_angle
        In rad; the dilation angle is the same.
    width
        Width or diameter B in m.
    unit
        q, c or gamma B / 2 in Pa.
    cohesion
        Cohesion in Pa beside surcharge or weight.
    rigidity_index
        Young's modulus over ``unit``; it only scales the settlement.
    relative_settlement
        Final settlement times E / (unit expected B); the plateau begins near 2.

    Raises
    ------
    StepNotConvergedError
        If a step does not converge in parts either.
    """
    mesh = sand_mesh(size_at_edge, friction_angle, width, strength)
    is_fixed, under_footing = footing_supports(mesh, 0.5 * width, is_rough=is_rough)
    problem = ServiceProblem(
        mesh,
        _sand(strength, friction_angle, width, unit, cohesion, rigidity_index, poissons_ratio),
        CoulombInterface(1.0, 1.0),
        numerics=ServiceNumerics(max_iterations=40, tolerance=1e-8),
        is_fixed=is_fixed,
        kinematics=kinematics,
    )
    surcharge = unit if strength == Strength.SURCHARGE else 0.0
    settlement = relative_settlement * expected / rigidity_index
    parts = settlement * np.linspace(0.0, 1.0, STEPS + 1) ** 1.5
    accepted = push(problem, under_footing, np.diff(parts) * width, surcharge)
    motion = [-step.increment.displacement[under_footing, 1].mean() for step in accepted]
    area = 0.25 * np.pi * width**2 if kinematics == Kinematics.AXISYMMETRIC else 0.5 * width
    loads = np.array([-step.support_reaction[under_footing, 1].sum() for step in accepted])
    return FootingCurve(
        settlement=np.cumsum(motion) / width,
        bearing_factor=(surcharge + loads / area) / unit,
        residuals=tuple(step.residuals for step in accepted),
    )


def _sand(
    strength: Strength,
    friction_angle: float,
    width: float,
    unit: float,
    cohesion: float,
    rigidity_index: float,
    poissons_ratio: float,
) -> Ground:
    """Return the sand, whose ``strength`` is of the size ``unit``; see ``sand_footing``."""
    own_cohesion = unit if strength == Strength.COHESION else cohesion
    soil = MohrCoulomb(
        rigidity_index * unit, poissons_ratio, own_cohesion, friction_angle, friction_angle
    )
    return Ground(2.0 * unit / width if strength == Strength.WEIGHT else 0.0, 1.0, soil)


def sand_mesh(
    size_at_edge: float, friction_angle: float, width: float, strength: Strength
) -> FEMesh:
    """Return a mesh that holds Prandtl's mechanism; with weight alone it reaches less far."""
    angle = 0.25 * np.pi + 0.5 * friction_angle
    spiral = 0.5 / np.cos(angle) * np.exp(0.5 * np.pi * np.tan(friction_angle))
    reach = 2.0 * spiral * np.sin(angle) * (0.75 if strength == Strength.WEIGHT else 1.0)
    return footing_mesh(
        width,
        size_at_edge * width,
        SIZE_FAR * width,
        side=1.2 * reach + 0.9,
        depth=0.5 * reach + 0.5,
        growth=GROWTH,
    )


def push(
    problem: ServiceProblem, under_footing: np.ndarray, settlements: np.ndarray, surcharge: float
) -> list[Step]:
    """Return the accepted steps of a footing pushed down by ``settlements`` (step,) in m.

    Negative ones lift it.  A step that does not converge is cut.  All nodes are loaded by what
    holds the undisturbed stress; so the reaction of the footing lacks the surcharge on its area.
    """
    state = _with_pressure(problem, surcharge)
    external = problem.internal_force(state) if surcharge else problem.gravity(state)
    accepted: list[Step] = []
    left = [(settlement, 0) for settlement in settlements[::-1]]
    while left:
        settlement, halvings = left.pop()
        motion = np.zeros_like(problem.mesh.nodes)
        motion[under_footing, 1] = -settlement
        try:
            step = problem.solve(
                state,
                held(),
                support_motion=motion,
                external_force=external,
                guess=_guess(accepted, under_footing, settlement),
            )
        except StepNotConvergedError:
            if halvings == MOST_HALVINGS:
                raise
            left += [(0.5 * settlement, halvings + 1)] * 2
            continue
        accepted.append(step)
        state = step.state
    return accepted


def _guess(accepted: list[Step], under_footing: np.ndarray, settlement: float) -> Unknowns | None:
    """Return the increment of the last step, scaled to ``settlement`` in m."""
    if not accepted:
        return None
    last = accepted[-1].increment
    return last.scaled(-settlement / float(last.displacement[under_footing, 1].mean()))


def _with_pressure(problem: ServiceProblem, pressure: float) -> FEState:
    """Return the undisturbed state under an additional isotropic ``pressure`` in Pa."""
    state = problem.wished_in_place_state()
    stress = state.cauchy_stress - pressure * np.eye(3)
    strain = elastic_strain_of(problem.ground, state.material, stress, state.state_variables)
    return state._replace(cauchy_stress=stress, elastic_strain=strain)
