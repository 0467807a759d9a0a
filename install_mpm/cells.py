"""Reference cells: shape functions, gradients, integration points and vertices.

Triangles have vertices (0, 0), (1, 0), (0, 1) and mid-side nodes in the order 01, 12, 20;
tetrahedra have vertices 0, e1, e2, e3 and mid-side nodes in the order of ``TET_EDGES``;
quadrilaterals fill [-1, 1]^2.  Every cell is straight-edged, so isoparametric and vertex geometry
agree.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from install_mpm._jit import jit


class CellType(IntEnum):
    """Cells in use; the number is what kernels carry."""

    TRI3 = 0
    TRI6 = 1
    QUAD4 = 2
    TET10 = 3
    TET4 = 4


_TRI3, _TRI6, _QUAD4 = int(CellType.TRI3), int(CellType.TRI6), int(CellType.QUAD4)
_TET10, _TET4 = int(CellType.TET10), int(CellType.TET4)
_GAUSS = 1.0 / np.sqrt(3.0)

TRIANGLE_EDGES = ((0, 1), (1, 2), (2, 0))
TET_EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3))
"""Vertices at the ends of each mid-side node; gmsh has the same order."""
_TET_EDGES = np.array(TET_EDGES)


class ReferenceCell(NamedTuple):
    """What kernels and drivers need to know of a cell type."""

    cell_type: int
    n_nodes: int
    n_vertices: int
    dim: int
    integration_coordinates: np.ndarray
    """Reference coordinates (n_ip, dim); each stands for the sub-region nearest to it."""
    reference_volumes: np.ndarray
    """Weights (n_integration_points,) of the integration rule: volumes of the reference cell."""


def reference_cell(cell_type: CellType) -> ReferenceCell:
    """Return the reference cell with the integration rule of its type."""
    if cell_type == CellType.QUAD4:
        corner = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * _GAUSS
        return ReferenceCell(_QUAD4, 4, 4, 2, corner, np.ones(4))
    if cell_type == CellType.TRI3:
        return ReferenceCell(_TRI3, 3, 3, 2, np.full((1, 2), 1 / 3), np.full(1, 0.5))
    if cell_type == CellType.TET4:
        return ReferenceCell(_TET4, 4, 4, 3, np.full((1, 3), 1 / 4), np.full(1, 1 / 6))
    if cell_type == CellType.TET10:
        far, near = (5.0 - np.sqrt(5.0)) / 20.0, (5.0 + 3.0 * np.sqrt(5.0)) / 20.0
        near_vertex = np.full((4, 3), far)
        near_vertex[1:][np.diag_indices(3)] = near
        return ReferenceCell(_TET10, 10, 4, 3, near_vertex, np.full(4, 1 / 24))
    near_vertex = np.array([[1 / 6, 1 / 6], [2 / 3, 1 / 6], [1 / 6, 2 / 3]])
    return ReferenceCell(_TRI6, 6, 3, 2, near_vertex, np.full(3, 1 / 6))


@jit
def shape_functions(cell_type, xi, values):
    """Fill ``values`` (n_nodes,) with the shape functions at the place ``xi`` (dim,)."""
    if cell_type == _QUAD4:
        values[0] = 0.25 * (1.0 - xi[0]) * (1.0 - xi[1])
        values[1] = 0.25 * (1.0 + xi[0]) * (1.0 - xi[1])
        values[2] = 0.25 * (1.0 + xi[0]) * (1.0 + xi[1])
        values[3] = 0.25 * (1.0 - xi[0]) * (1.0 + xi[1])
        return
    if cell_type == _TET10:
        _quadratic_tetrahedron(xi, values)
        return
    if cell_type == _TET4:
        for v in range(4):
            values[v] = _barycentric(xi, v)
        return
    first, second = xi[0], xi[1]
    zeroth = 1.0 - first - second
    if cell_type == _TRI3:
        values[0], values[1], values[2] = zeroth, first, second
        return
    values[0] = zeroth * (2.0 * zeroth - 1.0)
    values[1] = first * (2.0 * first - 1.0)
    values[2] = second * (2.0 * second - 1.0)
    values[3] = 4.0 * zeroth * first
    values[4] = 4.0 * first * second
    values[5] = 4.0 * second * zeroth


@jit
def _barycentric(xi, v):
    """Return the linear function of vertex ``v`` of a tetrahedron."""
    return 1.0 - xi[0] - xi[1] - xi[2] if v == 0 else xi[v - 1]


@jit
def _barycentric_gradient(v, i):
    """Return the derivative by coordinate ``i`` of the linear function of vertex ``v``."""
    if v == 0:
        return -1.0
    return 1.0 if v - 1 == i else 0.0


@jit
def _quadratic_tetrahedron(xi, values):
    """Fill the shape functions of the 10-node tetrahedron: l (2 l - 1), and 4 l_a l_b."""
    for v in range(4):
        linear = _barycentric(xi, v)
        values[v] = linear * (2.0 * linear - 1.0)
    for e in range(6):
        values[4 + e] = (
            4.0 * _barycentric(xi, _TET_EDGES[e, 0]) * _barycentric(xi, _TET_EDGES[e, 1])
        )


@jit
def _quadratic_tetrahedron_gradients(xi, gradients):
    """Fill the reference gradients of the 10-node tetrahedron."""
    for i in range(3):
        for v in range(4):
            gradients[v, i] = (4.0 * _barycentric(xi, v) - 1.0) * _barycentric_gradient(v, i)
        for e in range(6):
            a, b = _TET_EDGES[e, 0], _TET_EDGES[e, 1]
            gradients[4 + e, i] = 4.0 * (
                _barycentric_gradient(a, i) * _barycentric(xi, b)
                + _barycentric(xi, a) * _barycentric_gradient(b, i)
            )


@jit
def reference_gradients(cell_type, xi, gradients):
    """Fill ``gradients`` (n_nodes, dim) with the derivatives of shape functions by ``xi``."""
    if cell_type == _QUAD4:
        for a in range(4):
            corner_x = 1.0 if a in (1, 2) else -1.0
            corner_y = 1.0 if a >= 2 else -1.0
            gradients[a, 0] = 0.25 * corner_x * (1.0 + corner_y * xi[1])
            gradients[a, 1] = 0.25 * corner_y * (1.0 + corner_x * xi[0])
        return
    if cell_type == _TET10:
        _quadratic_tetrahedron_gradients(xi, gradients)
        return
    if cell_type == _TET4:
        for v in range(4):
            for i in range(3):
                gradients[v, i] = _barycentric_gradient(v, i)
        return
    if cell_type == _TRI3:
        gradients[:, :] = 0.0
        gradients[0, 0], gradients[0, 1] = -1.0, -1.0
        gradients[1, 0], gradients[2, 1] = 1.0, 1.0
        return
    first, second = xi[0], xi[1]
    zeroth = 1.0 - first - second
    gradients[0, 0] = gradients[0, 1] = 1.0 - 4.0 * zeroth
    gradients[1, 0], gradients[1, 1] = 4.0 * first - 1.0, 0.0
    gradients[2, 0], gradients[2, 1] = 0.0, 4.0 * second - 1.0
    gradients[3, 0], gradients[3, 1] = 4.0 * (zeroth - first), -4.0 * first
    gradients[4, 0], gradients[4, 1] = 4.0 * second, 4.0 * first
    gradients[5, 0], gradients[5, 1] = -4.0 * second, 4.0 * (zeroth - second)


def sub_region_points(cell: ReferenceCell, per_direction: int) -> tuple[np.ndarray, np.ndarray]:
    """Return coordinates (n, dim) and volume shares (n,) of points that seed all sub-regions.

    A cell has one sub-region per vertex: a quadrilateral with the mid-sides and the centroid, in a
    tetrahedron a hexahedron with the centroids of the faces as well.  Each gets ``per_direction``
    Gauss points per axis, whose weights add up to the exact volume.
    """
    abscissae, weights = np.polynomial.legendre.leggauss(per_direction)
    axes = np.meshgrid(*[np.arange(per_direction)] * cell.dim, indexing="ij")
    rule = np.stack([axis.ravel() for axis in axes], axis=1)
    coordinates, shares = [], []
    for corners in _sub_region_corners(cell):
        for entry in rule:
            values, gradients = _multilinear(abscissae[entry])
            coordinates.append(values @ corners)
            volume = abs(np.linalg.det(corners.T @ gradients))
            shares.append(weights[entry].prod() * volume)
    total = np.sum(shares)
    return np.array(coordinates), np.array(shares) / total


def _multilinear(xi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return values (2^dim,) and gradients (2^dim, dim) of multilinear functions on [-1, 1]^dim.

    Corners are counted in binary, the first axis first.
    """
    dim = len(xi)
    signs = 2.0 * ((np.arange(2**dim)[:, None] >> np.arange(dim)) & 1) - 1.0
    factors = (1.0 + signs * xi) / 2.0
    gradients = np.empty((2**dim, dim))
    for i in range(dim):
        others = np.delete(factors, i, axis=1).prod(axis=1)
        gradients[:, i] = signs[:, i] / 2.0 * others
    return factors.prod(axis=1), gradients


def _sub_region_corners(cell: ReferenceCell) -> np.ndarray:
    """Return the corners (n_sub_regions, 2^dim, dim) of one sub-region per vertex.

    Corner s of a sub-region is the mean of its vertex and of those neighbours in the set s, counted
    in binary; with all neighbours it is the centroid of the cell.
    """
    dim = cell.dim
    if cell.cell_type == _QUAD4:
        vertices = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
        neighbours = [[(v + 1) % 4, (v - 1) % 4] for v in range(4)]
    else:
        vertices = np.vstack([np.zeros(dim), np.eye(dim)])
        neighbours = [[(v + 1 + i) % (dim + 1) for i in range(dim)] for v in range(dim + 1)]
    corners = np.empty((len(vertices), 2**dim, dim))
    for v, around in enumerate(neighbours):
        for s in range(2**dim):
            members = [v, *(around[i] for i in range(dim) if s >> i & 1)]
            corners[v, s] = vertices[members].mean(axis=0)
        if cell.cell_type == _QUAD4:
            corners[v, -1] = 0.0
    return corners
