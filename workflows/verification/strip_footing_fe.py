"""Rough rigid strip footing on weightless clay, finite elements: N_c = 2 + pi.

Prandtl's solution for a footing of width B on a von Mises (in plane strain: Tresca) half space with
shear strength s_u: the load tends to (2 + pi) s_u B.  Finite elements approach it from above, with
an error of first order in the size of the elements at the footing's edge, because the singular
corner cannot be represented.
"""

from __future__ import annotations

from dataclasses import dataclass

import gmsh
import numpy as np

from handoff.fe_mesh import FacetTag, FEMesh
from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.ground import Ground
from service_fe.load_step import Step
from service_fe.options import ServiceNumerics
from service_fe.problem import ServiceProblem, roller_supports
from service_fe.rigid_pile import held

EXACT = 2.0 + np.pi
LINE, TRIANGLE = 8, 9
"""gmsh's numbers of the 3-node line and the 6-node triangle."""


@dataclass(frozen=True)
class StripFootingResult:
    """Load-settlement curve of the footing."""

    settlement: np.ndarray
    """Settlement over footing width (step,)."""
    bearing_factor: np.ndarray
    """Mean pressure over shear strength (step,)."""
    iterations: np.ndarray
    """Newton iterations (step,)."""
    residuals: tuple[tuple[float, ...], ...]
    """Relative residuals of each step."""
    n_dofs: int

    @property
    def plateau(self) -> float:
        """Bearing capacity factor at the end of the curve."""
        return float(self.bearing_factor[-1])

    @property
    def error(self) -> float:
        """Relative error of the plateau against Prandtl."""
        return self.plateau / EXACT - 1.0

    @property
    def slope(self) -> float:
        """Relative change of the load over the last quarter of the curve."""
        is_late = self.settlement >= 0.75 * self.settlement[-1]
        late = self.bearing_factor[is_late]
        return float(late[-1] / late[0] - 1.0)


def strip_footing(
    size_at_corner: float,
    *,
    size_far: float = 0.35,
    width: float = 1.0,
    undrained_shear_strength: float = 10e3,
    rigidity_index: float = 1000.0,
    poissons_ratio: float = 0.49,
    settlement: float = 0.04,
    steps: int = 32,
) -> StripFootingResult:
    """Return the curve of a rough rigid footing, pushed by ``settlement * width`` in equal steps.

    Parameters
    ----------
    size_at_corner, size_far
        Edge length of the elements at the footing's edge and far away, over the footing's width.
    width
        Width of the footing in m.
    undrained_shear_strength
        Shear strength in Pa.
    rigidity_index
        Young's modulus over shear strength; it only scales the settlement.
    poissons_ratio
        Below 0.5.
    settlement, steps
        Final settlement over width, and number of steps.
    """
    mesh = footing_mesh(width, size_at_corner * width, size_far * width)
    soil = VonMises(
        rigidity_index * undrained_shear_strength, poissons_ratio, undrained_shear_strength
    )
    under_footing = (np.abs(mesh.nodes[:, 1]) < 1e-9) & (mesh.nodes[:, 0] < 0.5 * width + 1e-9)
    is_fixed = roller_supports(mesh)
    is_fixed[under_footing] = True
    problem = ServiceProblem(
        mesh,
        Ground(0.0, 1.0, soil),
        CoulombInterface(1.0, 1.0),
        numerics=ServiceNumerics(max_iterations=30),
        is_fixed=is_fixed,
    )
    motion = np.zeros_like(mesh.nodes)
    motion[under_footing, 1] = -settlement * width / steps
    state, accepted = problem.wished_in_place_state(), list[Step]()
    for _ in range(steps):
        guess = accepted[-1].increment if accepted else None
        accepted.append(problem.solve(state, held(), support_motion=motion, guess=guess))
        state = accepted[-1].state
    loads = [-2.0 * step.support_reaction[under_footing, 1].sum() for step in accepted]
    return StripFootingResult(
        settlement=settlement * np.arange(1, steps + 1) / steps,
        bearing_factor=np.array(loads) / (undrained_shear_strength * width),
        iterations=np.array([step.iterations for step in accepted]),
        residuals=tuple(step.residuals for step in accepted),
        n_dofs=2 * len(mesh.nodes),
    )


def footing_mesh(width: float, size_at_corner: float, size_far: float) -> FEMesh:
    """Return the mesh of the right half: 2.5 widths wide, 2 deep, graded to the corner."""
    edge, side, depth = 0.5 * width, 2.5 * width, 2.0 * width
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        geo = gmsh.model.geo
        corners = [(0, -depth), (side, -depth), (side, 0), (edge, 0), (0, 0)]
        points = [geo.addPoint(x, z, 0.0) for x, z in corners]
        lines = [geo.addLine(*ends) for ends in zip(points, points[1:] + points[:1], strict=True)]
        geo.addPlaneSurface([geo.addCurveLoop(lines)])
        geo.synchronize()
        _grade(points[3], size_at_corner, size_far, width)
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(2)
        tags = [
            FacetTag.BOTTOM, FacetTag.SIDE, FacetTag.SURFACE, FacetTag.SURFACE, FacetTag.SYMMETRY
        ]  # fmt: skip
        return _mesh_from_gmsh(dict(zip(lines, tags, strict=True)))
    finally:
        gmsh.finalize()


def _grade(corner: int, size_at_corner: float, size_far: float, width: float) -> None:
    """Let the size grow in proportion to the distance from ``corner``."""
    field = gmsh.model.mesh.field
    distance = field.add("Distance")
    field.setNumbers(distance, "PointsList", [corner])
    threshold = field.add("Threshold")
    for name, value in {
        "InField": distance,
        "SizeMin": size_at_corner,
        "SizeMax": size_far,
        "DistMin": 2.0 * size_at_corner,
        "DistMax": 2.0 * width,
    }.items():
        field.setNumber(threshold, name, value)
    field.setAsBackgroundMesh(threshold)
    for option in ("FromPoints", "FromCurvature", "ExtendFromBoundary"):
        gmsh.option.setNumber(f"Mesh.MeshSize{option}", 0)


def _mesh_from_gmsh(tag_of_line: dict[int, FacetTag]) -> FEMesh:
    """Return the current gmsh mesh with its boundary lines tagged."""
    node_tags, coordinates, _ = gmsh.model.mesh.getNodes()
    index = np.zeros(int(node_tags.max()) + 1, dtype=np.int64)
    index[node_tags.astype(np.int64)] = np.arange(len(node_tags))
    _, cell_nodes = gmsh.model.mesh.getElementsByType(TRIANGLE)
    facets, tags = [], []
    for line, tag in tag_of_line.items():
        _, nodes = gmsh.model.mesh.getElementsByType(LINE, line)
        facets.append(index[nodes.astype(np.int64)].reshape(-1, 3))
        tags.append(np.full(len(facets[-1]), tag, dtype=np.int64))
    return FEMesh(
        nodes=coordinates.reshape(-1, 3)[:, :2].copy(),
        cell_nodes=index[cell_nodes.astype(np.int64)].reshape(-1, 6),
        facet_nodes=np.concatenate(facets),
        facet_tag=np.concatenate(tags),
    )
