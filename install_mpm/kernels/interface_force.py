"""Interface elements: f = B^T R_t^T t A and K = B^T R_t^T D R_w B A (paper, eqs 8-10)."""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit
from install_mpm.constitutive.coulomb_interface import update_traction


@jit
def evaluate_interface(
    nodes, shape_values, area, parameters, traction_old, axes, pile_displacement, displacement,
    force, stiffness, traction,
):  # fmt: skip
    """Fill ``force`` (n_elements, n_nodes, dim).

    Its ``stiffness`` and the ``traction`` (n_points, dim).

    ``axes`` are the ``StepAxes``.  ``pile_displacement`` (n_points, dim) is the rigid motion of the
    points in the step; elements with pile-side nodes take the motion from ``displacement``
    (n_nodes, dim) as well.
    """
    n_points_per_element, n_facet_nodes = shape_values.shape
    n_nodes = nodes.shape[1]
    dim = displacement.shape[1]
    slip = np.empty(dim)
    local_slip = np.empty(dim)
    tangent = np.empty((dim, dim))
    global_tangent = np.empty((dim, dim))
    operator = np.empty(n_nodes)
    force[:] = 0.0
    stiffness[:] = 0.0
    for e in range(nodes.shape[0]):
        for local in range(n_points_per_element):
            q = e * n_points_per_element + local
            traction[q] = 0.0
            if area[q] == 0.0:
                continue
            for a in range(n_nodes):
                sign = -1.0 if a < n_facet_nodes else 1.0
                operator[a] = sign * shape_values[local, a % n_facet_nodes]
            for i in range(dim):
                slip[i] = pile_displacement[q, i]
                for a in range(n_nodes):
                    slip[i] += operator[a] * displacement[nodes[e, a], i]
            for i in range(dim):
                local_slip[i] = 0.0
                for j in range(dim):
                    local_slip[i] += axes.slip[q, i, j] * slip[j]
            update_traction(local_slip, parameters[q], traction_old[q], traction[q], tangent)
            _rotate_tangent(tangent, axes.traction[q], axes.slip_change[q], global_tangent)
            for a in range(n_nodes):
                for i in range(dim):
                    for k in range(dim):
                        force[e, a, i] += (
                            operator[a] * area[q] * axes.traction[q, k, i] * traction[q, k]
                        )
                    for b in range(n_nodes):
                        for j in range(dim):
                            stiffness[e, a, i, b, j] += (
                                operator[a] * operator[b] * area[q] * global_tangent[i, j]
                            )


@jit
def _rotate_tangent(tangent, traction_axes, slip_axes, rotated):
    """Fill ``rotated`` = R_traction^T D R_slip."""
    dim = tangent.shape[0]
    for i in range(dim):
        for j in range(dim):
            total = 0.0
            for k in range(dim):
                for m in range(dim):
                    total += traction_axes[k, i] * tangent[k, m] * slip_axes[m, j]
            rotated[i, j] = total
