"""How good the stress of the material points is: its scatter in the cells near a pile."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.discretisation import GeostaticGradient
from install_mpm.material_points import MaterialPoints, cauchy_stress


def cells_near(mesh: BackgroundMesh, places: np.ndarray, distance: float) -> np.ndarray:
    """Return whether the middle of each cell, (n_cells,), is within ``distance`` (m) of a place.

    ``places`` are (n, dim) in m.
    """
    dim = mesh.nodes.shape[1]
    middle = mesh.nodes[mesh.cell_nodes[:, : dim + 1]].mean(axis=1)
    nearest, _ = cKDTree(places).query(middle, distance_upper_bound=distance)
    is_near: np.ndarray = np.isfinite(nearest)
    return is_near


def pressure_scatter(
    points: MaterialPoints, cells: np.ndarray, gradient: GeostaticGradient
) -> float:
    """Return how far the mean pressure of points is from that of their cell, in Pa.

    Root mean square by volume over the points of the ``cells`` (n_cells,) bool.  What undisturbed
    ground changes with height within a cell is no scatter.
    """
    here = np.flatnonzero(cells[points.cell])
    if len(here) == 0:
        return 0.0
    volume, cell, n_cells = points.volume[here], points.cell[here], len(cells)
    by_height = -np.trace(gradient.stress, axis1=1, axis2=2)[points.material[here]] / 3.0
    pressure = -np.trace(cauchy_stress(points)[here], axis1=1, axis2=2) / 3.0
    total = np.maximum(np.bincount(cell, volume, n_cells), np.finfo(float).tiny)

    def from_mean(values: np.ndarray) -> np.ndarray:
        mean = np.bincount(cell, volume * values, n_cells) / total
        deviation: np.ndarray = values - mean[cell]
        return deviation

    scatter = from_mean(pressure) - by_height * from_mean(points.position[here, -1])
    return float(np.sqrt(volume @ scatter**2 / volume.sum()))
