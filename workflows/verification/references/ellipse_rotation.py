"""PA10: rigid ellipse turned by a small angle in an elastic disc with a fixed rim (paper, Fig. 7).

Plane strain, Kolosov and Muskhelishvili: 2 G (u + i v) = kappa phi(z) - z conj(phi'(z)) -
conj(psi(z)), kappa = 3 - 4 nu.  By symmetry phi and psi are i times real series of odd powers:
powers of z / R for the rim, and negative powers of zeta for the ellipse, where z = c (zeta + m /
zeta) maps |zeta| > 1 to the outside of the ellipse, c = (p + q) / 2, m = (p - q) / (p + q).  The
displacement is collocated on both curves in the least-squares sense.  The moment on the ellipse is
the residue of psi: with i A / zeta the leading negative power, |T| = 2 pi c |A|.

Source: Muskhelishvili (1953), Some basic problems of the mathematical theory of elasticity.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class EllipseRotation:
    """Torque of the ellipse, and how well the boundary conditions are met."""

    stiffness: float
    """Torque over rotation in N m per rad and metre."""
    residual: float
    """Largest error of the displacement on both curves over that of the major vertex."""


def infinite_medium_stiffness(
    *, semi_major: float, semi_minor: float, youngs_modulus: float, poissons_ratio: float
) -> float:
    """Return T / theta = pi G [(p + q)^2 + (p - q)^2 / (3 - 4 nu)] without an outer rim.

    Semi-axes p, q in m, E in Pa; result in N m per rad and metre.
    """
    p, q = semi_major, semi_minor
    shear_modulus = youngs_modulus / (2.0 * (1.0 + poissons_ratio))
    kappa = 3.0 - 4.0 * poissons_ratio
    return np.pi * shear_modulus * ((p + q) ** 2 + (p - q) ** 2 / kappa)


def ellipse_rotation(
    *,
    semi_major: float,
    semi_minor: float,
    outer_radius: float,
    youngs_modulus: float,
    poissons_ratio: float,
    n_terms: int = 40,
) -> EllipseRotation:
    """Return the rotational stiffness of the ellipse.

    Parameters
    ----------
    semi_major, semi_minor
        Semi-axes p >= q > 0 in m.
    outer_radius
        Of the fixed rim in m, above p.
    youngs_modulus
        In Pa.
    n_terms
        Number of powers in each of the four series.

    Raises
    ------
    ValueError
        If the lengths are not in the order semi_minor <= semi_major < outer_radius.
    """
    p, q = semi_major, semi_minor
    if not 0.0 < q <= p < outer_radius:
        raise ValueError(f"ellipse {p} x {q} does not lie in the circle of radius {outer_radius}")
    geometry = 0.5 * (p + q), (p - q) / (p + q), outer_radius
    leading, error = _collocate(geometry, 3.0 - 4.0 * poissons_ratio, n_terms)
    shear_modulus = youngs_modulus / (2.0 * (1.0 + poissons_ratio))
    return EllipseRotation(4.0 * np.pi * shear_modulus * geometry[0] * leading, error / p)


def _collocate(
    geometry: tuple[float, float, float], kappa: float, n_terms: int
) -> tuple[float, float]:
    """Return |A| and the largest error for the displacement i z of the ellipse, 2 G = 1."""
    focus_scale, ratio, outer_radius = geometry
    circle = np.exp(0.5j * np.pi * (np.arange(4 * n_terms) + 0.5) / (4 * n_terms))
    zeta = np.hstack([circle, _outside(outer_radius * circle, focus_scale, ratio)])
    z = focus_scale * (zeta + ratio / zeta)
    columns = _displacements(z, zeta, geometry, kappa, n_terms)
    wanted = np.hstack([1j * z[: circle.size], np.zeros(circle.size)])
    matrix = np.vstack([columns.real, columns.imag])
    right_side = np.hstack([wanted.real, wanted.imag])
    scale = np.linalg.norm(matrix, axis=0)
    solution = np.linalg.lstsq(matrix / scale, right_side, rcond=1e-14)[0] / scale
    return abs(solution[2 * n_terms]), np.abs(matrix @ solution - right_side).max()


def _outside(z: np.ndarray, focus_scale: float, ratio: float) -> np.ndarray:
    """Return zeta, |zeta| > 1, of points outside the ellipse in the first quadrant."""
    half = 0.5 * z / focus_scale
    return half + np.sqrt(half - np.sqrt(ratio)) * np.sqrt(half + np.sqrt(ratio))


def _displacements(
    z: np.ndarray,
    zeta: np.ndarray,
    geometry: tuple[float, float, float],
    kappa: float,
    n_terms: int,
) -> np.ndarray:
    """Return 2 G (u + i v) of every term, (n_points, 4 n_terms).

    First phi, then psi; of each first the negative powers of zeta, then the powers of z / R.
    """
    focus_scale, ratio, outer_radius = geometry
    power = 2 * np.arange(n_terms) + 1
    z, zeta = z[:, None], zeta[:, None]
    inner, outer = zeta ** (-power), (z / outer_radius) ** power
    mapping_slope = focus_scale * (1.0 - ratio / zeta**2)
    inner_slope = -power * zeta ** (-power - 1) / mapping_slope
    outer_slope = power * (z / outer_radius) ** (power - 1) / outer_radius
    value, slope = 1j * np.hstack([inner, outer]), 1j * np.hstack([inner_slope, outer_slope])
    return np.hstack([kappa * value - z * slope.conj(), -value.conj()])
