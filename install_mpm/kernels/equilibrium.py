"""Internal force and stiffness of the cells for a trial displacement increment.

With mean dilatation the deformation of each integration point keeps its shape but takes the volume
change of its cell,

    Jbar = sum(v J) / sum(v) ,   dFbar = (Jbar / J)^(1/n) dF   (n = 2 in plane strain, 3 in space),

and the Cauchy stress of dFbar is integrated over the current volume v J (de Souza Neto et al. 1996
with an element mean).  The volumetric term adds the energy (h_v/2) v ln(J/Jbar)^2 of *this step
only*: it resists the volume modes that the mean leaves free and is never stored.

Notation: g_a = grad N_a at the start of the step, gx_a in the current position, gbar_a = d ln Jbar
/ du_a, C_ijkl = d tau_ij / d l_kl.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm._jit import jit, parallel_jit, prange
from install_mpm.constitutive.dispatch import update_stress
from install_mpm.constitutive.hencky import (
    determinant,
    small_tangent,
    small_trial_strain,
    spatial_tangent,
    trial_log_strain,
)
from install_mpm.constitutive.mandel import from_mandel
from install_mpm.kernels.gradients import displacement_gradient

CHUNKS = 64
"""Cells are shared out in this many chunks, each with its own scratch.

Results do not depend on it.
"""

SMALLEST_VOLUME_RATIO = 0.05
"""A trial that compresses an integration point beyond this in one step is refused."""

COLLAPSED, LAW_FAILED = 1, 2


class CellOptions(NamedTuple):
    """Switches of the cell kernel and stiffnesses per cell."""

    is_finite_strain: bool
    has_mean_dilatation: bool
    volumetric_term: np.ndarray
    """h_v of each cell, (n_cells,) in Pa."""
    soft_stiffness: np.ndarray
    """Incremental stiffness of partly filled cells times volume per integration point.

    (n_cells,) in N m.
    """


class Scratch(NamedTuple):
    """Work arrays of one chunk."""

    gradient: np.ndarray
    jacobian: np.ndarray
    current_gradients: np.ndarray
    mean_gradient: np.ndarray
    spatial: np.ndarray
    tangent: np.ndarray
    trial: np.ndarray
    stress: np.ndarray
    strain: np.ndarray
    tensor: np.ndarray
    values: np.ndarray
    vectors: np.ndarray


@jit
def make_scratch(most_points, n_nodes, dim):
    """Return work arrays for cells of up to ``most_points`` integration points."""
    return Scratch(
        np.empty((most_points, 3, 3)),
        np.empty(most_points),
        np.empty((most_points, n_nodes, dim)),
        np.empty((n_nodes, dim)),
        np.zeros((3, 3, 3, 3)),
        np.empty((6, 6)),
        np.empty(6),
        np.empty(6),
        np.empty(6),
        np.empty((3, 3)),
        np.empty(3),
        np.empty((3, 3)),
    )


@parallel_jit
def evaluate_cells(
    cell_nodes, is_active, points, displacement, materials, options, force, stiffness, trial
):
    """Fill ``force`` in N, ``stiffness`` in N/m and ``trial`` of all cells, zeros where inactive.

    ``force`` is (n_cells, n_nodes, dim), ``stiffness`` (n_cells, n_nodes, dim, n_nodes, dim), and
    ``displacement`` (n_nodes, dim) the increment of the step.
    """
    n_cells, n_nodes = cell_nodes.shape
    dim = displacement.shape[1]
    most_points = 0
    for c in range(n_cells):
        most_points = max(most_points, points.cell_start[c + 1] - points.cell_start[c])
    for chunk in prange(CHUNKS):
        scratch = make_scratch(most_points, n_nodes, dim)
        for c in range(chunk * n_cells // CHUNKS, (chunk + 1) * n_cells // CHUNKS):
            force[c] = 0.0
            stiffness[c] = 0.0
            if is_active[c]:
                _evaluate_cell(
                    c, cell_nodes[c], points, displacement, materials, options, scratch,
                    force[c], stiffness[c], trial,
                )  # fmt: skip


@jit
def _evaluate_cell(
    c, cell_nodes, points, displacement, materials, options, scratch, force, stiffness, trial
):
    """Fill force, stiffness and trial state of cell ``c``."""
    dim = displacement.shape[1]
    trial.status[c] = 0
    first, last = points.cell_start[c], points.cell_start[c + 1]
    mean_ratio = _deform(first, last, cell_nodes, points, displacement, options, scratch)
    if mean_ratio <= 0.0:
        trial.status[c] = COLLAPSED
        return
    trial.cell_volume_ratio[c] = mean_ratio
    for q in range(first, last):
        if points.volume[q] == 0.0:
            continue
        if _update_point(q, q - first, mean_ratio, points, materials, options, scratch, trial, dim):
            trial.status[c] = LAW_FAILED
            return
        jacobian = scratch.jacobian[q - first]
        total_ratio = points.volume_ratio[q] * (
            mean_ratio if options.has_mean_dilatation else jacobian
        )
        weight = points.volume[q] * jacobian
        if not options.is_finite_strain:
            weight, total_ratio = points.volume[q], 1.0
        for i in range(3):
            for j in range(3):
                trial.cauchy_stress[q, i, j] = scratch.tensor[i, j] / total_ratio
        _add_point(
            scratch.current_gradients[q - first],
            weight / total_ratio,
            options,
            scratch,
            force,
            stiffness,
        )
    has_mean_dilatation = options.has_mean_dilatation and options.is_finite_strain
    if has_mean_dilatation and options.volumetric_term[c] > 0.0:
        _add_volumetric_term(
            first, last, mean_ratio, options.volumetric_term[c], points, scratch, force, stiffness
        )
    if options.soft_stiffness[c] > 0.0:
        _add_soft_stiffness(
            first,
            last,
            options.soft_stiffness[c],
            cell_nodes,
            points,
            displacement,
            force,
            stiffness,
        )


@jit
def _deform(first, last, cell_nodes, points, displacement, options, scratch):
    """Fill dF, J, current gradients and gbar of a cell.

    Return Jbar, or -1 if a point has collapsed.
    """
    dim = displacement.shape[1]
    n_nodes = cell_nodes.shape[0]
    scratch.mean_gradient[:, :] = 0.0
    volume = 0.0
    deformed_volume = 0.0
    for q in range(first, last):
        if points.volume[q] == 0.0:
            continue
        local = q - first
        increment = scratch.gradient[local]
        displacement_gradient(displacement, cell_nodes, points.shape_gradients[q], increment)
        if not options.is_finite_strain:
            scratch.jacobian[local] = 1.0
            scratch.current_gradients[local] = points.shape_gradients[q]
            volume += points.volume[q]
            deformed_volume += points.volume[q]
            continue
        for i in range(3):
            increment[i, i] += 1.0
        jacobian = determinant(increment)
        if jacobian < SMALLEST_VOLUME_RATIO:
            return -1.0
        scratch.jacobian[local] = jacobian
        push_gradients(
            points.shape_gradients[q], increment, jacobian, scratch.current_gradients[local]
        )
        volume += points.volume[q]
        deformed_volume += points.volume[q] * jacobian
        for a in range(n_nodes):
            for i in range(dim):
                scratch.mean_gradient[a, i] += (
                    points.volume[q] * jacobian * scratch.current_gradients[local, a, i]
                )
    if volume == 0.0:
        return 1.0
    for a in range(n_nodes):
        for i in range(dim):
            scratch.mean_gradient[a, i] /= deformed_volume
    return deformed_volume / volume


@jit
def push_gradients(start, increment, jacobian, current):
    """Fill ``current`` (n_nodes, dim) = dF^-T ``start``.

    Gradients by current instead of start-of-step position.
    """
    if start.shape[1] == 2:
        for a in range(start.shape[0]):
            current[a, 0] = (increment[1, 1] * start[a, 0] - increment[1, 0] * start[a, 1]) / (
                jacobian / increment[2, 2]
            )
            current[a, 1] = (increment[0, 0] * start[a, 1] - increment[0, 1] * start[a, 0]) / (
                jacobian / increment[2, 2]
            )
        return
    for a in range(start.shape[0]):
        for j in range(3):
            total = 0.0
            for i in range(3):
                n, m = (i + 1) % 3, (i + 2) % 3
                k, l = (j + 1) % 3, (j + 2) % 3
                cofactor = increment[n, k] * increment[m, l] - increment[n, l] * increment[m, k]
                total += cofactor * start[a, i] / jacobian
            current[a, j] = total


@jit
def scale_volume(increment, ratio, dim):
    """Scale ``increment`` (3, 3) in place so that its determinant grows by ``ratio``.

    In the modelled dimensions.
    """
    factor = ratio ** (1.0 / dim)
    for i in range(dim):
        for j in range(3):
            increment[i, j] *= factor


@jit
def _update_point(q, local, mean_ratio, points, materials, options, scratch, trial, dim):
    """Evaluate the law at point ``q``.

    Leave tau in ``scratch.tensor`` and C in ``scratch.spatial``.
    """
    row = points.material[q]
    increment = scratch.gradient[local]
    if options.is_finite_strain:
        if options.has_mean_dilatation:
            scale_volume(increment, mean_ratio / scratch.jacobian[local], dim)
        trial_log_strain(
            increment, points.elastic_log_strain[q], scratch.trial, scratch.values, scratch.vectors
        )
    else:
        small_trial_strain(increment, points.elastic_log_strain[q], scratch.trial)
    status = update_stress(
        materials.model[row], scratch.trial, materials.parameters[row], points.state_variables[q],
        scratch.stress, scratch.strain, trial.state_variables[q], scratch.tangent,
    )  # fmt: skip
    from_mandel(scratch.strain, trial.elastic_log_strain[q])
    from_mandel(scratch.stress, scratch.tensor)
    if options.is_finite_strain:
        spatial_tangent(scratch.tangent, scratch.values, scratch.vectors, dim, scratch.spatial)
    else:
        small_tangent(scratch.tangent, dim, scratch.spatial)
    return status


@jit
def _add_point(gradients, weight, options, scratch, force, stiffness):
    """Add one integration point; ``weight`` = v J / (J_n Jbar) makes tau a force times length."""
    n_nodes, dim = gradients.shape
    stress, spatial = scratch.tensor, scratch.spatial
    traction = np.empty(dim)
    contracted = np.empty((dim, dim, dim))
    for a in range(n_nodes):
        for i in range(dim):
            traction[i] = 0.0
            for j in range(dim):
                traction[i] += weight * stress[i, j] * gradients[a, j]
            force[a, i] += traction[i]
            for k in range(dim):
                for m in range(dim):
                    total = 0.0
                    for j in range(dim):
                        total += gradients[a, j] * spatial[i, j, k, m]
                    contracted[i, k, m] = weight * total
        for b in range(n_nodes):
            for i in range(dim):
                for k in range(dim):
                    total = 0.0
                    for m in range(dim):
                        total += contracted[i, k, m] * gradients[b, m]
                    if options.is_finite_strain:
                        # d(grad N_a): - (tau gx_b)_i gx_a,k
                        for j in range(dim):
                            total -= weight * stress[i, j] * gradients[b, j] * gradients[a, k]
                    stiffness[a, i, b, k] += total
        if options.has_mean_dilatation and options.is_finite_strain:
            _add_dilatation_coupling(
                a, contracted, traction, gradients, scratch.mean_gradient, stiffness
            )


@jit
def _add_dilatation_coupling(a, contracted, traction, gradients, mean_gradient, stiffness):
    """Add what d(ln Jbar) - d(ln J) = (gbar_b - gx_b) . du_b does to the force of node ``a``."""
    n_nodes, dim = gradients.shape
    for i in range(dim):
        response = -traction[i]
        for k in range(dim):
            response += contracted[i, k, k] / dim
        for b in range(n_nodes):
            for k in range(dim):
                stiffness[a, i, b, k] += response * (mean_gradient[b, k] - gradients[b, k])


@jit
def _add_volumetric_term(first, last, mean_ratio, modulus, points, scratch, force, stiffness):
    """Add force and stiffness of the energy (h_v/2) sum v ln(J/Jbar)^2."""
    n_nodes, dim = scratch.mean_gradient.shape
    mean = scratch.mean_gradient
    deformed_volume = 0.0
    total_strain = 0.0
    for q in range(first, last):
        if points.volume[q] == 0.0:
            continue
        deformed_volume += points.volume[q] * scratch.jacobian[q - first]
        total_strain += points.volume[q] * np.log(scratch.jacobian[q - first] / mean_ratio)
    for q in range(first, last):
        if points.volume[q] == 0.0:
            continue
        local = q - first
        gradients = scratch.current_gradients[local]
        volume, jacobian = points.volume[q], scratch.jacobian[local]
        pressure = modulus * volume * np.log(jacobian / mean_ratio)
        curvature = modulus * total_strain * volume * jacobian / deformed_volume
        for a in range(n_nodes):
            for i in range(dim):
                difference = gradients[a, i] - mean[a, i]
                force[a, i] += pressure * difference
                for b in range(n_nodes):
                    for k in range(dim):
                        swapped = gradients[a, k] * gradients[b, i]
                        stiffness[a, i, b, k] += (
                            modulus * volume * difference * (gradients[b, k] - mean[b, k])
                            - pressure * swapped
                            - curvature * (gradients[a, i] * gradients[b, k] - swapped)
                        )
    for a in range(n_nodes):
        for i in range(dim):
            for b in range(n_nodes):
                for k in range(dim):
                    stiffness[a, i, b, k] += modulus * total_strain * mean[a, i] * mean[b, k]


@jit
def _add_soft_stiffness(
    first, last, stiffness_volume, cell_nodes, points, displacement, force, stiffness
):
    """Add the incremental stiffness grad(u) : grad(v) that holds partly filled cells together."""
    n_nodes, dim = cell_nodes.shape[0], displacement.shape[1]
    for q in range(first, last):
        gradients = points.shape_gradients[q]
        for a in range(n_nodes):
            for b in range(n_nodes):
                value = 0.0
                for j in range(dim):
                    value += gradients[a, j] * gradients[b, j]
                value *= stiffness_volume
                for i in range(dim):
                    stiffness[a, i, b, i] += value
                    force[a, i] += value * displacement[cell_nodes[b], i]
