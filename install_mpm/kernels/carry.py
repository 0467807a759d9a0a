"""From material points to integration points and back.

The points carry the state between meshes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm._jit import jit, parallel_jit, prange
from install_mpm.cells import shape_functions
from install_mpm.constitutive.dispatch import update_stress
from install_mpm.constitutive.hencky import determinant, trial_log_strain
from install_mpm.constitutive.mandel import from_mandel, to_mandel
from install_mpm.kernels.equilibrium import (
    CHUNKS,
    COLLAPSED,
    LAW_FAILED,
    SMALLEST_VOLUME_RATIO,
    scale_volume,
)
from install_mpm.kernels.gradients import displacement_gradient, shape_gradients


@jit
def nearest_integration_point(reference_coordinates, integration_coordinates):
    """Return the index of the integration point whose sub-region holds the reference coordinates.

    In a simplex the nearest one in barycentric distance belongs to the vertex with the largest
    coordinate.
    """
    nearest, nearest_distance = 0, 1e300
    dim = reference_coordinates.shape[0]
    for q in range(integration_coordinates.shape[0]):
        distance = 0.0
        total = 0.0
        for i in range(dim):
            difference = reference_coordinates[i] - integration_coordinates[q, i]
            distance += difference * difference
            total += difference
        distance += total * total  # the dependent barycentric coordinate
        if distance < nearest_distance:
            nearest, nearest_distance = q, distance
    return nearest


@jit
def sum_sub_regions(
    point_order, cell_start, points, vertical, strain_gradient, integration_coordinates,
    integration_height, totals,
):  # fmt: skip
    """Add up the material points of every sub-region into ``totals``.

    ``totals`` is a tuple of arrays over (cell, integration point): volume, mass, volume-weighted ln
    J, elastic strain (3, 3) and state variables, and the material of the largest contribution.  The
    strain is extrapolated from the point to the integration point with the geostatic gradient
    ``strain_gradient`` (n_materials, 3, 3) per metre of height, so that geostatic ground is carried
    without error.
    """
    volume, mass, log_ratio, strain, state, material = totals
    for c in range(cell_start.shape[0] - 1):
        for entry in range(cell_start[c], cell_start[c + 1]):
            p = point_order[entry]
            q = nearest_integration_point(points.reference_coordinates[p], integration_coordinates)
            weight = points.volume[p]
            volume[c, q] += weight
            mass[c, q] += points.mass[p]
            log_ratio[c, q] += weight * np.log(points.volume_ratio[p])
            rise = integration_height[c, q] - points.position[p, vertical]
            row = points.material[p]
            for i in range(3):
                for j in range(3):
                    strain[c, q, i, j] += weight * (
                        points.elastic_log_strain[p, i, j] + strain_gradient[row, i, j] * rise
                    )
            for s in range(state.shape[2]):
                state[c, q, s] += weight * points.state_variables[p, s]
            material[c, q] = row


@jit
def vertex_fill(
    cell_nodes, n_vertices, cell_volume, point_order, cell_start, points, filled, capacity
):
    """Add up, per vertex, the volume of soil ``filled`` and of cells ``capacity``, both (n_nodes,).

    The linear functions of the vertices share out both: quadratic ones are negative in places.
    """
    for c in range(cell_nodes.shape[0]):
        for v in range(n_vertices):
            capacity[cell_nodes[c, v]] += cell_volume[c] / n_vertices
        for entry in range(cell_start[c], cell_start[c + 1]):
            p = point_order[entry]
            last = 1.0
            for v in range(1, n_vertices):
                share = points.reference_coordinates[p, v - 1]
                last -= share
                filled[cell_nodes[c, v]] += points.volume[p] * share
            filled[cell_nodes[c, 0]] += points.volume[p] * last


@parallel_jit
def cell_geometry(
    cell_type, cell_nodes, nodes, integration_coordinates, shares, gradients, volume, height
):
    """Fill shape ``gradients`` (n_cells, n_ip, n_nodes, dim).

    Cell ``volume`` and ``height`` of the integration points.
    """
    n_cells, n_nodes = cell_nodes.shape
    dim = nodes.shape[1]
    for chunk in prange(CHUNKS):
        reference = np.empty((n_nodes, dim))
        values = np.empty(n_nodes)
        for c in range(chunk * n_cells // CHUNKS, (chunk + 1) * n_cells // CHUNKS):
            volume[c] = 0.0
            for q in range(integration_coordinates.shape[0]):
                xi = integration_coordinates[q]
                jacobian = shape_gradients(
                    cell_type, xi, nodes, cell_nodes[c], reference, gradients[c, q]
                )
                reference_volume = 4.0 if n_nodes == 4 else 0.5
                volume[c] += jacobian * shares[q] * reference_volume
                shape_functions(cell_type, xi, values)
                height[c, q] = 0.0
                for a in range(n_nodes):
                    height[c, q] += values[a] * nodes[cell_nodes[c, a], dim - 1]


@jit
def body_force(cell_type, cell_nodes, points, gravity, force):
    """Add the weight of the integration points to the nodal ``force`` (n_nodes, dim) in N."""
    n_nodes = cell_nodes.shape[1]
    vertical = force.shape[1] - 1
    values = np.empty(n_nodes)
    for c in range(cell_nodes.shape[0]):
        for q in range(points.cell_start[c], points.cell_start[c + 1]):
            weight = points.density[q] * points.volume[q] * gravity
            if weight == 0.0:
                continue
            shape_functions(cell_type, points.reference_coordinates[q], values)
            for a in range(n_nodes):
                force[cell_nodes[c, a], vertical] -= weight * values[a]


@parallel_jit
def carry_points(
    cell_type, cell_nodes, nodes, displacement, cell_volume_ratio, point_order, cell_start,
    points, materials, strain_gradient, has_mean_dilatation, updated, status,
):  # fmt: skip
    """Fill ``updated`` (MaterialPoints) with the state after the step.

    ``status`` (n_cells,) is 0 where it is sound.

    Every point deforms with its own dF, scaled to the volume change of its cell.  The volumetric
    part of the trial strains of a cell is then replaced by their mean (plus the geostatic
    gradient), because a pressure that the integration points do not see would otherwise stay with
    the points for ever.
    """
    n_cells = cell_nodes.shape[0]
    for chunk in prange(CHUNKS):
        scratch = _make_carry_scratch(cell_nodes.shape[1], nodes.shape[1])
        for c in range(chunk * n_cells // CHUNKS, (chunk + 1) * n_cells // CHUNKS):
            # numba loses writes to the fields of a tuple made in a parallel loop itself
            status[c] = _carry_cell(
                cell_type, cell_nodes[c], nodes, displacement, cell_volume_ratio[c], point_order,
                cell_start[c], cell_start[c + 1], points, materials, strain_gradient,
                has_mean_dilatation, scratch, updated,
            )  # fmt: skip


class CarryScratch(NamedTuple):
    """Work arrays of one chunk."""

    reference: np.ndarray
    gradients: np.ndarray
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
    materials, strain_gradient, has_mean_dilatation, scratch, updated,
):  # fmt: skip
    """Move and strain the points of one cell; return 0, or why its points are not sound."""
    dim = nodes.shape[1]
    for entry in range(first, last):
        p = point_order[entry]
        xi = points.reference_coordinates[p]
        increment = scratch.increment
        shape_gradients(cell_type, xi, nodes, cell_nodes, scratch.reference, scratch.gradients)
        displacement_gradient(displacement, cell_nodes, scratch.gradients, increment)
        for i in range(3):
            increment[i, i] += 1.0
        ratio = determinant(increment)
        if ratio < SMALLEST_VOLUME_RATIO:
            return COLLAPSED
        if has_mean_dilatation:
            scale_volume(increment, volume_ratio / ratio, dim)
            ratio = volume_ratio
        _move_point(p, cell_type, cell_nodes, displacement, xi, points, scratch.values, updated)
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
        _smooth_volumetric_strain(point_order, first, last, strain_gradient, updated)
    for entry in range(first, last):
        if _return_to_yield_surface(point_order[entry], points, materials, scratch, updated):
            return LAW_FAILED
    return 0


@jit
def _move_point(p, cell_type, cell_nodes, displacement, xi, points, values, updated):
    """Move point ``p`` with the displacement of its cell."""
    shape_functions(cell_type, xi, values)
    for i in range(displacement.shape[1]):
        motion = 0.0
        for a in range(cell_nodes.shape[0]):
            motion += values[a] * displacement[cell_nodes[a], i]
        updated.position[p, i] = points.position[p, i] + motion
        updated.displacement[p, i] = points.displacement[p, i] + motion


@jit
def _smooth_volumetric_strain(point_order, first, last, strain_gradient, updated):
    """Give all points of a cell its mean volumetric strain, plus the geostatic gradient."""
    vertical = updated.position.shape[1] - 1
    volume = mean = height = 0.0
    for entry in range(first, last):
        p = point_order[entry]
        weight = updated.volume[p]
        strain = updated.elastic_log_strain[p]
        volume += weight
        mean += weight * (strain[0, 0] + strain[1, 1] + strain[2, 2])
        height += weight * updated.position[p, vertical]
    for entry in range(first, last):
        p = point_order[entry]
        strain = updated.elastic_log_strain[p]
        gradient = strain_gradient[updated.material[p]]
        slope = gradient[0, 0] + gradient[1, 1] + gradient[2, 2]
        target = mean / volume + slope * (updated.position[p, vertical] - height / volume)
        correction = (target - strain[0, 0] - strain[1, 1] - strain[2, 2]) / 3.0
        for i in range(3):
            strain[i, i] += correction


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
