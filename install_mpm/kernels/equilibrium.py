"""Internal force and stiffness of the cells for a trial displacement increment.

With mean dilatation the deformation of each integration point keeps its shape but takes the volume
change of its cell,

    Jbar = sum(v J) / sum(v) ,   dFbar = (Jbar / J)^(1/n) dF   (n = 2 in plane strain, 3 otherwise),

and the Cauchy stress of dFbar is integrated over the current volume v J (de Souza Neto et al. 1996
with an element mean).  The volumetric term adds the energy (h_v/2) v ln(J/Jbar)^2 of *this step
only*: it resists the volume modes that the mean leaves free and is never stored.
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit, parallel_jit, prange
from install_mpm.constitutive.dispatch import update_stress
from install_mpm.constitutive.hencky import (
    small_tangent,
    small_trial_strain,
    spatial_tangent,
    trial_log_strain,
)
from install_mpm.constitutive.mandel import from_mandel
from install_mpm.kernels.cell_blocks import (
    add_dilatation,
    add_force,
    add_hoop,
    add_mean_modes,
    add_moduli,
    gather_moduli,
    volume_modes,
)
from install_mpm.kernels.cell_deformation import deform_cell, scale_volume
from install_mpm.kernels.cell_records import (
    CHUNKS,
    COLLAPSED,
    LAW_FAILED,
    dilatation_axes,
    make_scratch,
)
from install_mpm.kernels.soft_stress import add_gradient_stiffness, add_soft_stress


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
    n_dofs = n_nodes * dim
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
                    force[c], stiffness[c].reshape(n_dofs, n_dofs), trial,
                )  # fmt: skip


@jit
def _evaluate_cell(
    c, cell_nodes, points, displacement, materials, options, scratch, force, stiffness, trial
):
    """Fill force (n_nodes, dim), stiffness (n_dofs, n_dofs) and trial state of cell ``c``."""
    trial.status[c] = 0
    first, last = points.cell_start[c], points.cell_start[c + 1]
    mean_ratio = deform_cell(first, last, cell_nodes, points, displacement, options, scratch)
    if mean_ratio <= 0.0:
        trial.status[c] = COLLAPSED
        return
    trial.cell_volume_ratio[c] = mean_ratio
    n_axes = dilatation_axes(displacement.shape[1], options.is_axisymmetric)
    modulus, cell_volume, cell_strain = 0.0, 1.0, 0.0
    if options.has_mean_dilatation and options.volumetric_term[c] > 0.0:
        modulus = options.volumetric_term[c]
        cell_volume, cell_strain = volume_modes(first, last, mean_ratio, points, scratch)
    for q in range(first, last):
        if points.volume[q] == 0.0:
            continue
        if _update_point(
            q, q - first, mean_ratio, n_axes, points, materials, options, scratch, trial
        ):
            trial.status[c] = LAW_FAILED
            return
        curvature = modulus * cell_strain / cell_volume
        _add_point(
            q, q - first, mean_ratio, n_axes, modulus, curvature, points, options, scratch, force,
            stiffness, trial,
        )  # fmt: skip
    if modulus > 0.0:
        add_mean_modes(modulus * cell_strain, scratch, stiffness)
    if options.soft_stiffness[c] > 0.0 and options.has_moment_free_soft_stress:
        add_soft_stress(
            first, last, options.soft_stiffness[c], cell_nodes, points, displacement, options,
            scratch, force, stiffness,
        )  # fmt: skip
    elif options.soft_stiffness[c] > 0.0:
        add_gradient_stiffness(
            first, last, options.soft_stiffness[c], cell_nodes, points, displacement, force,
            stiffness,
        )  # fmt: skip


@jit
def _update_point(q, local, mean_ratio, n_axes, points, materials, options, scratch, trial):
    """Evaluate the law at point ``q``: tau in ``scratch.tensor``, C in ``scratch.spatial``."""
    row = points.material[q]
    dim = points.shape_gradients.shape[2]
    increment = scratch.increment[local]
    if options.is_finite_strain:
        if options.has_mean_dilatation:
            scale_volume(increment, mean_ratio / scratch.jacobian[local], n_axes)
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
def _add_point(
    q, local, mean_ratio, n_axes, modulus, curvature, points, options, scratch, force, stiffness,
    trial,
):  # fmt: skip
    """Store the Cauchy stress of point ``q`` and add its force and stiffness to the cell's.

    ``modulus`` is h_v in Pa; ``curvature`` in Pa is h_v times the mean of ln(J/Jbar) in the cell.
    """
    ratio = mean_ratio if options.has_mean_dilatation else scratch.jacobian[local]
    total_ratio = points.volume_ratio[q] * ratio if options.is_finite_strain else 1.0
    trial.volume_ratio[q] = ratio
    for i in range(3):
        for j in range(3):
            trial.cauchy_stress[q, i, j] = scratch.tensor[i, j] / total_ratio
    volume, jacobian = points.volume[q], scratch.jacobian[local]
    weight = volume * jacobian / total_ratio
    pressure = modulus * volume * np.log(jacobian / mean_ratio) if modulus > 0.0 else 0.0
    curvature *= volume * jacobian
    gradients, hoop = scratch.gradients[local], scratch.hoop[local]
    is_finite, is_axisymmetric = options.is_finite_strain, options.is_axisymmetric
    add_force(gradients, hoop, weight, is_axisymmetric, scratch.tensor, force)
    gather_moduli(weight, curvature - pressure, is_finite, scratch)
    add_moduli(gradients, scratch, stiffness)
    if is_axisymmetric:
        add_hoop(gradients, hoop, weight, curvature - pressure, is_finite, scratch, stiffness)
    if options.has_mean_dilatation:
        add_dilatation(
            gradients, hoop, scratch.divergence[local], weight, modulus * volume, pressure,
            curvature, n_axes, scratch, force, stiffness,
        )  # fmt: skip
