"""PD10: thick-walled Tresca cylinder under internal pressure, small strain."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def internal_pressure(
    plastic_radius: ArrayLike,
    *,
    inner_radius: float,
    outer_radius: float,
    undrained_shear_strength: float,
) -> np.ndarray:
    """Return the pressure in Pa at which the cylinder is plastic up to ``plastic_radius`` c.

    p = 2 s_u ln(c / a) + s_u (1 - c^2 / b^2); first yield at c = a, collapse at c = b.  Elastic
    Lame solution outside c, sigma_r - sigma_theta = -2 s_u inside, no load at the outer radius;
    the axial stress is between the two others.

    Source: Hill (1950), The mathematical theory of plasticity, chapter V.

    Parameters
    ----------
    plastic_radius
        From a to b, any shape, in m.
    inner_radius, outer_radius
        a and b in m.
    undrained_shear_strength
        In Pa.
    """
    c = np.asarray(plastic_radius, dtype=float)
    plastic = 2.0 * np.log(c / inner_radius)
    return undrained_shear_strength * (plastic + 1.0 - (c / outer_radius) ** 2)


def collapse_pressure(
    *, inner_radius: float, outer_radius: float, undrained_shear_strength: float
) -> float:
    """Return 2 s_u ln(b / a) in Pa."""
    return 2.0 * undrained_shear_strength * np.log(outer_radius / inner_radius)
