"""Material points as carriers of state: to the integration points of a cell, and back.

At the start of a step every integration point takes its state from the material points of its
sub-region.  A cell whose vertices are all filled beyond a threshold is *interior* and counts with
its whole volume; any other cell counts with the volume of its points and is held by a soft
stiffness that acts within the step only.
"""

from __future__ import annotations

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.cell_fill import CellGeometry, cell_geometry, fill_cells
from install_mpm.cells import ReferenceCell
from install_mpm.conventions import Kinematics
from install_mpm.discretisation import Discretisation, GeostaticGradient, StepStart
from install_mpm.equilibrium import StepEquilibrium
from install_mpm.injection import inject, merge
from install_mpm.integration_points import CellFill, IntegrationPoints
from install_mpm.kernels import carry as kernels
from install_mpm.kernels.update import carry_points
from install_mpm.material_points import MaterialPoints


def give_state(
    points: MaterialPoints,
    mesh: BackgroundMesh,
    model: Discretisation,
    gradient: GeostaticGradient,
) -> StepStart:
    """Return the integration points with the state that the material points give them."""
    geometry = cell_geometry(mesh, model.cell, model.kinematics)
    threshold = model.numerics.fill_threshold
    fill = fill_cells(points, mesh, model.cell, geometry, threshold)
    changed = merge(points, model.cell, fill, model.numerics.most_points_per_cell)
    if changed is not points:
        fill = fill_cells(changed, mesh, model.cell, geometry, threshold)
    enriched = inject(changed, mesh, model.cell, geometry, fill, gradient)
    if enriched is not changed:
        fill = fill_cells(enriched, mesh, model.cell, geometry, threshold)
    quadrature, is_empty = integration_points(enriched, model.cell, geometry, fill, gradient)
    if model.has_weight_of_points:
        quadrature = _with_weight_of(enriched, quadrature)
    return StepStart(
        enriched,
        fill,
        quadrature,
        n_empty=int(np.count_nonzero(is_empty)),
        n_injected=len(enriched.mass) - len(changed.mass),
        n_merged=len(points.mass) - len(changed.mass),
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
    kernels.sum_sub_regions(
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
        shape_values=geometry.shape_values.reshape(-1, cell.n_nodes),
        shape_gradients=geometry.shape_gradients.reshape(-1, cell.n_nodes, cell.dim),
        hoop_gradients=geometry.hoop_gradients.reshape(-1, cell.n_nodes),
        volume=volume.ravel(),
        density=_density(soil_mass, soil_volume, is_empty),
        volume_ratio=np.exp(log_ratio / own_volume).ravel(),
        elastic_log_strain=(strain / own_volume[:, :, None, None]).reshape(-1, 3, 3),
        state_variables=(state / own_volume[:, :, None]).reshape(own_volume.size, n_state),
        material=material.ravel(),
    ), is_empty & fill.is_active[:, None]


def _with_weight_of(points: MaterialPoints, quadrature: IntegrationPoints) -> IntegrationPoints:
    """Return the integration points with densities scaled to the mass of each cell's points."""
    per_cell = np.diff(quadrature.cell_start)
    cell = np.repeat(np.arange(len(per_cell)), per_cell)
    counted = np.bincount(cell, quadrature.density * quadrature.volume, len(per_cell))
    mass = np.bincount(points.cell, points.mass, len(per_cell))
    scale = mass / np.where(counted > 0.0, counted, 1.0)
    return quadrature._replace(density=quadrature.density * scale[cell])


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


def take_state(
    points: MaterialPoints,
    mesh: BackgroundMesh,
    fill: CellFill,
    equilibrium: StepEquilibrium,
    model: Discretisation,
    gradient: GeostaticGradient,
) -> tuple[MaterialPoints, bool]:
    """Return the material points after the displacement of a step, and whether all are sound."""
    updated = MaterialPoints(*(np.array(field) for field in points))
    status = np.zeros(len(mesh.cell_nodes), dtype=np.int64)
    carry_points(
        model.cell.cell_type, mesh.cell_nodes, mesh.nodes, equilibrium.displacement,
        equilibrium.trial.cell_volume_ratio, fill.point_order, fill.cell_start, points,
        model.materials, gradient.strain, model.has_mean_dilatation,
        model.kinematics == Kinematics.AXISYMMETRIC, updated, status,
    )  # fmt: skip
    return updated, not status.any()
