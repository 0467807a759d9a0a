"""Uniform pressure on a circle on an elastic half space: settlement, and stress on the axis.

A part of 200 radii is modelled, on rollers at its side and fixed at its bottom: it settles less by
almost the ratio of radius to extent.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from handoff.fe_mesh import FacetTag
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic
from install_mpm.conventions import Kinematics, Unit
from install_mpm.ground import Ground
from service_fe.problem import ServiceProblem
from service_fe.rigid_pile import held
from service_fe.step import Step
from workflows.verification.problem import Outcome, Problem, Series, relative
from workflows.verification.references.discs import circular_load_settlement, circular_load_stress
from workflows.verification.revolution import half_space_mesh, pressure_force

EXTENT = 200.0
"""Radius and depth of the modelled ground over the radius of the load."""

SIZE_AT_EDGE, GROWTH = 0.05, 0.1
"""Edge length of the elements at the load's edge over its radius, and its growth per distance."""

DEPTHS = (0.5, 1.0, 2.0)
"""Depths below the centre, over the radius, at which the vertical stress is compared."""

TOLERANCE = 0.01


def pd7(
    *,
    R: Annotated[float, Unit("m")] = 1.0,
    q: Annotated[float, Unit("Pa")] = 100e3,
    E: Annotated[float, Unit("Pa")] = 10e6,
    nu: float = 0.3,
) -> Outcome:
    """The pressure q acts on a circle of radius R on an elastic half space.

    Centre 2 (1 - nu^2) q R / E, edge 2 / pi times that.  The model is 200 R wide and deep.
    """
    problem = _half_space(R, E, nu)
    mesh = problem.mesh
    r, z = mesh.nodes.T
    middle = mesh.nodes[mesh.facet_nodes[:, 2], 0]
    is_loaded = (mesh.facet_tag == FacetTag.SURFACE) & (middle < R)
    force = q * pressure_force(mesh, is_loaded)
    step = problem.solve(problem.wished_in_place_state(), held(), external_force=force)

    on_surface = np.flatnonzero((np.abs(z) < 1e-9 * R) & (r < 4.0 * R))
    on_surface = on_surface[np.argsort(r[on_surface])]
    x, settlement = r[on_surface], -step.increment.displacement[on_surface, 1]
    exact = circular_load_settlement(
        x, pressure=q, load_radius=R, youngs_modulus=E, poissons_ratio=nu
    )
    edge = int(np.argmin(np.abs(x - R)))
    stress = np.array([_stress_on_axis(problem, step, depth * R, R) for depth in DEPTHS])
    exact_stress = circular_load_stress(np.array(DEPTHS) * R, pressure=q, load_radius=R)
    total = np.pi * R**2 * q
    return Outcome(
        checks=(
            relative("settlement of the centre (m)", settlement[0], exact[0], TOLERANCE),
            relative("settlement of the edge (m)", settlement[edge], exact[edge], TOLERANCE),
            *(
                relative(f"vertical stress at z = {depth:g} R (Pa)", here, there, TOLERANCE)
                for depth, here, there in zip(DEPTHS, stress, exact_stress, strict=True)
            ),
            relative("reaction of the supports (N)", _reaction(step), total, 1e-6),
        ),
        series=(
            Series(
                "settlement of the surface",
                "r / R",
                "settlement (m)",
                tuple(x / R),
                tuple(settlement),
                tuple(exact),
            ),
        ),
        residual_histories=(step.residuals,),
    )


def _half_space(radius: float, youngs_modulus: float, poissons_ratio: float) -> ServiceProblem:
    mesh = half_space_mesh(radius, EXTENT * radius, SIZE_AT_EDGE * radius, GROWTH)
    return ServiceProblem(
        mesh,
        Ground(0.0, 1.0, HenckyElastic(youngs_modulus, poissons_ratio)),
        CoulombInterface(1.0, 1.0),
        kinematics=Kinematics.AXISYMMETRIC,
    )


def _stress_on_axis(problem: ServiceProblem, step: Step, depth: float, radius: float) -> float:
    """Return the vertical stress in Pa: the even quadratic through the points within 0.3 R."""
    r, z = problem.integration_positions.T / radius
    z = z + depth / radius
    near = np.hypot(r, z) < 0.3
    terms = np.column_stack([np.ones_like(r), z, z**2, r**2])[near]
    stress = step.state.cauchy_stress[near, 1, 1]
    coefficients: np.ndarray = np.linalg.lstsq(terms, stress, rcond=None)[0]
    return float(coefficients[0])


def _reaction(step: Step) -> float:
    return float(step.support_reaction[:, 1].sum())


PROBLEM = Problem("PD7", "Flexible circular load on a half space", pd7, is_quick=True)
