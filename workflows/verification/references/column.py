"""PA1: elastic column that shortens under its own weight between smooth walls (AMPLE's column).

The cross-section cannot change, so the vertical Cauchy stress is the weight above, whatever the
material.  The Hencky material turns it into the stretch M ln(lambda) / lambda = -rho g (L0 - Y),
whose solution is Lambert's function.

Source: Coombs & Augarde (2020), Advances in Engineering Software 139, 102748 (problem); closed
form integrated here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import lambertw


@dataclass(frozen=True)
class Column:
    """State of the points of the column, each of the shape of ``original_height``."""

    stretch: np.ndarray
    """Current over original length, vertical."""
    height: np.ndarray
    """Current height above the base in m."""
    displacement: np.ndarray
    """Vertical, upward positive, in m."""
    vertical_stress: np.ndarray
    """Cauchy stress in Pa, tension positive."""
    horizontal_stress: np.ndarray
    """Cauchy stress in both horizontal directions in Pa, tension positive."""


def constrained_modulus(*, youngs_modulus: float, poissons_ratio: float) -> float:
    """Return M = E (1 - nu) / ((1 + nu) (1 - 2 nu)) in Pa."""
    nu = poissons_ratio
    return youngs_modulus * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))


def column(
    original_height: ArrayLike,
    *,
    length: float,
    youngs_modulus: float,
    poissons_ratio: float,
    density: float,
    gravity: float,
) -> Column:
    """Return the state at points that were at ``original_height`` Y above the base.

    With s(Y) = rho g (L0 - Y) / M the stretch is W(s) / s = exp(-W(s)).  Because the derivative of
    W + W^2 / 2 is W / s, the height is y(Y) = M / (rho g) [W + W^2 / 2] between s(Y) and s(0).

    Parameters
    ----------
    original_height
        Any shape, in m.
    length
        Original length L0 in m.
    youngs_modulus
        In Pa.
    density, gravity
        Of the undeformed column in kg/m^3, and in m/s^2; both above zero.
    """
    original_height = np.asarray(original_height, dtype=float)
    modulus = constrained_modulus(youngs_modulus=youngs_modulus, poissons_ratio=poissons_ratio)
    weight = density * gravity / modulus
    weight_above = weight * (length - original_height)
    height = (_primitive(weight * length) - _primitive(weight_above)) / weight
    stress = -modulus * weight_above
    return Column(
        np.exp(-_lambert(weight_above)),
        height,
        height - original_height,
        stress,
        stress * poissons_ratio / (1.0 - poissons_ratio),
    )


def _lambert(s: ArrayLike) -> np.ndarray:
    return lambertw(s).real


def _primitive(s: ArrayLike) -> np.ndarray:
    """Return W + W^2 / 2, the integral of the stretch W(s) / s."""
    return _lambert(s) * (1.0 + 0.5 * _lambert(s))
