"""Soil that hangs on the rest of the ground by an edge or a vertex of its cells only.

Such cells can turn about the edge without strain, so no stress holds them.  The empty cells around
them are held by the soft stress of partly filled ones within the step: through these they are
joined to the ground across facets.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from install_mpm.background_mesh import BackgroundMesh


def cells_around_hanging_soil(mesh: BackgroundMesh, is_active: np.ndarray) -> np.ndarray:
    """Return the cells (n_cells,) bool that are not active and touch a hanging body of cells.

    A body is what is connected across facets.  It hangs if it shares vertices with another body and
    is not the largest of all.
    """
    body = _bodies(mesh, is_active)
    vertices = mesh.cell_nodes[:, : mesh.nodes.shape[1] + 1]
    largest = np.bincount(body[is_active], minlength=1).argmax()
    is_small = is_active & (body != largest)
    around = np.zeros(len(body), dtype=bool)
    for number in np.unique(body[is_small]):
        own = is_active & (body == number)
        is_own = np.zeros(len(mesh.nodes), dtype=bool)
        is_own[vertices[own]] = True
        touches = is_own[vertices].any(axis=1) & ~own
        if (touches & is_active).any():
            around |= touches
    return around & ~is_active


def _bodies(mesh: BackgroundMesh, is_active: np.ndarray) -> np.ndarray:
    """Return the number of the body (n_cells,) of each cell; inactive cells are alone."""
    n_cells = len(is_active)
    cell, facet = np.nonzero((mesh.cell_neighbours >= 0) & is_active[:, None])
    beside = mesh.cell_neighbours[cell, facet]
    joined = is_active[beside]
    pairs = (cell[joined], beside[joined])
    graph = sp.coo_matrix((np.ones(len(pairs[0])), pairs), shape=(n_cells, n_cells))
    body: np.ndarray = sp.csgraph.connected_components(graph, directed=False)[1]
    return body
