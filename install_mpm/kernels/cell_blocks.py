"""Force and stiffness blocks of a cell, integration point by integration point.

Notation: gx_a = grad N_a and h_a = N_a / r in the current position, d_a = d ln J / du_a and
dbar_a = d ln Jbar / du_a, C_ijkl = d tau_ij / d l_kl, l = grad(du).
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit


@jit
def add_point(gradients, weight, is_finite_strain, scratch, force, stiffness):
    """Add tau gx_a and its derivative; ``weight`` turns tau into Cauchy stress times volume."""
    n_nodes, dim = gradients.shape
    tau, spatial = scratch.tensor, scratch.spatial
    traction, contracted = scratch.traction, scratch.contracted
    for a in range(n_nodes):
        for i in range(dim):
            traction[i] = 0.0
            for j in range(dim):
                traction[i] += weight * tau[i, j] * gradients[a, j]
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
                    stiffness[a, i, b, k] += total
        if is_finite_strain:
            # the gradient itself changes: d(gx_a) = -l^T gx_a
            for b in range(n_nodes):
                for i in range(dim):
                    stress = 0.0
                    for j in range(dim):
                        stress += tau[i, j] * gradients[b, j]
                    for k in range(dim):
                        stiffness[a, i, b, k] -= weight * stress * gradients[a, k]


@jit
def add_hoop(gradients, hoop, weight, is_finite_strain, scratch, force, stiffness):
    """Add what the hoop stress of an axisymmetric cell does: tau_22 h_a on the radial dofs."""
    n_nodes, dim = gradients.shape
    tau, spatial = scratch.tensor, scratch.spatial
    geometric = tau[2, 2] if is_finite_strain else 0.0
    for a in range(n_nodes):
        force[a, 0] += weight * tau[2, 2] * hoop[a]
        for b in range(n_nodes):
            stiffness[a, 0, b, 0] += weight * (spatial[2, 2, 2, 2] - geometric) * hoop[a] * hoop[b]
            for i in range(dim):
                plane_by_hoop = 0.0
                hoop_by_plane = 0.0
                for j in range(dim):
                    plane_by_hoop += gradients[a, j] * spatial[i, j, 2, 2]
                    hoop_by_plane += spatial[2, 2, i, j] * gradients[b, j]
                stiffness[a, i, b, 0] += weight * plane_by_hoop * hoop[b]
                stiffness[a, 0, b, i] += weight * hoop_by_plane * hoop[a]


@jit
def add_dilatation_coupling(gradients, hoop, divergence, weight, n_axes, scratch, stiffness):
    """Add what d ln Jbar - d ln J = (dbar_b - d_b) . du_b does to the forces of a point.

    It scales dF in ``n_axes`` axes, and it takes volume from the point (``weight`` holds J / Jbar).
    """
    n_nodes, dim = gradients.shape
    tau, spatial, mean = scratch.tensor, scratch.spatial, scratch.mean_divergence
    for a in range(n_nodes):
        for i in range(dim):
            response = 0.0
            for j in range(dim):
                stretch = -tau[i, j]
                for m in range(n_axes):
                    stretch += spatial[i, j, m, m] / n_axes
                response += stretch * gradients[a, j]
            if i == 0:
                stretch = -tau[2, 2]
                for m in range(n_axes):
                    stretch += spatial[2, 2, m, m] / n_axes
                response += stretch * hoop[a]
            for b in range(n_nodes):
                for k in range(dim):
                    stiffness[a, i, b, k] += weight * response * (mean[b, k] - divergence[b, k])


@jit
def add_volumetric_term(first, last, mean_ratio, modulus, points, scratch, force, stiffness):
    """Add force and stiffness of the energy (h_v/2) sum v ln(J/Jbar)^2."""
    n_nodes, dim = scratch.mean_divergence.shape
    mean = scratch.mean_divergence
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
        gradients, hoop = scratch.gradients[local], scratch.hoop[local]
        divergence = scratch.divergence[local]
        volume, jacobian = points.volume[q], scratch.jacobian[local]
        pressure = modulus * volume * np.log(jacobian / mean_ratio)
        curvature = modulus * total_strain * volume * jacobian / deformed_volume
        for a in range(n_nodes):
            for i in range(dim):
                difference = divergence[a, i] - mean[a, i]
                force[a, i] += pressure * difference
                for b in range(n_nodes):
                    for k in range(dim):
                        swapped = gradients[a, k] * gradients[b, i]
                        if i == 0 and k == 0:
                            swapped += hoop[a] * hoop[b]
                        stiffness[a, i, b, k] += (
                            modulus * volume * difference * (divergence[b, k] - mean[b, k])
                            - pressure * swapped
                            - curvature * (divergence[a, i] * divergence[b, k] - swapped)
                        )
    for a in range(n_nodes):
        for i in range(dim):
            for b in range(n_nodes):
                for k in range(dim):
                    stiffness[a, i, b, k] += modulus * total_strain * mean[a, i] * mean[b, k]


@jit
def add_soft_stiffness(
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
