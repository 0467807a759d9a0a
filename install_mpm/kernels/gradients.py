"""Nodal values to 3 x 3 gradients: the place where the dimension enters."""

from __future__ import annotations

from install_mpm._jit import jit
from install_mpm.cells import reference_gradients


@jit
def shape_gradients(cell_type, xi, nodes, vertex_nodes, reference, gradients):
    """Fill ``gradients`` (n_nodes, 2) with d N / d x at ``xi`` of a cell.

    Return the Jacobian determinant.

    ``nodes`` (n, 2) are all coordinates, ``vertex_nodes`` (n_nodes,) the cell's nodes;
    ``reference`` is scratch of the shape of ``gradients``.
    """
    reference_gradients(cell_type, xi, reference)
    a00 = a01 = a10 = a11 = 0.0
    for a in range(vertex_nodes.shape[0]):
        x, y = nodes[vertex_nodes[a], 0], nodes[vertex_nodes[a], 1]
        a00 += x * reference[a, 0]
        a01 += x * reference[a, 1]
        a10 += y * reference[a, 0]
        a11 += y * reference[a, 1]
    jacobian = a00 * a11 - a01 * a10
    for a in range(vertex_nodes.shape[0]):
        gradients[a, 0] = (a11 * reference[a, 0] - a10 * reference[a, 1]) / jacobian
        gradients[a, 1] = (a00 * reference[a, 1] - a01 * reference[a, 0]) / jacobian
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
