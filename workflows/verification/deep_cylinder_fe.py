"""PB6 with the elements and the rigid pile of the service stage; see ``deep_cylinder``."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from handoff.facet_points import FacetPoints
from handoff.fe_mesh import FacetTag, FEMesh
from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.conventions import Unit
from install_mpm.ground import Ground
from service_fe.options import ServiceNumerics
from service_fe.problem import ServiceProblem
from service_fe.rigid_pile import PileControl
from service_fe.step import Step
from workflows.verification.deep_cylinder import (
    FLAT,
    ROUND_OFF,
    SPRING,
    SYMMETRY,
    curve,
    polar_lines,
)
from workflows.verification.polar_mesh import polar_mesh
from workflows.verification.problem import Check, Outcome, Problem, Series, at_most, relative
from workflows.verification.references.bearing_capacity import deep_cylinder_factor
from workflows.verification.revolution import boundary_edges


def deep_cylinder(
    *,
    alpha_1: float = 0.0,
    alpha_2: float = 0.5,
    alpha_3: float = 1.0,
    R: Annotated[float, Unit("m")] = 1.0,
    su: Annotated[float, Unit("Pa")] = 10e3,
    E_over_su: float = 2e4,
    nu: float = 0.49,
    displacement: float = 30.0,
    outer_ratio: float = 8.0,
    size: float = 0.1,
    steps: int = 15,
) -> Outcome:
    """A rigid cylinder is pushed sideways: resistance over s_u and diameter, three adhesions.

    ``displacement`` is that times E / (s_u R); ``size`` of the cells is over their radius.
    """
    checks, series, histories = list[Check](), list[Series](), list[tuple[float, ...]]()
    reached = displacement * np.arange(1, steps + 1) / steps
    mesh = _mesh(R, outer_ratio, size)
    for alpha in (alpha_1, alpha_2, alpha_3):
        soil = VonMises(E_over_su * su, nu, su)
        accepted = _pushed(mesh, R, soil, alpha, displacement / E_over_su * R, steps)
        factors = [SYMMETRY * step.pile_load[0] / (2.0 * R * su) for step in accepted]
        exact = deep_cylinder_factor(adhesion=alpha)
        flatness = factors[-1] / factors[-1 - steps // 5] - 1.0
        checks += [
            relative(f"resistance / (su D), alpha = {alpha:g}", factors[-1], exact, 0.03),
            at_most(f"its change over the last fifth, alpha = {alpha:g}", flatness, FLAT),
        ]
        series.append(curve(alpha, reached, factors, exact))
        histories += [step.residuals for step in accepted]
    return Outcome(
        tuple(checks), tuple(series), residual_histories=tuple(histories), round_off=ROUND_OFF
    )


def _mesh(radius: float, outer_ratio: float, size: float) -> FEMesh:
    """Return a quarter of the soil around the cylinder."""
    mesh, _ = polar_mesh(*polar_lines(radius, outer_ratio, size))
    facet_nodes = boundary_edges(mesh.cell_nodes)
    vertices = mesh.nodes[facet_nodes[:, :2]]
    distance = np.linalg.norm(vertices, axis=2).max(axis=1)
    tags = np.full(len(distance), int(FacetTag.SYMMETRY))
    tags[np.abs(np.linalg.norm(vertices, axis=2) / radius - 1.0).max(axis=1) < 1e-9] = (
        FacetTag.PILE_SHAFT
    )
    tags[np.linalg.norm(vertices, axis=2).min(axis=1) > 0.999 * distance.max()] = FacetTag.SIDE
    return FEMesh(mesh.nodes, mesh.cell_nodes, facet_nodes, tags)


def _towards_axis(facets: FacetPoints) -> np.ndarray:
    """Return the normals (n_i, 2) of a cylinder, from soil to pile."""
    place = facets.positions
    towards: np.ndarray = -place / np.linalg.norm(place, axis=1)[:, None]
    return towards


def _pushed(
    mesh: FEMesh, radius: float, soil: VonMises, alpha: float, distance: float, steps: int
) -> list[Step]:
    """Return the steps of a cylinder that moves by ``distance`` m along the first axis."""
    spring = SPRING * soil.youngs_modulus / radius
    is_fixed = np.zeros(mesh.nodes.shape, dtype=bool)
    is_fixed[:, 1] = (np.abs(mesh.nodes) < 1e-9 * radius).any(axis=1)
    is_fixed[np.unique(mesh.facet_nodes[mesh.facet_tag == FacetTag.SIDE])] = True
    problem = ServiceProblem(
        mesh,
        Ground(0.0, 1.0, soil),
        CoulombInterface(spring, spring, adhesion_factor=alpha),
        numerics=ServiceNumerics(tolerance=1e-8, max_iterations=30),
        is_fixed=is_fixed,
        normals=_towards_axis,
    )
    motion = np.array([distance / steps, 0.0, 0.0])
    control = PileControl(np.zeros(3, dtype=bool), motion, np.zeros(3))
    state, accepted = problem.wished_in_place_state(), list[Step]()
    for _ in range(steps):
        guess = accepted[-1].increment if accepted else None
        accepted.append(problem.solve(state, control, guess=guess))
        state = accepted[-1].state
    return accepted


PROBLEM = Problem("PB6-FE", "Deep cylinder in clay, finite elements", deep_cylinder, is_quick=False)
