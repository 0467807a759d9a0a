"""Deformation of the integration points of a cell in a step, and its mean dilatation."""

from __future__ import annotations

from install_mpm._jit import jit
from install_mpm.constitutive.hencky import determinant
from install_mpm.kernels.cell_records import SMALLEST_VOLUME_RATIO
from install_mpm.kernels.gradients import add_hoop_gradient, displacement_gradient


@jit
def deform_cell(first, last, cell_nodes, points, displacement, options, scratch):
    """Fill dF, J, gx, h and d of the points of a cell, and its dbar.

    Returns
    -------
    float
        Jbar, or -1 if a point has collapsed.
    """
    scratch.mean_divergence[:, :] = 0.0
    dim = displacement.shape[1]
    volume = 0.0
    deformed_volume = 0.0
    for q in range(first, last):
        if points.volume[q] == 0.0:
            continue
        local = q - first
        increment = scratch.increment[local]
        displacement_gradient(displacement, cell_nodes, points.shape_gradients[q], increment)
        if options.is_axisymmetric:
            add_hoop_gradient(displacement, cell_nodes, points.hoop_gradients[q], increment)
        if not options.is_finite_strain:
            scratch.jacobian[local] = 1.0
            scratch.gradients[local] = points.shape_gradients[q]
            scratch.hoop[local] = points.hoop_gradients[q]
            continue
        for i in range(3):
            increment[i, i] += 1.0
        jacobian = determinant(increment)
        if jacobian < SMALLEST_VOLUME_RATIO or (dim == 2 and increment[2, 2] <= 0.0):
            return -1.0
        scratch.jacobian[local] = jacobian
        push_gradients(points.shape_gradients[q], increment, jacobian, scratch.gradients[local])
        scratch.divergence[local] = scratch.gradients[local]
        if options.is_axisymmetric:
            _push_hoop(points.hoop_gradients[q], increment, scratch, local)
        volume += points.volume[q]
        deformed_volume += points.volume[q] * jacobian
        scratch.mean_divergence[:, :] += points.volume[q] * jacobian * scratch.divergence[local]
    if volume == 0.0:
        return 1.0
    scratch.mean_divergence[:, :] /= deformed_volume
    return deformed_volume / volume


@jit
def _push_hoop(start, increment, scratch, local):
    """Fill h_a = N_a / r in the current position and add it to d_a."""
    for a in range(start.shape[0]):
        scratch.hoop[local, a] = start[a] / increment[2, 2]
        scratch.divergence[local, a, 0] += scratch.hoop[local, a]


@jit
def push_gradients(start, increment, jacobian, current):
    """Fill ``current`` = dF^-T ``start`` (n_nodes, dim): gradients by the current position."""
    if start.shape[1] == 2:
        in_plane = jacobian / increment[2, 2]
        for a in range(start.shape[0]):
            x, y = start[a, 0], start[a, 1]
            current[a, 0] = (increment[1, 1] * x - increment[1, 0] * y) / in_plane
            current[a, 1] = (increment[0, 0] * y - increment[0, 1] * x) / in_plane
        return
    f = increment
    c00, c01, c02 = _cross(f[1, 0], f[1, 1], f[1, 2], f[2, 0], f[2, 1], f[2, 2], jacobian)
    c10, c11, c12 = _cross(f[2, 0], f[2, 1], f[2, 2], f[0, 0], f[0, 1], f[0, 2], jacobian)
    c20, c21, c22 = _cross(f[0, 0], f[0, 1], f[0, 2], f[1, 0], f[1, 1], f[1, 2], jacobian)
    for a in range(start.shape[0]):
        x, y, z = start[a, 0], start[a, 1], start[a, 2]
        current[a, 0] = c00 * x + c01 * y + c02 * z
        current[a, 1] = c10 * x + c11 * y + c12 * z
        current[a, 2] = c20 * x + c21 * y + c22 * z


@jit
def _cross(ax, ay, az, bx, by, bz, divisor):
    """Return the cross product of a and b over ``divisor``: a row of the inverse transpose."""
    return (
        (ay * bz - az * by) / divisor,
        (az * bx - ax * bz) / divisor,
        (ax * by - ay * bx) / divisor,
    )


@jit
def scale_volume(increment, ratio, n_axes):
    """Scale ``increment`` (3, 3) in ``n_axes`` axes so that its determinant grows by ``ratio``."""
    factor = ratio ** (1.0 / n_axes)
    for i in range(n_axes):
        for j in range(3):
            increment[i, j] *= factor
