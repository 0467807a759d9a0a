"""From the solved mesh back to the material points: they move, strain and return to yield."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm._jit import jit, parallel_jit, prange
from install_mpm.constitutive.dispatch import update_stress
from install_mpm.constitutive.hencky import determinant, trial_log_strain
from install_mpm.constitutive.mandel import from_mandel, to_mandel
from install_mpm.kernels.cell_deformation import scale_volume
from install_mpm.kernels.cell_geometry import point_geometry
from install_mpm.kernels.cell_records import (
    CHUNKS,
    COLLAPSED,
    LAW_FAILED,
    SMALLEST_VOLUME_RATIO,
    dilatation_axes,
)
from install_mpm.kernels.gradients import add_hoop_gradient, displacement_gradient


@parallel_jit
def carry_points(
    cell_type, cell_nodes, nodes, displacement, cell_volume_ratio, point_order, cell_start,
    points, materials, geostatic_trace, trace_gradient, has_mean_dilatation, is_axisymmetric,
    updated, status,
):  # fmt: skip
    """Fill ``updated`` (MaterialPoints) with the state after the step.

    ``status`` (n_cells,) is 0 where it is sound.

    Every point deforms with its own dF, scaled to the volume change of its cell.  The volumetric
    part of the trial strains of the points of one soil in a cell is then replaced by their mean
    (plus the geostatic difference), because a pressure that the integration points do not see would
    otherwise stay with the points for ever.  The geostatic volumetric strain of each point is
    ``geostatic_trace`` (n_points,) where the step starts, and ``trace_gradient`` (n_points,) in 1/m
    its change with height.
    """
    n_cells = cell_nodes.shape[0]
    for chunk in prange(CHUNKS):
        scratch = _make_carry_scratch(cell_nodes.shape[1], nodes.shape[1])
        for c in range(chunk * n_cells // CHUNKS, (chunk + 1) * n_cells // CHUNKS):
            # numba loses writes to the fields of a tuple made in a parallel loop itself
            status[c] = _carry_cell(
                cell_type, cell_nodes[c], nodes, displacement, cell_volume_ratio[c], point_order,
                cell_start[c], cell_start[c + 1], points, materials, geostatic_trace,
                trace_gradient, has_mean_dilatation, is_axisymmetric, scratch, updated,
            )  # fmt: skip


class CarryScratch(NamedTuple):
    """Work arrays of one chunk."""

    reference: np.ndarray
    gradients: np.ndarray
    hoop: np.ndarray
    values: np.ndarray
    increment: np.ndarray
    vectors: np.ndarray
    stretches: np.ndarray
    trial: np.ndarray
    stress: np.ndarray
    strain: np.ndarray
    tangent: np.ndarray


@jit
def _make_carry_scratch(n_nodes, dim):
    """Return work arrays for cells of ``n_nodes`` nodes."""
    return CarryScratch(
        np.empty((n_nodes, dim)),
        np.empty((n_nodes, dim)),
        np.empty(n_nodes),
        np.empty(n_nodes),
        np.empty((3, 3)),
        np.empty((3, 3)),
        np.empty(3),
        np.empty(6),
        np.empty(6),
        np.empty(6),
        np.empty((6, 6)),
    )


@jit
def _carry_cell(
    cell_type, cell_nodes, nodes, displacement, volume_ratio, point_order, first, last, points,
    materials, geostatic_trace, trace_gradient, has_mean_dilatation, is_axisymmetric, scratch,
    updated,
):  # fmt: skip
    """Move and strain the points of one cell; return 0, or why its points are not sound."""
    n_axes = dilatation_axes(nodes.shape[1], is_axisymmetric)
    for entry in range(first, last):
        p = point_order[entry]
        xi = points.reference_coordinates[p]
        increment = scratch.increment
        point_geometry(
            cell_type, xi, nodes, cell_nodes, is_axisymmetric, scratch.reference, scratch.values,
            scratch.gradients, scratch.hoop,
        )  # fmt: skip
        displacement_gradient(displacement, cell_nodes, scratch.gradients, increment)
        if is_axisymmetric:
            add_hoop_gradient(displacement, cell_nodes, scratch.hoop, increment)
        for i in range(3):
            increment[i, i] += 1.0
        ratio = determinant(increment)
        if ratio < SMALLEST_VOLUME_RATIO or (nodes.shape[1] == 2 and increment[2, 2] <= 0.0):
            return COLLAPSED
        if has_mean_dilatation:
            scale_volume(increment, volume_ratio / ratio, n_axes)
            ratio = volume_ratio
        _move_point(p, cell_nodes, displacement, points, scratch.values, updated)
        updated.volume[p] = points.volume[p] * ratio
        updated.volume_ratio[p] = points.volume_ratio[p] * ratio
        trial_log_strain(
            increment,
            points.elastic_log_strain[p],
            scratch.trial,
            scratch.stretches,
            scratch.vectors,
        )
        from_mandel(scratch.trial, updated.elastic_log_strain[p])
    if has_mean_dilatation:
        _smooth_volumetric_strain(
            point_order, first, last, points, geostatic_trace, trace_gradient, updated
        )
    for entry in range(first, last):
        if _return_to_yield_surface(point_order[entry], points, materials, scratch, updated):
            return LAW_FAILED
    return 0


@jit
def _move_point(p, cell_nodes, displacement, points, values, updated):
    """Move point ``p`` with the displacement of its cell, given its shape ``values``."""
    for i in range(displacement.shape[1]):
        motion = 0.0
        for a in range(cell_nodes.shape[0]):
            motion += values[a] * displacement[cell_nodes[a], i]
        updated.position[p, i] = points.position[p, i] + motion
        updated.displacement[p, i] = points.displacement[p, i] + motion


@jit
def _smooth_volumetric_strain(
    point_order, first, last, points, geostatic_trace, trace_gradient, updated
):
    """Give the points of each soil of a cell their mean volumetric strain.

    What the strain differs from point to point in undisturbed ground is kept.
    """
    for entry in range(first, last):
        row = points.material[point_order[entry]]
        is_first = True
        for earlier in range(first, entry):
            if points.material[point_order[earlier]] == row:
                is_first = False
                break
        if is_first:
            _smooth_soil(
                row, point_order, entry, last, points, geostatic_trace, trace_gradient, updated
            )


@jit
def _smooth_soil(row, point_order, first, last, points, geostatic_trace, trace_gradient, updated):
    """Give the points of the soil ``row`` among those of a cell their mean volumetric strain."""
    vertical = updated.position.shape[1] - 1
    volume = mean = undisturbed = 0.0
    for entry in range(first, last):
        p = point_order[entry]
        if points.material[p] != row:
            continue
        weight = updated.volume[p]
        strain = updated.elastic_log_strain[p]
        volume += weight
        mean += weight * (strain[0, 0] + strain[1, 1] + strain[2, 2])
        undisturbed += weight * _geostatic_trace(
            p, vertical, points, geostatic_trace, trace_gradient, updated
        )
    for entry in range(first, last):
        p = point_order[entry]
        if points.material[p] != row:
            continue
        strain = updated.elastic_log_strain[p]
        here = _geostatic_trace(p, vertical, points, geostatic_trace, trace_gradient, updated)
        target = (mean - undisturbed) / volume + here
        correction = (target - strain[0, 0] - strain[1, 1] - strain[2, 2]) / 3.0
        for i in range(3):
            strain[i, i] += correction


@jit
def _geostatic_trace(p, vertical, points, geostatic_trace, trace_gradient, updated):
    """Return the volumetric strain of undisturbed ground where point ``p`` has moved to."""
    rise = updated.position[p, vertical] - points.position[p, vertical]
    return geostatic_trace[p] + trace_gradient[p] * rise


@jit
def _return_to_yield_surface(p, points, materials, scratch, updated):
    """Evaluate the law of point ``p`` at the trial strain in ``updated``; return its status."""
    row = points.material[p]
    to_mandel(updated.elastic_log_strain[p], scratch.trial)
    status = update_stress(
        materials.model[row], scratch.trial, materials.parameters[row], points.state_variables[p],
        scratch.stress, scratch.strain, updated.state_variables[p], scratch.tangent,
    )  # fmt: skip
    from_mandel(scratch.strain, updated.elastic_log_strain[p])
    from_mandel(scratch.stress, updated.kirchhoff_stress[p])
    return status
