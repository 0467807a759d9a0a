"""Geometry of the cells at the start of a step."""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit, parallel_jit, prange
from install_mpm.cells import shape_functions
from install_mpm.kernels.cell_records import CHUNKS
from install_mpm.kernels.gradients import hoop_gradients, shape_gradients


@parallel_jit
def cell_geometry(
    cell_type, cell_nodes, nodes, integration_coordinates, reference_volumes, is_axisymmetric,
    values, gradients, hoop, volume, height,
):  # fmt: skip
    """Fill geometry at the integration points of all cells, first axes (n_cells, n_ip).

    Filled: shape ``values`` (..., n_nodes), shape ``gradients`` (..., n_nodes, dim) in 1/m,
    ``hoop`` gradients (..., n_nodes) in 1/m, ``volume`` in m^3 and ``height`` in m.
    ``reference_volumes`` (n_ip,) are the weights of the rule on the reference cell.
    """
    n_cells, n_nodes = cell_nodes.shape
    for chunk in prange(CHUNKS):
        reference = np.empty((n_nodes, nodes.shape[1]))
        for c in range(chunk * n_cells // CHUNKS, (chunk + 1) * n_cells // CHUNKS):
            for q in range(integration_coordinates.shape[0]):
                xi = integration_coordinates[q]
                volume[c, q] = reference_volumes[q] * point_geometry(
                    cell_type, xi, nodes, cell_nodes[c], is_axisymmetric, reference, values[c, q],
                    gradients[c, q], hoop[c, q],
                )  # fmt: skip
                height[c, q] = 0.0
                for a in range(n_nodes):
                    height[c, q] += values[c, q, a] * nodes[cell_nodes[c, a], nodes.shape[1] - 1]


@jit
def point_geometry(
    cell_type, xi, nodes, cell_nodes, is_axisymmetric, reference, values, gradients, hoop
):
    """Fill shape ``values``, ``gradients`` and ``hoop`` gradients at ``xi`` of a cell.

    Returns
    -------
    float
        Volume per reference volume: the Jacobian, times 2 pi r in an axisymmetric cell.
    """
    jacobian = shape_gradients(cell_type, xi, nodes, cell_nodes, reference, gradients)
    shape_functions(cell_type, xi, values)
    if not is_axisymmetric:
        hoop[:] = 0.0
        return jacobian
    return jacobian * 2.0 * np.pi * hoop_gradients(values, nodes, cell_nodes, hoop)
