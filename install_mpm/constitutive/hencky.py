"""Finite strain around any small-strain law: logarithmic strain in, Kirchhoff stress out.

    b_e,trial = dF exp(2 eps_e) dF^T ,   eps_trial = 1/2 ln b_e,trial

The law then works on (eps_trial, tau) as if strains were small, and its consistent tangent D = d
tau / d eps_trial is turned into the spatial one by the chain rule through ln b (Coombs and Augarde
2020; Charlton et al. 2017).
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit
from install_mpm.constitutive.eigen import symmetric_eigen
from install_mpm.constitutive.mandel import COLUMN, ROW, SCALE

REPEATED = 1e-8
"""Relative distance of eigenvalues below which the divided difference of ln takes its limit."""


@jit
def determinant(tensor):
    """Return the determinant of a 3 x 3 tensor."""
    return (
        tensor[0, 0] * (tensor[1, 1] * tensor[2, 2] - tensor[1, 2] * tensor[2, 1])
        - tensor[0, 1] * (tensor[1, 0] * tensor[2, 2] - tensor[1, 2] * tensor[2, 0])
        + tensor[0, 2] * (tensor[1, 0] * tensor[2, 1] - tensor[1, 1] * tensor[2, 0])
    )


@jit
def trial_log_strain(increment, log_strain, trial, stretches_squared, directions):
    """Compute the trial elastic logarithmic strain of an elastic step.

    Parameters
    ----------
    increment : (3, 3)
        Deformation gradient increment dF.
    log_strain : (3, 3)
        Elastic logarithmic strain at the start of the step.
    trial, stretches_squared, directions
        Filled: trial strain (6,) Mandel; eigenvalues (3,) and eigenvectors (3, 3), in columns, of
        b_e,trial.
    """
    work = np.empty((3, 3))
    left_cauchy_green = np.empty((3, 3))
    work[:, :] = log_strain
    symmetric_eigen(work, stretches_squared, directions)
    # pushed[:, A] = dF n_A exp(eps_A), so that b_trial = sum of its columns' dyads
    for i in range(3):
        for a in range(3):
            pushed = 0.0
            for j in range(3):
                pushed += increment[i, j] * directions[j, a]
            work[i, a] = pushed * np.exp(stretches_squared[a])
    for i in range(3):
        for j in range(3):
            total = 0.0
            for a in range(3):
                total += work[i, a] * work[j, a]
            left_cauchy_green[i, j] = total
    symmetric_eigen(left_cauchy_green, stretches_squared, directions)
    for component in range(6):
        i, j = ROW[component], COLUMN[component]
        total = 0.0
        for a in range(3):
            total += 0.5 * np.log(stretches_squared[a]) * directions[i, a] * directions[j, a]
        trial[component] = SCALE[component] * total


@jit
def spatial_tangent(tangent, stretches_squared, directions, dim, spatial):
    """Fill ``spatial`` (3, 3, 3, 3) with d tau_ij / d l_kl, l = d(dF) dF^-1.

    Filled for k, l < ``dim`` and for k = l = 2, the out-of-plane direction of two dimensions.

    ``tangent`` (6, 6) is the consistent tangent of the law; the eigenpairs are those of b_e,trial.
    In the eigenbasis d eps_AB = w_AB (l_AB b_B + b_A l_BA) with w the divided difference of (1/2)
    ln.
    """
    weight = np.empty((3, 3))
    for a in range(3):
        for b in range(3):
            weight[a, b] = _half_log_difference(stretches_squared[a], stretches_squared[b])
    rate = np.empty((3, 3))
    strain = np.empty(6)
    for k in range(3):
        for m in range(3):
            if not is_modelled(k, m, dim):
                continue
            for a in range(3):
                for b in range(3):
                    rate[a, b] = weight[a, b] * (
                        directions[k, a] * directions[m, b] * stretches_squared[b]
                        + stretches_squared[a] * directions[k, b] * directions[m, a]
                    )
            for component in range(6):
                i, j = ROW[component], COLUMN[component]
                total = 0.0
                for a in range(3):
                    for b in range(3):
                        total += directions[i, a] * rate[a, b] * directions[j, b]
                strain[component] = SCALE[component] * total
            for component in range(6):
                total = 0.0
                for other in range(6):
                    total += tangent[component, other] * strain[other]
                i, j = ROW[component], COLUMN[component]
                spatial[i, j, k, m] = total / SCALE[component]
                spatial[j, i, k, m] = total / SCALE[component]


@jit
def is_modelled(k, m, dim):
    """Return whether a gradient can have a component (k, m)."""
    return (k < dim and m < dim) or (k == 2 and m == 2)


@jit
def _half_log_difference(first, second):
    """Return (ln first - ln second) / 2 / (first - second), or its limit where they are equal."""
    if abs(first - second) <= REPEATED * first:
        return 1.0 / (first + second)
    return 0.5 * np.log(first / second) / (first - second)


@jit
def small_trial_strain(displacement_gradient, strain, trial):
    """Fill the small trial strain (6,): ``strain`` (3, 3) plus the symmetric gradient."""
    for component in range(6):
        i, j = ROW[component], COLUMN[component]
        trial[component] = SCALE[component] * (
            strain[i, j] + 0.5 * (displacement_gradient[i, j] + displacement_gradient[j, i])
        )


@jit
def small_tangent(tangent, dim, spatial):
    """Fill ``spatial`` (3, 3, 3, 3) with d sigma_ij / d u_k,l of small strain, as above."""
    for first in range(6):
        i, j = ROW[first], COLUMN[first]
        for second in range(6):
            k, m = ROW[second], COLUMN[second]
            if is_modelled(k, m, dim):
                value = tangent[first, second] / (SCALE[first] * SCALE[second])
                spatial[i, j, k, m] = value
                spatial[j, i, k, m] = value
                spatial[i, j, m, k] = value
                spatial[j, i, m, k] = value
