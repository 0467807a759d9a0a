"""PD1 and PD7: rigid disc and flexible circular load on an elastic half-space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ellipe, ellipk


@dataclass(frozen=True)
class DiscStiffness:
    """Static stiffness of a rigid disc on the surface."""

    vertical: float
    """Smooth disc, 4 G R / (1 - nu), in N/m."""
    vertical_bonded: float
    """Disc that sticks to the surface, 4 G R ln(3 - 4 nu) / (1 - 2 nu), in N/m."""
    horizontal: float
    """8 G R / (2 - nu) in N/m, normal stress from rocking neglected."""
    rocking: float
    """8 G R^3 / (3 (1 - nu)) in N m/rad, smooth."""
    torsional: float
    """16 G R^3 / 3 in N m/rad."""


def disc_stiffness(*, radius: float, shear_modulus: float, poissons_ratio: float) -> DiscStiffness:
    """Return the stiffness of a rigid disc of ``radius`` in m, ``shear_modulus`` in Pa (PD1).

    Sources: Boussinesq (vertical), Mossakovskii (1954, bonded), Bycroft (1956, horizontal),
    Borowicka (1943, rocking), Reissner & Sagoci (1944, torsion).
    """
    g, r, nu = shear_modulus, radius, poissons_ratio
    twice = 2.0 * (1.0 - 2.0 * nu)  # ln(3 - 4 nu) / (1 - 2 nu) tends to 2
    bonded = 2.0 * np.log1p(twice) / twice if twice > 0.0 else 2.0
    return DiscStiffness(
        4.0 * g * r / (1.0 - nu),
        4.0 * g * r * bonded,
        8.0 * g * r / (2.0 - nu),
        8.0 * g * r**3 / (3.0 * (1.0 - nu)),
        16.0 * g * r**3 / 3.0,
    )


def circular_load_settlement(
    radius: ArrayLike,
    *,
    pressure: float,
    load_radius: float,
    youngs_modulus: float,
    poissons_ratio: float,
) -> np.ndarray:
    """Return the settlement of the surface in m, downward positive, under a uniform load (PD7).

    Inside, w = 4 (1 - nu^2) q R / (pi E) E(r/R); outside,
    w = 4 (1 - nu^2) q r / (pi E) [E(R/r) - (1 - (R/r)^2) K(R/r)], with complete elliptic integrals
    of the modulus given.

    Source: Timoshenko & Goodier (1970), Theory of elasticity, art. 139.

    Parameters
    ----------
    radius
        Distance r from the axis, any shape, in m.
    pressure, youngs_modulus
        q and E in Pa.
    load_radius
        R in m.
    """
    radius = np.asarray(radius, dtype=float)
    scale = 4.0 * (1.0 - poissons_ratio**2) * pressure / (np.pi * youngs_modulus)
    inside = load_radius * ellipe(np.minimum(radius / load_radius, 1.0) ** 2)
    outer = np.maximum(radius, load_radius)
    m = (load_radius / outer) ** 2
    complement = np.where(m < 1.0, (1.0 - m) * ellipk(np.where(m < 1.0, m, 0.0)), 0.0)
    outside = outer * (ellipe(m) - complement)
    return scale * np.where(radius <= load_radius, inside, outside)


def circular_load_stress(depth: ArrayLike, *, pressure: float, load_radius: float) -> np.ndarray:
    """Return the vertical stress on the axis in Pa, tension positive (PD7).

    -q [1 - (1 + (R / z)^2)^(-3/2)] at ``depth`` z > 0, any shape, in m.

    Source: Timoshenko & Goodier (1970), art. 139.
    """
    ratio = load_radius / np.asarray(depth, dtype=float)
    return -pressure * (1.0 - (1.0 + ratio**2) ** -1.5)
