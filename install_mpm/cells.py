"""Reference cells: shape functions, gradients, integration points and vertices.

Triangles have vertices (0, 0), (1, 0), (0, 1) and mid-side nodes in the order 01, 12, 20;
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


_TRI3, _TRI6, _QUAD4 = int(CellType.TRI3), int(CellType.TRI6), int(CellType.QUAD4)
_GAUSS = 1.0 / np.sqrt(3.0)


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
def reference_gradients(cell_type, xi, gradients):
    """Fill ``gradients`` (n_nodes, dim) with the derivatives of shape functions by ``xi``."""
    if cell_type == _QUAD4:
        for a in range(4):
            corner_x = 1.0 if a in (1, 2) else -1.0
            corner_y = 1.0 if a >= 2 else -1.0
            gradients[a, 0] = 0.25 * corner_x * (1.0 + corner_y * xi[1])
            gradients[a, 1] = 0.25 * corner_y * (1.0 + corner_x * xi[0])
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

    A triangle has three quadrilateral sub-regions (vertex, mid-sides, centroid), a quadrilateral
    four quarters; each gets ``per_direction`` x ``per_direction`` Gauss points, whose weights add
    up to the exact volume.
    """
    abscissae, weights = np.polynomial.legendre.leggauss(per_direction)
    corners = _sub_region_corners(cell)
    coordinates, shares = [], []
    values, gradients = np.empty(4), np.empty((4, 2))
    for quadrilateral in corners:
        for i in range(per_direction):
            for j in range(per_direction):
                xi = np.array([abscissae[i], abscissae[j]])
                shape_functions(_QUAD4, xi, values)
                reference_gradients(_QUAD4, xi, gradients)
                coordinates.append(values @ quadrilateral)
                shares.append(weights[i] * weights[j] * np.linalg.det(quadrilateral.T @ gradients))
    total = np.sum(shares)
    return np.array(coordinates), np.array(shares) / total


def _sub_region_corners(cell: ReferenceCell) -> np.ndarray:
    """Return the corners (n_sub_regions, 4, 2), anticlockwise, of one sub-region per vertex."""
    if cell.cell_type == _QUAD4:
        vertices = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    else:
        vertices = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    centre = vertices.mean(axis=0)
    following, previous = np.roll(vertices, -1, axis=0), np.roll(vertices, 1, axis=0)
    return np.stack(
        [
            vertices,
            (vertices + following) / 2,
            np.broadcast_to(centre, vertices.shape),
            (vertices + previous) / 2,
        ],
        axis=1,
    )
