"""Material points as carriers of state: filling of cells, integration points, and injection.

At the start of a step every integration point takes its state from the material points of its
sub-region.  A cell whose vertices are all filled beyond a threshold is *interior* and counts with
its whole volume; any other cell counts with the volume of its points and is held by a soft
stiffness that acts within the step only.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.cells import ReferenceCell
from install_mpm.conventions import Kinematics
from install_mpm.integration_points import CellFill, IntegrationPoints
from install_mpm.kernels import carry
from install_mpm.kernels import cell_geometry as kernels
from install_mpm.material_points import MaterialPoints


class GeostaticGradient(NamedTuple):
    """Geostatic state per metre of height: it moves a state from one place to one nearby."""

    strain: np.ndarray
    """Elastic strain, (n_materials, 3, 3) in 1/m."""
    stress: np.ndarray
    """Cauchy stress, (n_materials, 3, 3) in Pa/m."""


class CellGeometry(NamedTuple):
    """Geometry of the cells at the start of a step; first axes (n_cells, n_integration_points)."""

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
        np.empty((*shape, cell.n_nodes, cell.dim)),
        np.empty((*shape, cell.n_nodes)),
        np.empty(shape),
        np.empty(shape),
    )
    kernels.cell_geometry(
        cell.cell_type, mesh.cell_nodes, mesh.nodes, cell.integration_coordinates,
        cell.reference_volumes, kinematics == Kinematics.AXISYMMETRIC, *geometry,
    )  # fmt: skip
    return geometry


def fill_cells(
    points: MaterialPoints,
    mesh: BackgroundMesh,
    cell: ReferenceCell,
    geometry: CellGeometry,
    threshold: float,
) -> CellFill:
    """Return which cells hold points and which of them are interior."""
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
    return CellFill(
        point_order=order,
        cell_start=start,
        share=volume / geometry.volume,
        vertex_fill=vertex_fill,
        is_active=np.diff(start) > 0,
        is_interior=(vertex_fill[vertices] > threshold).all(axis=1),
        cell_volume=geometry.volume,
    )


def integration_points(
    points: MaterialPoints,
    cell: ReferenceCell,
    geometry: CellGeometry,
    fill: CellFill,
    gradient: GeostaticGradient,
) -> tuple[IntegrationPoints, np.ndarray]:
    """Return the integration points, and which of them hold no material point, (n_cells, n_ip).

    A sub-region without material points takes the mean of its cell.
    """
    shape = geometry.integration_height.shape
    n_state = points.state_variables.shape[1]
    totals = (
        np.zeros(shape),
        np.zeros(shape),
        np.zeros(shape),
        np.zeros((*shape, 3, 3)),
        np.zeros((*shape, n_state)),
        np.zeros(shape, dtype=np.int64),
    )
    carry.sum_sub_regions(
        fill.point_order, fill.cell_start, points, cell.dim - 1, gradient.strain,
        cell.integration_coordinates, geometry.integration_height, totals,
    )  # fmt: skip
    soil_volume, soil_mass, log_ratio, strain, state, material = totals
    is_empty = soil_volume == 0.0
    for total in (log_ratio, strain, state):
        _mean_of_cell_where_empty(total, soil_volume, is_empty)
    own_volume = np.where(is_empty, 1.0, soil_volume)
    share = geometry.integration_volume
    volume = np.where(fill.is_interior[:, None], share, np.minimum(soil_volume, share))
    volume[~fill.is_active] = 0.0
    return IntegrationPoints(
        cell_start=np.arange(shape[0] + 1) * shape[1],
        reference_coordinates=np.tile(cell.integration_coordinates, (shape[0], 1)),
        shape_gradients=geometry.shape_gradients.reshape(-1, cell.n_nodes, cell.dim),
        hoop_gradients=geometry.hoop_gradients.reshape(-1, cell.n_nodes),
        volume=volume.ravel(),
        density=_density(soil_mass, soil_volume, is_empty),
        volume_ratio=np.exp(log_ratio / own_volume).ravel(),
        elastic_log_strain=(strain / own_volume[:, :, None, None]).reshape(-1, 3, 3),
        state_variables=(state / own_volume[:, :, None]).reshape(own_volume.size, n_state),
        material=material.ravel(),
    ), is_empty & fill.is_active[:, None]


def _density(mass: np.ndarray, volume: np.ndarray, is_empty: np.ndarray) -> np.ndarray:
    """Return the density of the sub-regions; an empty one takes that of its cell."""
    cell_volume = volume.sum(axis=1, keepdims=True)
    of_cell = mass.sum(axis=1, keepdims=True) / np.where(cell_volume > 0.0, cell_volume, 1.0)
    density: np.ndarray = np.where(
        is_empty, of_cell, mass / np.where(is_empty, 1.0, volume)
    ).ravel()
    return density


def _mean_of_cell_where_empty(total: np.ndarray, volume: np.ndarray, is_empty: np.ndarray) -> None:
    """Give empty sub-regions of cells with points the volume mean of the cell, in place."""
    cell_volume = volume.sum(axis=1)
    incomplete = np.flatnonzero(is_empty.any(axis=1) & (cell_volume > 0.0))
    for c in incomplete:
        total[c, is_empty[c]] = total[c].sum(axis=0) / cell_volume[c]


def inject(
    points: MaterialPoints,
    mesh: BackgroundMesh,
    cell: ReferenceCell,
    geometry: CellGeometry,
    fill: CellFill,
    gradient: GeostaticGradient,
) -> MaterialPoints:
    """Return the points with one more at every empty integration point of an interior cell.

    The new point is split off the largest point of the cell, or of a neighbour where the cell is
    empty: mass and volume are conserved exactly, and the state is moved with the geostatic
    gradient.
    """
    if not fill.is_interior.any():
        return points
    occupied = np.zeros(geometry.integration_height.shape, dtype=bool)
    nearest = _sub_region_of(points, cell)
    occupied[points.cell, nearest] = True
    split: list[tuple[int, int, int]] = []
    volume = points.volume.copy()
    for c, q in np.argwhere(~occupied & fill.is_interior[:, None]):
        donors = _points_near(c, fill, mesh)
        if len(donors) == 0:
            continue
        donor = donors[np.argmax(volume[donors])]
        volume[donor] /= 2.0
        split.append((donor, c, q))
    return _split(points, np.array(split, dtype=np.int64).reshape(-1, 3), mesh, cell, gradient)


def _sub_region_of(points: MaterialPoints, cell: ReferenceCell) -> np.ndarray:
    """Return the integration point (n_points,) whose sub-region holds each material point."""
    difference = points.reference_coordinates[:, None, :] - cell.integration_coordinates
    distance = (difference**2).sum(axis=2) + difference.sum(axis=2) ** 2
    nearest: np.ndarray = distance.argmin(axis=1)
    return nearest


def _points_near(c: int, fill: CellFill, mesh: BackgroundMesh) -> np.ndarray:
    """Return the points of cell ``c``, or of its neighbours if it is empty."""
    own = fill.point_order[fill.cell_start[c] : fill.cell_start[c + 1]]
    if len(own):
        return own
    neighbours = mesh.cell_neighbours[c]
    return np.concatenate(
        [
            fill.point_order[fill.cell_start[n] : fill.cell_start[n + 1]]
            for n in neighbours
            if n >= 0
        ]
    )


def _split(
    points: MaterialPoints,
    split: np.ndarray,
    mesh: BackgroundMesh,
    cell: ReferenceCell,
    gradient: GeostaticGradient,
) -> MaterialPoints:
    """Return the points with one more per row (donor, cell, integration point) of ``split``."""
    if len(split) == 0:
        return points
    volume, mass = points.volume.copy(), points.mass.copy()
    added = {name: [] for name in MaterialPoints._fields}  # type: dict[str, list[np.ndarray]]
    for donor, c, q in split:
        volume[donor] /= 2.0
        mass[donor] /= 2.0
        xi = cell.integration_coordinates[q]
        place = _position(mesh, cell, c, xi)
        rise = place[-1] - points.position[donor, -1]
        row = points.material[donor]
        new = {name: getattr(points, name)[donor] for name in MaterialPoints._fields}
        new |= {
            "position": place,
            "reference_coordinates": xi,
            "cell": c,
            "volume": volume[donor],
            "mass": mass[donor],
            "elastic_log_strain": new["elastic_log_strain"] + rise * gradient.strain[row],
            "kirchhoff_stress": new["kirchhoff_stress"] + rise * gradient.stress[row],
        }
        for name, value in new.items():
            added[name].append(value)
    kept = points._replace(volume=volume, mass=mass)
    return MaterialPoints(
        *(np.concatenate([getattr(kept, name), np.array(added[name])]) for name in added)
    )


def _position(mesh: BackgroundMesh, cell: ReferenceCell, c: int, xi: np.ndarray) -> np.ndarray:
    """Return the place of reference coordinates ``xi`` in the straight-edged cell ``c``."""
    vertices = mesh.nodes[mesh.cell_nodes[c, : cell.n_vertices]]
    place: np.ndarray = vertices[0] + xi @ (vertices[1:] - vertices[0])
    return place
