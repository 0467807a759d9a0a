"""Stored energies of the annulus of PA8 and PA9, with their derivatives.

A point of radius R and angle Theta moves to r(R), Theta + phi(R).  With q = (r', r, phi') the
in-plane deformation gradient has I = tr(F^T F) = r'^2 + r^2 phi'^2 + (r / R)^2 and J = r' r / R.
In plane strain the energy per volume is psi(ln J, I):

Hencky psi = G (e1^2 + e2^2) + lambda/2 (e1 + e2)^2 with the principal logarithmic strains,
e1 + e2 = ln J and cosh(e1 - e2) = I / (2 J);

neo-Hookean psi = G/2 (I - 2 - 2 ln J) + lambda/2 (ln J)^2.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

EnergyLaw = Callable[[np.ndarray, np.ndarray, float, float], tuple[np.ndarray, np.ndarray]]
"""(ln J, I, G, lambda) -> first derivatives (2, n) and second derivatives (2, 2, n) of psi."""


def hencky(
    log_j: np.ndarray, i1: np.ndarray, g: float, lame: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the derivatives of the Hencky energy by ln J and I."""
    half = 0.5 * np.exp(-log_j)
    cosh = np.maximum(i1 * half, 1.0)
    d = np.arccosh(cosh)  # e1 - e2
    is_small = d < 1e-2
    safe = np.where(is_small, 1.0, d)
    first = np.where(is_small, 2.0 - d**2 / 3.0, 2.0 * safe / np.sinh(safe))
    curvature = 2.0 * (1.0 - safe / np.tanh(safe)) / np.sinh(safe) ** 2
    second = np.where(is_small, -2.0 / 3.0 + 4.0 / 15.0 * d**2, curvature)
    by_j, by_i = -cosh, half  # derivatives of cosh(d)
    gradient = 0.5 * g * np.array([first * by_j, first * by_i])
    gradient[0] += (g + lame) * log_j
    mixed = 0.5 * g * (second * by_j * by_i - first * half)
    hessian_jj = g + lame + 0.5 * g * (second * by_j**2 + first * cosh)
    return gradient, np.array([[hessian_jj, mixed], [mixed, 0.5 * g * second * by_i**2]])


def neo_hookean(
    log_j: np.ndarray, i1: np.ndarray, g: float, lame: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the derivatives of the neo-Hookean energy by ln J and I."""
    one, zero = np.ones_like(i1), np.zeros_like(i1)
    gradient = np.array([lame * log_j - g, 0.5 * g * one])
    return gradient, np.array([[lame * one, zero], [zero, zero]])


def energy_derivatives(
    q: np.ndarray, radius: np.ndarray, energy: EnergyLaw, moduli: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Return first (3, n) and second (3, 3, n) derivatives of psi by q."""
    slope, r, twist = q
    zero = np.zeros_like(r)
    hoop = twist**2 + 1.0 / radius**2
    log_j, i1 = np.log(slope * r / radius), slope**2 + r**2 * hoop
    by_invariant, second = energy(log_j, i1, *moduli)
    invariant_by_q = np.array(
        [[1.0 / slope, 1.0 / r, zero], [2.0 * slope, 2.0 * r * hoop, 2.0 * r**2 * twist]]
    )
    hessian = np.einsum("ab...,ai...,bj...->ij...", second, invariant_by_q, invariant_by_q)
    hessian[0, 0] += 2.0 * by_invariant[1] - by_invariant[0] / slope**2
    hessian[1, 1] += 2.0 * by_invariant[1] * hoop - by_invariant[0] / r**2
    hessian[1, 2] += 4.0 * by_invariant[1] * r * twist
    hessian[2, 1] = hessian[1, 2]
    hessian[2, 2] += 2.0 * by_invariant[1] * r**2
    return np.einsum("a...,ai...->i...", by_invariant, invariant_by_q), hessian
