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
from install_mpm.geostatic import Change, change_with_height, geostatic_trace
from install_mpm.injection import inject, merge, sub_region_of
from install_mpm.integration_points import CellFill, IntegrationPoints
from install_mpm.kernels import carry as kernels
from install_mpm.kernels.update import carry_points
from install_mpm.material_points import MaterialPoints
from install_mpm.point_volumes import exchange_volume, share_openings


def give_state(
    points: MaterialPoints,
    mesh: BackgroundMesh,
    model: Discretisation,
    gradient: GeostaticGradient,
) -> StepStart:
    """Return the integration points with the state that the material points give them."""
    geometry = cell_geometry(mesh, model.cell, model.kinematics)
    threshold = model.numerics.fill_threshold
    points, closed_volume = share_openings(points, model.materials)
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
        closed_volume=closed_volume,
    )


def integration_points(
    points: MaterialPoints,
    cell: ReferenceCell,
    geometry: CellGeometry,
    fill: CellFill,
    gradient: GeostaticGradient,
) -> tuple[IntegrationPoints, np.ndarray]:
    """Return the integration points, and which of them hold no material point, (n_cells, n_ip).

    A sub-region takes the soil that fills most of it, and the state of the points of that soil.
    One without material points takes the mean of its cell.
    """
    shape = geometry.integration_height.shape
    n_state = points.state_variables.shape[1]
    change = _change_to_integration_points(points, cell, geometry, gradient)
    totals = (
        np.zeros(shape),
        np.zeros(shape),
        np.zeros(shape, dtype=np.int64),
        np.zeros(shape),
        np.zeros(shape),
        np.zeros((*shape, 3, 3)),
        np.zeros((*shape, n_state)),
    )
    kernels.sum_sub_regions(
        fill.point_order, fill.cell_start, points, change.strain, change.state_variables,
        cell.integration_coordinates, len(gradient.strain), totals,
    )  # fmt: skip
    soil_volume, soil_mass, material, own_volume, *sums = totals
    is_empty = soil_volume == 0.0
    _give_empty_the_soil_of_their_cell(material, own_volume, is_empty)
    for total in sums:
        _mean_of_cell_where_empty(total, material, own_volume, is_empty)
    own_volume = np.where(is_empty, 1.0, own_volume)
    log_ratio, strain, state = sums
    state = (state / own_volume[:, :, None]).reshape(own_volume.size, n_state)
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
        state_variables=_within_bounds(points, material.ravel(), state, gradient),
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


def _change_to_integration_points(
    points: MaterialPoints,
    cell: ReferenceCell,
    geometry: CellGeometry,
    gradient: GeostaticGradient,
) -> Change:
    """Return what undisturbed ground changes from each material point to its integration point."""
    return change_with_height(
        gradient,
        points.material,
        points.position[:, -1],
        geometry.integration_height[points.cell, sub_region_of(points, cell)],
        cell.dim - 1,
        points.state_variables.shape[1],
    )


def _within_bounds(
    points: MaterialPoints, material: np.ndarray, state: np.ndarray, gradient: GeostaticGradient
) -> np.ndarray:
    """Return the state variables (n, n_state), those moved in height within all of their soil."""
    for row in gradient.curved:
        here, own = material == row, points.state_variables[points.material == row]
        if len(own):
            state[here] = np.clip(state[here], own.min(axis=0), own.max(axis=0))
    return state


def _give_empty_the_soil_of_their_cell(
    material: np.ndarray, own_volume: np.ndarray, is_empty: np.ndarray
) -> None:
    """Give empty sub-regions of cells with points the material of most volume, in place."""
    for c in _incomplete_cells(own_volume, is_empty):
        material[c, is_empty[c]] = np.argmax(np.bincount(material[c], own_volume[c]))


def _mean_of_cell_where_empty(
    total: np.ndarray, material: np.ndarray, own_volume: np.ndarray, is_empty: np.ndarray
) -> None:
    """Give empty sub-regions of cells with points the volume mean of their soil, in place."""
    for c in _incomplete_cells(own_volume, is_empty):
        same = ~is_empty[c] & (material[c] == material[c, is_empty[c]][0])
        total[c, is_empty[c]] = total[c, same].sum(axis=0) / own_volume[c, same].sum()


def _incomplete_cells(own_volume: np.ndarray, is_empty: np.ndarray) -> np.ndarray:
    """Return the cells (n,) of which some sub-regions hold points and others none."""
    incomplete: np.ndarray = np.flatnonzero(is_empty.any(axis=1) & (own_volume.sum(axis=1) > 0.0))
    return incomplete


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
    trace, trace_gradient = geostatic_trace(gradient, points)
    carry_points(
        model.cell.cell_type, mesh.cell_nodes, mesh.nodes, equilibrium.displacement,
        equilibrium.trial.cell_volume_ratio, fill.point_order, fill.cell_start, points,
        model.materials, trace, trace_gradient, model.has_mean_dilatation,
        model.kinematics == Kinematics.AXISYMMETRIC, updated, status,
    )  # fmt: skip
    is_sound = not status.any()
    if model.has_mean_dilatation and is_sound:
        exchange_volume(points, updated, model.materials)
    return updated, is_sound
