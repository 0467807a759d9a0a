"""PD8: a vertical point force inside an elastic half space (Mindlin), axisymmetric.

A part of 80 depths of the force is modelled, on rollers at its side and fixed at its bottom: it
settles less by about the ratio of the distance from the force to the extent.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from handoff.fe_mesh import FEMesh
from handoff.gmsh_triangles import fill_polygons
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic
from install_mpm.conventions import Kinematics, Unit
from install_mpm.ground import Ground
from service_fe.problem import ServiceProblem
from service_fe.rigid_pile import held
from workflows.verification.problem import Outcome, Problem, relative
from workflows.verification.references.elasticity import mindlin_displacement
from workflows.verification.revolution import outer_tags, quadratic

EXTENT = 80.0
"""Radius and depth of the modelled ground over the depth of the force."""

SIZE_AT_FORCE, GROWTH = 0.01, 0.12
"""Edge length of the cells at the force over its depth, and its growth per distance."""

PLACES = ((0.2, 1.0), (0.6, 0.0), (0.0, 0.4))
"""Radius and depth of the places that are compared, over the depth of the force."""

TOLERANCE = 0.03


def pd8(
    *,
    P: Annotated[float, Unit("N")] = 1e6,
    G: Annotated[float, Unit("Pa")] = 10e6,
    nu: float = 0.3,
    c: Annotated[float, Unit("m")] = 5.0,
) -> Outcome:
    """The force P acts downward at the depth c of an elastic half space; settlements beside it."""
    mesh = _mesh(c)
    problem = ServiceProblem(
        mesh,
        Ground(0.0, 1.0, HenckyElastic(2.0 * (1.0 + nu) * G, nu)),
        CoulombInterface(1.0, 1.0),
        kinematics=Kinematics.AXISYMMETRIC,
    )
    force = np.zeros_like(mesh.nodes)
    force[_node_at(mesh, 0.0, c), 1] = -P
    step = problem.solve(problem.wished_in_place_state(), held(), external_force=force)
    checks = []
    for r, z in PLACES:
        settlement = float(-step.increment.displacement[_node_at(mesh, r * c, z * c), 1])
        _, exact = mindlin_displacement(
            r * c, z * c, force=P, force_depth=c, shear_modulus=G, poissons_ratio=nu
        )
        place = f"settlement at r = {r:g} c, z = {z:g} c (m)"
        checks.append(relative(place, settlement, float(exact), TOLERANCE))
    return Outcome(tuple(checks), residual_histories=(step.residuals,))


def _mesh(depth: float) -> FEMesh:
    """Return a mesh with nodes at the force and at the places that are compared."""
    (near, _), (surface, _), (_, axis) = PLACES
    lower = [(0.0, -EXTENT), (EXTENT, -EXTENT), (EXTENT, -1.0), (near, -1.0), (0.0, -1.0)]
    upper = [
        (0.0, -1.0), (near, -1.0), (EXTENT, -1.0), (EXTENT, 0.0), (surface, 0.0), (0.0, 0.0),
        (0.0, -axis),
    ]  # fmt: skip

    def size(r: float, z: float) -> float:
        return depth * (SIZE_AT_FORCE + GROWTH * float(np.hypot(r / depth, z / depth + 1.0)))

    outlines = [depth * np.array(corners) for corners in (lower, upper)]
    nodes, cell_nodes, facet_nodes = quadratic(*fill_polygons(outlines, size))
    extent = EXTENT * depth
    return FEMesh(nodes, cell_nodes, facet_nodes, outer_tags(nodes[facet_nodes[:, 2]], extent))


def _node_at(mesh: FEMesh, r: float, depth: float) -> int:
    return int(np.argmin(np.linalg.norm(mesh.nodes - [r, -depth], axis=1)))


PROBLEM = Problem("PD8", "Point force inside a half space", pd8, is_quick=True)
