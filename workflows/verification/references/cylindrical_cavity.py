"""PA16: expansion of a cylindrical or spherical cavity in Tresca soil, at any size.

The soil is incompressible, the elastic strain is logarithmic (Hencky), and the soil yields at
|sigma_r - sigma_theta| = 2 s_u.  With n = 2 for the cylinder and 3 for the sphere, r^n - r_0^n is
the same for all radii; t = n ln(r / r_0) falls with r, (n / r) dr = -dt / (exp(t) - 1), and
equilibrium gives the pressure difference between two radii as

    m [I(t_inner) - I(t_outer)],  I(t) = integral of min(G t, s_u) / (exp(t) - 1) from 0 to t,

m = 1 for the cylinder and 4/3 for the sphere.  The elastic part of I is the dilogarithm
G Li_2(1 - exp(-t)), the plastic part s_u ln(1 - exp(-t)).  For small s_u / G and infinite
expansion this is the classical m s_u [1 + ln(G / s_u)] (Gibson & Anderson 1961, Hill 1950).
In plane strain a von Mises soil of equal strength in pure shear behaves alike.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import spence


def cylinder_pressure(
    expansion: ArrayLike,
    *,
    shear_modulus: float,
    undrained_shear_strength: float,
    outer_ratio: float = np.inf,
) -> np.ndarray:
    """Return the pressure in a cylindrical cavity above that at the outer boundary, in Pa.

    Parameters
    ----------
    expansion
        Current over original radius a / a_0 >= 1, any shape, may be infinite in infinite soil.
    shear_modulus, undrained_shear_strength
        In Pa.
    outer_ratio
        Original radius of the outer boundary over a_0; the pressure there is constant.

    Raises
    ------
    ValueError
        If the cavity has become smaller.
    """
    return _pressure(expansion, 2, shear_modulus, undrained_shear_strength, outer_ratio)


def sphere_pressure(
    expansion: ArrayLike,
    *,
    shear_modulus: float,
    undrained_shear_strength: float,
    outer_ratio: float = np.inf,
) -> np.ndarray:
    """Return the pressure in a spherical cavity above that at the outer boundary, in Pa.

    Parameters as in ``cylinder_pressure``.
    """
    pressure = _pressure(expansion, 3, shear_modulus, undrained_shear_strength, outer_ratio)
    return 4.0 / 3.0 * pressure


def _pressure(
    expansion: ArrayLike, n: int, shear_modulus: float, strength: float, outer_ratio: float
) -> np.ndarray:
    """Return I(t_inner) - I(t_outer)."""
    if np.any(np.asarray(expansion) < 1.0):
        raise ValueError(f"cavity expansion {expansion} must be at least 1")
    growth = np.asarray(expansion, dtype=float) ** n - 1.0
    inner = _integral(np.log1p(growth), shear_modulus, strength)
    if np.isinf(outer_ratio):
        return inner
    return inner - _integral(np.log1p(growth / outer_ratio**n), shear_modulus, strength)


def _integral(t: np.ndarray, shear_modulus: float, strength: float) -> np.ndarray:
    """Return I(t)."""
    at_yield = strength / shear_modulus
    elastic = shear_modulus * spence(np.exp(-np.minimum(t, at_yield)))
    return elastic + strength * np.log(np.expm1(-np.maximum(t, at_yield)) / np.expm1(-at_yield))
