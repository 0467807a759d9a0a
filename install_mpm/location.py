"""Material points in the cells of a mesh: what has to follow whenever a mesh has moved."""

from __future__ import annotations

import numpy as np

from install_mpm.background_mesh import FACETS_OPPOSITE, BackgroundMesh
from install_mpm.kernels.locate import PROJECTED, locate_points
from install_mpm.material_points import MaterialPoints


def locate(points: MaterialPoints, mesh: BackgroundMesh) -> int:
    """Find the cell of every point, in place; return how many were brought back into the mesh."""
    status, before = np.zeros(len(points.cell), dtype=np.int64), points.position.copy()
    locate_points(
        mesh.nodes, mesh.cell_nodes, mesh.cell_neighbours,
        np.array(FACETS_OPPOSITE[mesh.nodes.shape[1] + 1]), points.position, points.cell,
        points.reference_coordinates, status,
    )  # fmt: skip
    points.displacement[:] += points.position - before
    return int(np.count_nonzero(status == PROJECTED))


def relocate(points: MaterialPoints, mesh: BackgroundMesh) -> tuple[MaterialPoints, int]:
    """Return the points in their cells of ``mesh``, and how many were brought back into it.

    ``mesh`` may be the points' own one after a motion, or another one.  State, mass and volume are
    those of ``points``, which are not changed.
    """
    found = MaterialPoints(*(np.array(field) for field in points))
    np.minimum(found.cell, len(mesh.cell_nodes) - 1, out=found.cell)
    n_projected = locate(found, mesh)
    return found, n_projected
