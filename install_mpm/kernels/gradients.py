"""Nodal values to 3 x 3 gradients: the place where the dimension enters."""

from __future__ import annotations

from install_mpm._jit import jit
from install_mpm.cells import reference_gradients


@jit
def shape_gradients(cell_type, xi, nodes, cell_nodes, reference, gradients):
    """Fill ``gradients`` (n_nodes, dim) with d N / d x at ``xi`` of a cell.

    Return the Jacobian determinant.

    ``nodes`` (n, dim) are all coordinates, ``cell_nodes`` (n_nodes,) those of the cell;
    ``reference`` is scratch of the shape of ``gradients``.
    """
    reference_gradients(cell_type, xi, reference)
    if nodes.shape[1] == 2:
        return _shape_gradients_plane(nodes, cell_nodes, reference, gradients)
    return _shape_gradients_space(nodes, cell_nodes, reference, gradients)


@jit
def _shape_gradients_plane(nodes, cell_nodes, reference, gradients):
    """Fill ``gradients`` (n_nodes, 2); return the Jacobian."""
    a00 = a01 = a10 = a11 = 0.0
    for a in range(cell_nodes.shape[0]):
        x, y = nodes[cell_nodes[a], 0], nodes[cell_nodes[a], 1]
        a00 += x * reference[a, 0]
        a01 += x * reference[a, 1]
        a10 += y * reference[a, 0]
        a11 += y * reference[a, 1]
    jacobian = a00 * a11 - a01 * a10
    for a in range(cell_nodes.shape[0]):
        gradients[a, 0] = (a11 * reference[a, 0] - a10 * reference[a, 1]) / jacobian
        gradients[a, 1] = (a00 * reference[a, 1] - a01 * reference[a, 0]) / jacobian
    return jacobian


@jit
def _shape_gradients_space(nodes, cell_nodes, reference, gradients):
    """Fill ``gradients`` (n_nodes, 3); return the Jacobian.  Rows of A: dx/dxi, dy/dxi, dz/dxi."""
    a00 = a01 = a02 = a10 = a11 = a12 = a20 = a21 = a22 = 0.0
    for a in range(cell_nodes.shape[0]):
        x, y, z = nodes[cell_nodes[a], 0], nodes[cell_nodes[a], 1], nodes[cell_nodes[a], 2]
        g0, g1, g2 = reference[a, 0], reference[a, 1], reference[a, 2]
        a00 += x * g0
        a01 += x * g1
        a02 += x * g2
        a10 += y * g0
        a11 += y * g1
        a12 += y * g2
        a20 += z * g0
        a21 += z * g1
        a22 += z * g2
    c00, c01, c02 = a11 * a22 - a12 * a21, a12 * a20 - a10 * a22, a10 * a21 - a11 * a20
    c10, c11, c12 = a02 * a21 - a01 * a22, a00 * a22 - a02 * a20, a01 * a20 - a00 * a21
    c20, c21, c22 = a01 * a12 - a02 * a11, a02 * a10 - a00 * a12, a00 * a11 - a01 * a10
    jacobian = a00 * c00 + a01 * c01 + a02 * c02
    for a in range(cell_nodes.shape[0]):
        g0, g1, g2 = reference[a, 0], reference[a, 1], reference[a, 2]
        gradients[a, 0] = (c00 * g0 + c01 * g1 + c02 * g2) / jacobian
        gradients[a, 1] = (c10 * g0 + c11 * g1 + c12 * g2) / jacobian
        gradients[a, 2] = (c20 * g0 + c21 * g1 + c22 * g2) / jacobian
    return jacobian


@jit
def hoop_gradients(shape_values, nodes, cell_nodes, hoop):
    """Fill ``hoop`` (n_nodes,) with N_a / r of an axisymmetric cell; return the radius r in m."""
    radius = 0.0
    for a in range(cell_nodes.shape[0]):
        radius += shape_values[a] * nodes[cell_nodes[a], 0]
    for a in range(cell_nodes.shape[0]):
        hoop[a] = shape_values[a] / radius
    return radius


@jit
def add_hoop_gradient(displacement, cell_nodes, hoop, gradient):
    """Add the hoop term u_r / r to ``gradient`` (3, 3), axis 2."""
    for a in range(cell_nodes.shape[0]):
        gradient[2, 2] += hoop[a] * displacement[cell_nodes[a], 0]


@jit
def displacement_gradient(displacement, cell_nodes, gradients, gradient):
    """Fill ``gradient`` (3, 3) with du_i/dx_j of nodal ``displacement``, zero out of plane."""
    gradient[:, :] = 0.0
    dim = gradients.shape[1]
    for a in range(cell_nodes.shape[0]):
        for i in range(dim):
            for j in range(dim):
                gradient[i, j] += displacement[cell_nodes[a], i] * gradients[a, j]
