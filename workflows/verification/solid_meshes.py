"""Structured meshes of solids: plane meshes of triangles, extruded and cut into tetrahedra.

In a plane mesh every triangle lists its vertices so that each edge is run through in one sense by
both its triangles.  A prism over a triangle (a, b, c) is cut into three tetrahedra along the
diagonals from the lower start to the upper end of its edges; so the cut fits from prism to prism,
and every hexahedron of a grid falls into the six tetrahedra of Kuhn.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm.background_mesh import BackgroundMesh, make_background_mesh
from install_mpm.cells import TET_EDGES


class Plane(NamedTuple):
    """Vertices (n, 2) in m and triangles (n_triangles, 3), ordered as the module says."""

    vertices: np.ndarray
    triangles: np.ndarray


def grid(x: np.ndarray, y: np.ndarray) -> Plane:
    """Return the grid of the lines ``x`` and ``y`` (m, ascending), cut by rising diagonals."""
    vertices = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    index = np.arange(len(vertices)).reshape(len(x), len(y))
    return Plane(vertices, _diagonals(index))


def ring(radii: np.ndarray, sides: int) -> Plane:
    """Return the polygons of ``sides`` with corners on circles of ``radii`` (m, ascending).

    If the first radius is zero, the innermost polygon is cut into triangles around the centre.
    """
    has_centre = radii[0] == 0.0
    circles = radii[1:] if has_centre else radii
    angle = 2.0 * np.pi * np.arange(sides) / sides
    around = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    vertices = (circles[:, None, None] * around).reshape(-1, 2)
    index = np.arange(len(vertices)).reshape(len(circles), sides)
    triangles = _diagonals(np.hstack([index, index[:, :1]]))
    if has_centre:
        first = index[0]
        centre = np.full(sides, len(vertices))
        triangles = np.vstack([np.stack([centre, first, np.roll(first, -1)], 1), triangles])
        vertices = np.vstack([vertices, np.zeros(2)])
    return Plane(vertices, triangles)


def sector(radii: np.ndarray, angles: np.ndarray) -> Plane:
    """Return the sector between the first and the last of ``angles`` (rad, ascending).

    ``radii`` ascend from zero, in m; the innermost ring is cut into triangles around the centre.
    """
    bent = grid(radii[1:], angles)
    radius, angle = bent.vertices.T
    vertices = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    vertices[np.abs(vertices) < 1e-12 * radii[-1]] = 0.0  # on an axis of symmetry
    first = np.arange(len(angles) - 1)
    around = np.stack([np.full(len(first), len(vertices)), first, first + 1], 1)
    return Plane(np.vstack([vertices, np.zeros(2)]), np.vstack([around, bent.triangles]))


def _diagonals(index: np.ndarray) -> np.ndarray:
    """Return the two triangles of every cell of a grid of vertices ``index`` (n, m)."""
    first, last = index[:-1, :-1].ravel(), index[1:, 1:].ravel()
    paths = [np.stack([first, via.ravel(), last], 1) for via in (index[1:, :-1], index[:-1, 1:])]
    return np.concatenate(paths)


class Solid(NamedTuple):
    """Vertices (n, 3) in m and tetrahedra (n_tetrahedra, 4)."""

    vertices: np.ndarray
    tetrahedra: np.ndarray

    @property
    def centroids(self) -> np.ndarray:
        """Centroids (n_tetrahedra, 3) in m."""
        centroids: np.ndarray = self.vertices[self.tetrahedra].mean(axis=1)
        return centroids


def extruded(plane: Plane, levels: np.ndarray) -> Solid:
    """Return the prisms over ``plane`` between ``levels`` (m, ascending), cut in three each."""
    n_vertices = len(plane.vertices)
    vertices = np.column_stack(
        [np.tile(plane.vertices, (len(levels), 1)), np.repeat(levels, n_vertices)]
    )
    a, b, c = plane.triangles.T
    up = n_vertices
    of_layer = np.concatenate(
        [
            np.stack(path, 1)
            for path in (
                (a, b, c, c + up), (a, b, b + up, c + up), (a, a + up, b + up, c + up),
            )
        ]
    )  # fmt: skip
    layers = np.arange(len(levels) - 1)
    tetrahedra = (of_layer[None] + n_vertices * layers[:, None, None]).reshape(-1, 4)
    return Solid(vertices, tetrahedra)


def quadratic_mesh(solid: Solid, is_kept: np.ndarray | None = None) -> BackgroundMesh:
    """Return the mesh of the tetrahedra ``is_kept`` (n_tetrahedra,), with mid-side nodes."""
    tetrahedra = solid.tetrahedra if is_kept is None else solid.tetrahedra[is_kept]
    used, tetrahedra = np.unique(tetrahedra, return_inverse=True)
    tetrahedra, vertices = tetrahedra.reshape(-1, 4), solid.vertices[used]
    tetrahedra = _right_handed(vertices, tetrahedra)
    ends = np.sort(tetrahedra[:, TET_EDGES], axis=2).reshape(-1, 2)
    unique, edge = np.unique(ends, axis=0, return_inverse=True)
    nodes = np.vstack([vertices, vertices[unique].mean(axis=1)])
    middle = len(vertices) + edge.reshape(-1, 6)
    return make_background_mesh(nodes, np.hstack([tetrahedra, middle]))


def _right_handed(vertices: np.ndarray, tetrahedra: np.ndarray) -> np.ndarray:
    """Return the tetrahedra (n, 4) with two nodes exchanged where the volume is negative."""
    edges = vertices[tetrahedra[:, 1:]] - vertices[tetrahedra[:, :1]]
    is_mirrored = np.linalg.det(edges) < 0.0
    return np.where(is_mirrored[:, None], tetrahedra[:, [0, 2, 1, 3]], tetrahedra)


def linear_mesh(solid: Solid) -> BackgroundMesh:
    """Return the mesh of all tetrahedra, of four nodes."""
    return make_background_mesh(solid.vertices, _right_handed(solid.vertices, solid.tetrahedra))


def box_mesh(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> BackgroundMesh:
    """Return the mesh of the box of the grid lines ``x``, ``y`` and ``z`` (m, ascending)."""
    return quadratic_mesh(extruded(grid(x, y), z))


def ring_mesh(radii: np.ndarray, sides: int, levels: np.ndarray) -> BackgroundMesh:
    """Return the mesh of a prism of ``sides`` around the z axis, see ``ring`` and ``extruded``."""
    return quadratic_mesh(extruded(ring(radii, sides), levels))
