"""Geometry of the background cells at the start of a step, and how full of soil they are."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.cells import ReferenceCell
from install_mpm.conventions import Kinematics
from install_mpm.integration_points import CellFill
from install_mpm.kernels import carry
from install_mpm.kernels import cell_geometry as kernels
from install_mpm.material_points import MaterialPoints
from install_mpm.ring_means import ring_means

AT_TOP = 1e-9
"""Distance from the top of the mesh, over its height, within which a node lies there."""


class CellGeometry(NamedTuple):
    """Geometry of the cells at the start of a step; first axes (n_cells, n_integration_points).

    In axisymmetry shape functions and gradients are means around the ring of a point, see
    ``ring_means``.
    """

    shape_values: np.ndarray
    """(..., n_nodes)."""
    shape_gradients: np.ndarray
    """(..., n_nodes, dim) in 1/m."""
    hoop_gradients: np.ndarray
    """(..., n_nodes) in 1/m, zero unless axisymmetric."""
    integration_volume: np.ndarray
    """Volume that belongs to each integration point of a full cell, (...) in m^3."""
    integration_height: np.ndarray
    """Height of the integration points, (...) in m."""

    @property
    def volume(self) -> np.ndarray:
        """Volume of the cells, (n_cells,) in m^3."""
        volume: np.ndarray = self.integration_volume.sum(axis=1)
        return volume


def cell_geometry(
    mesh: BackgroundMesh, cell: ReferenceCell, kinematics: Kinematics
) -> CellGeometry:
    """Return shape gradients, volumes and heights of all cells."""
    shape = (len(mesh.cell_nodes), len(cell.reference_volumes))
    geometry = CellGeometry(
        np.empty((*shape, cell.n_nodes)),
        np.empty((*shape, cell.n_nodes, cell.dim)),
        np.empty((*shape, cell.n_nodes)),
        np.empty(shape),
        np.empty(shape),
    )
    kernels.cell_geometry(
        cell.cell_type, mesh.cell_nodes, mesh.nodes, cell.integration_coordinates,
        cell.reference_volumes, kinematics == Kinematics.AXISYMMETRIC, *geometry,
    )  # fmt: skip
    if kinematics != Kinematics.AXISYMMETRIC:
        return geometry
    values, gradients, hoop = ring_means(mesh.nodes[mesh.cell_nodes], cell)
    return geometry._replace(shape_values=values, shape_gradients=gradients, hoop_gradients=hoop)


def fill_cells(
    points: MaterialPoints,
    mesh: BackgroundMesh,
    cell: ReferenceCell,
    geometry: CellGeometry,
    threshold: float,
) -> CellFill:
    """Return which cells hold points and which of them are interior.

    A vertex that has no void beside it counts as full: in soil that flows round an edge points
    crowd on one side of a cell and thin out on the other, and yet there is soil everywhere.
    """
    n_cells = len(mesh.cell_nodes)
    order = np.argsort(points.cell, kind="stable")
    start = np.searchsorted(points.cell[order], np.arange(n_cells + 1))
    filled, capacity = np.zeros(len(mesh.nodes)), np.zeros(len(mesh.nodes))
    carry.vertex_fill(
        mesh.cell_nodes, cell.n_vertices, cell.integration_coordinates,
        geometry.integration_volume, order, start, points, filled, capacity,
    )  # fmt: skip
    vertex_fill = filled / np.where(capacity > 0.0, capacity, 1.0)
    vertices = mesh.cell_nodes[:, : cell.n_vertices]
    volume = np.bincount(points.cell, weights=points.volume, minlength=n_cells)
    at_void = _at_void(mesh, vertices, vertex_fill, np.diff(start) == 0)
    is_amid_soil = (capacity > 0.0) & ~at_void
    vertex_fill = np.where(is_amid_soil, np.maximum(vertex_fill, 1.0), vertex_fill)
    return CellFill(
        point_order=order,
        cell_start=start,
        share=volume / geometry.volume,
        vertex_fill=vertex_fill,
        is_active=np.diff(start) > 0,
        is_interior=(vertex_fill[vertices] > threshold).all(axis=1),
        cell_volume=geometry.volume,
    )


def _at_void(
    mesh: BackgroundMesh, vertices: np.ndarray, vertex_fill: np.ndarray, is_empty: np.ndarray
) -> np.ndarray:
    """Return which nodes (n_nodes,) are at the top of the mesh, or vertices of a void cell.

    Such a cell holds no points, and one of its ``vertices`` (n_cells, n_vertices) has none in any
    of the cells around it; a single empty cell amid soil is no void.
    """
    is_void = is_empty & (vertex_fill[vertices] == 0.0).any(axis=1)
    height = mesh.nodes[:, -1]
    at_void: np.ndarray = height > height.max() - AT_TOP * np.ptp(height)
    at_void[vertices[is_void]] = True
    return at_void
