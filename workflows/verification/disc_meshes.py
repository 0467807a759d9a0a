"""Meshes of discs, annuli and discs with an elliptical hole: 6-node triangles, graded.

Curves are polygons with their corners on the curve, one edge of a cell per side, so that a circle
of n sides maps onto itself when it turns by a multiple of 360 / n degrees.
"""

from __future__ import annotations

from typing import Any

import gmsh
import numpy as np

from install_mpm.background_mesh import BackgroundMesh, make_background_mesh

GMSH_TRIANGLE_6 = 9


def ellipse(semi_major: float, semi_minor: float, n_sides: int) -> np.ndarray:
    """Return the corners (n_sides, 2) in m of an ellipse about the origin, anticlockwise.

    Equal steps of the eccentric angle: the sides are shortest where it is most curved.
    """
    angle = 2.0 * np.pi * np.arange(n_sides) / n_sides
    return np.column_stack([semi_major * np.cos(angle), semi_minor * np.sin(angle)])


def circle(radius: float, n_sides: int) -> np.ndarray:
    """Return the corners (n_sides, 2) in m of a circle about the origin, anticlockwise."""
    return ellipse(radius, radius, n_sides)


def disc_mesh(rim: np.ndarray, hole: np.ndarray | None = None) -> BackgroundMesh:
    """Return the mesh between the polygons ``hole`` and ``rim``, (corners, 2) in m each.

    Between the two the size of the cells grows linearly from the sides of one to those of the
    other; a disc without a hole has cells of one size.
    """
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)  # more threads: another mesh in every run
        for option in ("FromPoints", "FromCurvature", "ExtendFromBoundary"):
            gmsh.option.setNumber(f"Mesh.MeshSize{option}", 0)
        gmsh.model.add("disc")
        polygons = [rim] if hole is None else [rim, hole]
        gmsh.model.geo.addPlaneSurface([_loop(polygon) for polygon in polygons])
        gmsh.model.geo.synchronize()
        for _, line in gmsh.model.getEntities(1):
            gmsh.model.mesh.setTransfiniteCurve(line, 2)
        gmsh.model.mesh.setSizeCallback(_sizes(polygons))
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(2)
        return _collected()
    finally:
        gmsh.finalize()


def nodes_on(mesh: BackgroundMesh, polygon: np.ndarray) -> np.ndarray:
    """Return the nodes (n,) of the reference mesh at corners and mid-sides of ``polygon``."""
    middles = (polygon + np.roll(polygon, -1, axis=0)) / 2.0
    places = np.concatenate([polygon, middles])
    slack = 1e-9 * np.abs(polygon).max()
    return np.array(
        [
            np.flatnonzero(np.linalg.norm(mesh.reference_nodes - place, axis=1) < slack)[0]
            for place in places
        ]
    )


def _loop(corners: np.ndarray) -> int:
    """Add a closed polygon to gmsh's model and return the tag of its loop."""
    geo = gmsh.model.geo
    points = [geo.addPoint(x, z, 0.0) for x, z in corners]
    lines = [geo.addLine(*ends) for ends in zip(points, points[1:] + points[:1], strict=True)]
    return int(geo.addCurveLoop(lines))


def _sizes(polygons: list[np.ndarray]) -> Any:
    """Return gmsh's callback for the wanted edge length in m."""
    sides = [np.linalg.norm(np.roll(p, -1, axis=0) - p, axis=1) for p in polygons]
    middles = [(np.roll(p, -1, axis=0) + p) / 2.0 for p in polygons]

    def size(_dim: int, _tag: int, x: float, z: float, _y: float, _size: float) -> float:
        far, length = [], []
        for own_sides, own_middles in zip(sides, middles, strict=True):
            distance = np.hypot(own_middles[:, 0] - x, own_middles[:, 1] - z)
            nearest = distance.argmin()
            far.append(distance[nearest])
            length.append(own_sides[nearest])
        # a polygon counts the less the farther it is
        return float(np.average(length, weights=far[::-1]) if len(far) > 1 else length[0])

    return size


def _collected() -> BackgroundMesh:
    """Return the mesh that gmsh holds, with nodes numbered as used."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    _, cells = gmsh.model.mesh.getElementsByType(GMSH_TRIANGLE_6)
    used, cell_nodes = np.unique(cells, return_inverse=True)
    position = np.empty(int(tags.max()) + 1, dtype=np.int64)
    position[tags] = np.arange(len(tags))
    nodes = coordinates.reshape(-1, 3)[position[used], :2]
    return make_background_mesh(nodes, cell_nodes.reshape(-1, 6))
