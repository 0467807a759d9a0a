"""PD5: a long elastic pile under a horizontal force at its head, in space.

A quarter of the ground is modelled, held at its side and bottom; the pile, meshed inside, shares
its nodes with the ground and has the bending stiffness of the circle.  Its length is one and a half
times the critical one, beyond which the formula knows no influence.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from handoff.fe_mesh import FEMesh
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic
from install_mpm.conventions import Kinematics, Unit
from service_fe.problem import ServiceProblem
from service_fe.rigid_pile import held
from service_fe.step import Step
from workflows.verification.elastic_pile import ground_and_pile, with_pile
from workflows.verification.problem import Outcome, Problem, relative
from workflows.verification.references.piles import lateral_head
from workflows.verification.round_ground import (
    QUARTERS,
    equal_inertia,
    round_mesh,
    round_solid,
    supports,
    surface_within,
)
from workflows.verification.solid_boundary import nodal_areas

SECTORS = 4
RADII = (0.0, 0.6, 1.0, 1.4, 2.0, 3.0, 5.0, 9.0, 18.0, 40.0, 100.0)
"""Lines of the mesh over the radius of the pile."""

LENGTH = 1.5
"""Of the pile over its critical length."""

DEPTHS = (
    0.0, 0.02, 0.045, 0.08, 0.12, 0.17, 0.23, 0.3, 0.38, 0.48, 0.6, 0.75, 0.9, 1.0, 1.15, 1.5, 2.3,
    4.0,
)  # fmt: skip
"""Lines of the mesh over the length of the pile."""

TOLERANCE = 0.15


def pd5(
    *,
    r0: Annotated[float, Unit("m")] = 0.5,
    Ep: Annotated[float, Unit("Pa")] = 30e9,
    G: Annotated[float, Unit("Pa")] = 10e6,
    nu: float = 0.3,
    H: Annotated[float, Unit("N")] = 100e3,
) -> Outcome:
    """The force H moves the head of a long pile at the surface of elastic ground.

    The reference is Randolph's fit, good to 10-15 %; free head and head that cannot rotate.
    """
    exact = lateral_head(
        force=H, radius=r0, pile_modulus=Ep, shear_modulus=G, poissons_ratio=nu
    )  # fmt: skip
    length = LENGTH * exact.critical_length
    radii = r0 * equal_inertia(4 * SECTORS) * np.array(RADII)
    mesh = round_mesh(round_solid(radii, length * np.array(DEPTHS), SECTORS))
    soils = (HenckyElastic(2.0 * (1.0 + nu) * G, nu), HenckyElastic(Ep, nu))
    free, moved, turned = _free_head(mesh, soils, radii[2], length, H)
    fixed, stiffness = _fixed_head(mesh, soils, radii[2], length)
    return Outcome(
        (
            relative("displacement of the free head (m)", moved, exact.displacement, TOLERANCE),
            relative("rotation of the free head (rad)", turned, exact.rotation, TOLERANCE),
            relative("displacement of the fixed head (m)", H / stiffness,
                     exact.displacement_fixed, TOLERANCE),
        ),
        residual_histories=(free.residuals, fixed.residuals),
    )  # fmt: skip


def _problem(
    mesh: FEMesh, soils: tuple[HenckyElastic, HenckyElastic], is_fixed: np.ndarray
) -> ServiceProblem:
    depth = -float(mesh.nodes[:, 2].min())
    return ServiceProblem(
        mesh, ground_and_pile(*soils, depth), CoulombInterface(1.0, 1.0), is_fixed=is_fixed,
        kinematics=Kinematics.THREE_D,
    )  # fmt: skip


def _solve(
    problem: ServiceProblem, radius: float, length: float, force: np.ndarray, motion: np.ndarray
) -> Step:
    place = problem.integration_positions
    is_pile = (np.hypot(place[:, 0], place[:, 1]) < radius) & (place[:, 2] > -length)
    state = with_pile(problem, is_pile)
    return problem.solve(state, held(3), external_force=force, support_motion=motion)


def _free_head(
    mesh: FEMesh,
    soils: tuple[HenckyElastic, HenckyElastic],
    radius: float,
    length: float,
    load: float,
) -> tuple[Step, float, float]:
    """Return the step, and mean displacement in m and rotation in rad of the head."""
    areas = nodal_areas(mesh, surface_within(mesh, radius))
    force = np.zeros_like(mesh.nodes)
    force[:, 0] = load / QUARTERS * areas / areas.sum()
    problem = _problem(mesh, soils, supports(mesh, "odd", "even"))
    step = _solve(problem, radius, length, force, np.zeros_like(force))
    along, _, upward = step.increment.displacement.T
    x = mesh.nodes[:, 0]
    rotation = -(areas * x) @ upward / ((areas * x) @ x)
    return step, float(areas @ along / areas.sum()), float(rotation)


def _fixed_head(
    mesh: FEMesh, soils: tuple[HenckyElastic, HenckyElastic], radius: float, length: float
) -> tuple[Step, float]:
    """Return the step, and the force in N per m of displacement of a head that cannot rotate."""
    is_head = np.unique(mesh.facet_nodes[surface_within(mesh, radius)])
    is_fixed = supports(mesh, "odd", "even")
    is_fixed[is_head] = True
    motion = np.zeros_like(mesh.nodes)
    motion[is_head, 0] = 1e-3 * radius
    problem = _problem(mesh, soils, is_fixed)
    step = _solve(problem, radius, length, np.zeros_like(motion), motion)
    force = QUARTERS * float(step.support_reaction[is_head, 0].sum())
    return step, force / (1e-3 * radius)


PROBLEM = Problem("PD5", "Head of a long elastic pile, lateral", pd5, is_quick=False)
