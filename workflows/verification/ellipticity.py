"""Where a Hencky solid loses ellipticity, in plane strain.

With principal logarithmic strains e_1, e_2 the Kirchhoff stresses are tau_a = 2 G e_a + lambda (e_1
+ e_2).  For a direction n in the principal axes the acoustic tensor times J is

    Q_11 = (lambda + 2 G - tau_1) n_1^2 + g b_2 n_2^2 ,   Q_12 = (lambda + g b_1 - tau_1) n_1 n_2 ,
    Q_22 = g b_1 n_1^2 + (lambda + 2 G - tau_2) n_2^2 ,   b_a = exp(2 e_a) ,

g = (tau_1 - tau_2) / (b_1 - b_2), and it has to be positive definite for every n: a band of the
solid across n could otherwise shear under a falling stress (Hill 1962).
"""

from __future__ import annotations

import numpy as np

REPEATED = 1e-7
"""Difference of principal strains below which the divided difference takes its limit."""


def is_elliptic(strain: np.ndarray, shear_modulus: float, first_lame: float) -> np.ndarray:
    """Tell where a Hencky solid with these logarithmic strains (n, 3, 3) is elliptic, (n,) bool.

    Moduli in Pa.  Plane strain: the third row and column of the strain are not looked at.
    """
    e1, e2 = np.linalg.eigvalsh(strain[:, :2, :2]).T
    tau1, tau2 = (2.0 * shear_modulus * e + first_lame * (e1 + e2) for e in (e1, e2))
    b1, b2 = np.exp(2.0 * e1), np.exp(2.0 * e2)
    is_repeated = np.abs(e1 - e2) < REPEATED
    difference = np.where(is_repeated, 1.0, b1 - b2)
    g = np.where(is_repeated, shear_modulus / b1, (tau1 - tau2) / difference)
    first, second = first_lame + 2.0 * shear_modulus - np.array([tau1, tau2])
    mixed = first_lame + g * b1 - tau1
    # det Q = ends_1 n_1^4 + middle n_1^2 n_2^2 + ends_2 n_2^4
    middle = first * second + g**2 * b1 * b2 - mixed**2
    product = np.maximum(first * second * g**2 * b1 * b2, 0.0)
    return (first > 0.0) & (second > 0.0) & (middle > -2.0 * np.sqrt(product))
