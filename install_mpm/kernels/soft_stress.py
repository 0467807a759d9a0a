"""Soft stress of a step that holds partly filled cells together.

Its forces must have no moment about the current positions, or supports and pile would differ by
it, and none may arise in a rigid motion.  With F of the step the second Piola-Kirchhoff stress

    S = k (F^T F - 1) ,    f_a = v F S G_a ,    G_a = grad N_a at the start of the step,

has the symmetric Kirchhoff stress F S F^T (Saint Venant and Kirchhoff; k is the shear modulus).  It
needs no inverse of F: the empty part of a cell may be folded.  Small strain takes S = k (H + H^T),
H = F - 1, and F = 1.

Where no moments are compared, in plane strain and axisymmetry, partly filled cells may resist their
own turning as well, which holds a ragged surface better at the same stiffness in compression:

    f_a = 2 k v H G_a
"""

from __future__ import annotations

from install_mpm._jit import jit
from install_mpm.kernels.gradients import add_hoop_gradient, displacement_gradient


@jit
def add_soft_stress(
    first, last, modulus_volume, cell_nodes, points, displacement, options, scratch, force,
    stiffness,
):  # fmt: skip
    """Add force (n_nodes, dim) and stiffness (n_dofs, n_dofs) of the soft stress of a cell.

    ``modulus_volume`` is k v in N m, the same for all its points, with soil or without.
    """
    deformation, strain = scratch.increment[0], scratch.tensor
    geometric = modulus_volume if options.is_finite_strain else 0.0
    for q in range(first, last):
        gradients, hoop = points.shape_gradients[q], points.hoop_gradients[q]
        displacement_gradient(displacement, cell_nodes, gradients, deformation)
        if options.is_axisymmetric:
            add_hoop_gradient(displacement, cell_nodes, hoop, deformation)
        _fill_strain(deformation, options.is_finite_strain, strain)
        _push_gradients(gradients, scratch)
        _add_in_plane(gradients, modulus_volume, geometric, scratch, force, stiffness)
        if options.is_axisymmetric:
            _add_hoop(
                hoop, modulus_volume, geometric, deformation[2, 2], strain[2, 2], force, stiffness
            )


@jit
def add_gradient_stiffness(
    first, last, modulus_volume, cell_nodes, points, displacement, force, stiffness
):
    """Add force (n_nodes, dim) and stiffness (n_dofs, n_dofs) of 2 k grad(u) : grad(v)."""
    n_nodes, dim = force.shape
    for q in range(first, last):
        gradients = points.shape_gradients[q]
        for a in range(n_nodes):
            for b in range(n_nodes):
                value = 0.0
                for j in range(dim):
                    value += gradients[a, j] * gradients[b, j]
                value *= 2.0 * modulus_volume
                for i in range(dim):
                    stiffness[a * dim + i, b * dim + i] += value
                    force[a, i] += value * displacement[cell_nodes[b], i]


@jit
def _fill_strain(deformation, is_finite_strain, strain):
    """Fill ``strain`` with S / k (3, 3), and turn ``deformation`` from H into F, or into 1."""
    for i in range(3):
        for j in range(3):
            strain[i, j] = deformation[i, j] + deformation[j, i]
            if is_finite_strain:
                for m in range(3):
                    strain[i, j] += deformation[m, i] * deformation[m, j]
    if not is_finite_strain:
        deformation[:, :] = 0.0
    for i in range(3):
        deformation[i, i] += 1.0


@jit
def _push_gradients(gradients, scratch):
    """Fill F G_a and S G_a / k, both (n_nodes, dim), and F F^T (dim, dim)."""
    n_nodes, dim = gradients.shape
    deformation, strain, left_stretch = scratch.increment[0], scratch.tensor, scratch.stretch
    pushed, stressed = scratch.gradients[0], scratch.divergence[0]
    for a in range(n_nodes):
        for i in range(dim):
            pushed[a, i], stressed[a, i] = 0.0, 0.0
            for j in range(dim):
                pushed[a, i] += deformation[i, j] * gradients[a, j]
                stressed[a, i] += strain[i, j] * gradients[a, j]
    for i in range(dim):
        for j in range(dim):
            left_stretch[i, j] = 0.0
            for m in range(dim):
                left_stretch[i, j] += deformation[i, m] * deformation[j, m]


@jit
def _add_in_plane(gradients, modulus_volume, geometric, scratch, force, stiffness):
    """Add F S G_a, and its derivative G_a.S G_b 1 + G_a.G_b F F^T + F G_b (x) F G_a.

    ``geometric``, k v or zero, is the factor of the first term of the derivative.
    """
    n_nodes, dim = gradients.shape
    deformation, left_stretch = scratch.increment[0], scratch.stretch
    pushed, stressed = scratch.gradients[0], scratch.divergence[0]
    for a in range(n_nodes):
        for i in range(dim):
            for j in range(dim):
                force[a, i] += modulus_volume * deformation[i, j] * stressed[a, j]
        for b in range(n_nodes):
            overlap, along_stress = 0.0, 0.0
            for j in range(dim):
                overlap += gradients[a, j] * gradients[b, j]
                along_stress += stressed[a, j] * gradients[b, j]
            for i in range(dim):
                stiffness[a * dim + i, b * dim + i] += geometric * along_stress
                for j in range(dim):
                    stiffness[a * dim + i, b * dim + j] += modulus_volume * (
                        overlap * left_stretch[i, j] + pushed[b, i] * pushed[a, j]
                    )


@jit
def _add_hoop(hoop, modulus_volume, geometric, stretch, strain, force, stiffness):
    """Add the hoop stress of an axisymmetric cell on its radial dofs."""
    n_nodes, dim = force.shape
    radial = geometric * strain + 2.0 * modulus_volume * stretch * stretch
    for a in range(n_nodes):
        force[a, 0] += modulus_volume * stretch * strain * hoop[a]
        for b in range(n_nodes):
            stiffness[a * dim, b * dim] += radial * hoop[a] * hoop[b]
