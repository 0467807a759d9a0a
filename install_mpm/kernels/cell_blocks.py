"""Force and stiffness blocks of a cell, integration point by integration point.

Notation: gx_a = grad N_a and h_a = N_a / r in the current position, d_a = d ln J / du_a and
dbar_a = d ln Jbar / du_a, C_ijkl = d tau_ij / d l_kl, l = grad(du).

Everything that has the form gx_aj M_ijkm gx_bm is gathered in one tensor M before it meets the
nodes: per pair of dofs that is the bulk of the arithmetic.  Stiffness blocks are matrices of the
dofs of the cell, node by node; their rows are filled in inner loops without sums, which vectorise.
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit


@jit
def add_force(gradients, hoop, weight, is_axisymmetric, tau, force):
    """Add tau gx_a, and tau_22 h_a on radial dofs; ``weight`` turns tau into Cauchy times volume.

    ``force`` is (n_nodes, dim).
    """
    n_nodes, dim = gradients.shape
    for a in range(n_nodes):
        for i in range(dim):
            total = 0.0
            for j in range(dim):
                total += tau[i, j] * gradients[a, j]
            force[a, i] += weight * total
        if is_axisymmetric:
            force[a, 0] += weight * tau[2, 2] * hoop[a]


@jit
def gather_moduli(weight, swapped, is_finite_strain, scratch):
    """Fill M_ijkm = weight (C_ijkm - delta_jk tau_im) + swapped delta_jk delta_im.

    The second term is d(gx_a) = -l^T gx_a of finite strain, the last one gives
    swapped gx_ak gx_bi.
    """
    tau, spatial, moduli = scratch.tensor, scratch.spatial, scratch.moduli
    dim = moduli.shape[0]
    for i in range(dim):
        for j in range(dim):
            for k in range(dim):
                for m in range(dim):
                    moduli[i, j, k, m] = weight * spatial[i, j, k, m]
            if is_finite_strain:
                for m in range(dim):
                    moduli[i, j, j, m] -= weight * tau[i, m]
            moduli[i, j, j, i] += swapped


@jit
def add_moduli(gradients, scratch, stiffness):
    """Add gx_aj M_ijkm gx_bm to ``stiffness`` (n_dofs, n_dofs)."""
    n_nodes, dim = gradients.shape
    moduli, columns = scratch.moduli, scratch.columns
    for i in range(dim):
        for j in range(dim):
            for b in range(n_nodes):
                for k in range(dim):
                    total = 0.0
                    for m in range(dim):
                        total += moduli[i, j, k, m] * gradients[b, m]
                    columns[i, j, b * dim + k] = total
    for a in range(n_nodes):
        for i in range(dim):
            for j in range(dim):
                _add_scaled(gradients[a, j], columns[i, j], stiffness[a * dim + i])


@jit
def _add_scaled(factor, vector, total):
    """Add ``factor`` times ``vector`` to ``total``."""
    for entry in range(vector.shape[0]):
        total[entry] += factor * vector[entry]


@jit
def add_product(left, right, stiffness):
    """Add the product of two vectors (n_dofs,) to ``stiffness`` (n_dofs, n_dofs)."""
    for row in range(left.shape[0]):
        _add_scaled(left[row], right, stiffness[row])


@jit
def add_hoop(gradients, hoop, weight, swapped, is_finite_strain, scratch, stiffness):
    """Add what the hoop stress of an axisymmetric cell does: tau_22 h_a on the radial dofs."""
    n_nodes, dim = gradients.shape
    tau, spatial = scratch.tensor, scratch.spatial
    geometric = tau[2, 2] if is_finite_strain else 0.0
    hoop_by_hoop = weight * (spatial[2, 2, 2, 2] - geometric) + swapped
    for a in range(n_nodes):
        for b in range(n_nodes):
            stiffness[a * dim, b * dim] += hoop_by_hoop * hoop[a] * hoop[b]
            for i in range(dim):
                plane_by_hoop = 0.0
                hoop_by_plane = 0.0
                for j in range(dim):
                    plane_by_hoop += gradients[a, j] * spatial[i, j, 2, 2]
                    hoop_by_plane += spatial[2, 2, i, j] * gradients[b, j]
                stiffness[a * dim + i, b * dim] += weight * plane_by_hoop * hoop[b]
                stiffness[a * dim, b * dim + i] += weight * hoop_by_plane * hoop[a]


@jit
def volume_modes(first, last, mean_ratio, points, scratch):
    """Return the sums v J and v ln(J/Jbar) over the points of a cell in m^3."""
    deformed_volume = 0.0
    total_strain = 0.0
    for q in range(first, last):
        if points.volume[q] > 0.0:
            jacobian = scratch.jacobian[q - first]
            deformed_volume += points.volume[q] * jacobian
            total_strain += points.volume[q] * np.log(jacobian / mean_ratio)
    return deformed_volume, total_strain


@jit
def add_dilatation(
    gradients, hoop, divergence, weight, modulus_volume, pressure, curvature, n_axes, scratch,
    force, stiffness,
):  # fmt: skip
    """Add what the mean dilatation and the volumetric term do at a point.

    d ln Jbar - d ln J = (dbar_b - d_b) . du_b scales dF in ``n_axes`` axes, and it takes volume
    from the point (``weight`` holds J / Jbar).  The energy (h_v/2) v ln(J/Jbar)^2 adds the force
    ``pressure`` (d_a - dbar_a); ``modulus_volume`` is h_v v, ``curvature`` the factor of -d_a d_b.
    """
    n_nodes, dim = gradients.shape
    left, right, stretch = scratch.left, scratch.right, scratch.stretch
    _fill_stretch(n_axes, scratch)
    for a in range(n_nodes):
        for i in range(dim):
            response = stretch[2, 2] * hoop[a] if i == 0 else 0.0
            for j in range(dim):
                response += stretch[i, j] * gradients[a, j]
            difference = divergence[a, i] - scratch.mean_divergence[a, i]
            force[a, i] += pressure * difference
            left[a * dim + i] = modulus_volume * difference - weight * response
            right[a * dim + i] = difference
    add_product(left, right, stiffness)
    if curvature == 0.0:
        return
    for a in range(n_nodes):
        for i in range(dim):
            left[a * dim + i] = -curvature * divergence[a, i]
            right[a * dim + i] = divergence[a, i]
    add_product(left, right, stiffness)


@jit
def _fill_stretch(n_axes, scratch):
    """Fill the change of tau, less tau itself, by a unit of ln J shared by ``n_axes`` axes."""
    tau, spatial, stretch = scratch.tensor, scratch.spatial, scratch.stretch
    for i in range(3):
        for j in range(3):
            stretch[i, j] = -tau[i, j]
            for m in range(n_axes):
                stretch[i, j] += spatial[i, j, m, m] / n_axes


@jit
def add_mean_modes(modulus_strain, scratch, stiffness):
    """Add ``modulus_strain`` dbar_a dbar_b, where it is h_v times the sum v ln(J/Jbar)."""
    n_nodes, dim = scratch.mean_divergence.shape
    left, right = scratch.left, scratch.right
    for a in range(n_nodes):
        for i in range(dim):
            right[a * dim + i] = scratch.mean_divergence[a, i]
            left[a * dim + i] = modulus_strain * scratch.mean_divergence[a, i]
    add_product(left, right, stiffness)
