"""Shape functions and gradients at material points that are the quadrature."""

from __future__ import annotations

import numpy as np

from install_mpm._jit import parallel_jit, prange
from install_mpm.kernels.cell_geometry import point_geometry
from install_mpm.kernels.cell_records import CHUNKS


@parallel_jit
def point_shapes(
    cell_type, cell_nodes, nodes, is_axisymmetric, cell, reference_coordinates, values, gradients,
    hoop,
):  # fmt: skip
    """Fill shape ``values`` and ``hoop`` (n, n_nodes) and ``gradients`` (n, n_nodes, dim).

    ``cell`` (n,) and ``reference_coordinates`` (n, dim) say where the points are.
    """
    n_points = cell.shape[0]
    for chunk in prange(CHUNKS):
        reference = np.empty((cell_nodes.shape[1], nodes.shape[1]))
        for p in range(chunk * n_points // CHUNKS, (chunk + 1) * n_points // CHUNKS):
            point_geometry(
                cell_type, reference_coordinates[p], nodes, cell_nodes[cell[p]], is_axisymmetric,
                reference, values[p], gradients[p], hoop[p],
            )  # fmt: skip
