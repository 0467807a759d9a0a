"""PB1, PB3 to PB6 and PC7: bearing capacity of footings, a deep cylinder and a buried plate.

The circle (PB2) is in ``circular_footing``.
"""

from __future__ import annotations

import numpy as np


def strip_pressure(*, undrained_shear_strength: float) -> float:
    """Return (2 + pi) s_u in Pa for a strip on weightless Tresca soil, smooth or rough (PB1).

    Source: Prandtl (1920); exact.
    """
    return (2.0 + np.pi) * undrained_shear_strength


def strip_factors(*, friction_angle: float) -> tuple[float, float]:
    """Return N_q and N_c of a strip on weightless soil, associated flow (PB3); angle in rad, > 0.

    N_q = exp(pi tan(phi)) tan^2(pi/4 + phi/2) (Reissner 1924), N_c = (N_q - 1) cot(phi)
    (Prandtl 1920); exact.
    """
    tangent = np.tan(friction_angle)
    n_q = np.exp(np.pi * tangent) * np.tan(0.25 * np.pi + 0.5 * friction_angle) ** 2
    return n_q, (n_q - 1.0) / tangent


STRIP_WEIGHT = {
    "smooth": {20: 1.579, 25: 3.461, 30: 7.653, 35: 17.58, 40: 43.2},
    "rough": {20: 2.839, 25: 6.491, 30: 14.75, 35: 34.48, 40: 85.57},
}
"""N_gamma of a strip (PB4) by the angle of friction in degrees: method of characteristics, as
published for the rough one by Martin (2005)."""

CIRCLE_WEIGHT = {"smooth": {20: 1.271, 25: 2.971, 30: 7.11, 35: 18.03}}
"""N_gamma of a circle, p = gamma D N_gamma / 2 (PB5): method of characteristics, extrapolated."""

CIRCLE_SURCHARGE = {
    "smooth": {20: 8.307, 25: 15.230, 30: 29.454, 35: 61.11},
    "rough": {20: 9.617, 25: 18.402, 30: 37.21, 35: 80.8},
}
"""N_q of a circle (PB5): method of characteristics, extrapolated; 80.8 is known to 0.4."""


def tabulated(table: dict[int, float], friction_angle: float) -> float:
    """Return the factor of a table for a friction angle in rad, associated flow.

    Raises
    ------
    ValueError
        If the table does not have the angle, to a hundredth of a degree.
    """
    degrees = np.rad2deg(friction_angle)
    nearest = min(table, key=lambda angle: abs(angle - degrees))
    if abs(nearest - degrees) > 0.01:
        known = ", ".join(f"{angle} deg" for angle in table)
        raise ValueError(f"the factor is known for phi = {known}, not for {degrees:.6g} deg")
    return table[nearest]


def deep_cylinder_factor(*, adhesion: float) -> float:
    """Return the lateral resistance of a deep cylinder over s_u and diameter (PB6).

    pi + 2 D + 4 cos(pi/4 - D/2) [sqrt(2) + sin(pi/4 - D/2)], sin(D) = adhesion over s_u, in
    0 ... 1.  Exact at 1; below, a lower bound that differs little from the upper bounds (9.14 and
    9.20 at 0, Martin & Randolph 2006).

    Source: Randolph & Houlsby (1984), Geotechnique 34, 613-623.

    Raises
    ------
    ValueError
        If the adhesion is outside 0 ... 1.
    """
    if not 0.0 <= adhesion <= 1.0:
        raise ValueError(f"adhesion over s_u = {adhesion} must lie between 0 and 1")
    delta = np.arcsin(adhesion)
    half = 0.25 * np.pi - 0.5 * delta
    return np.pi + 2.0 * delta + 4.0 * np.cos(half) * (np.sqrt(2.0) + np.sin(half))


def plate_uplift_bound(*, depth_ratio: float, friction_angle: float) -> float:
    """Return an upper bound of Q / (gamma H A) of a circular plate that is pulled up in sand (PC7).

    N = 1 + 2 (H/D) tan(phi) + 4/3 (H/D)^2 tan^2(phi): the weight of the cone that opens upward by
    phi from the edge of the plate.  With associated flow the cone rises without work of friction.
    """
    slope = depth_ratio * np.tan(friction_angle)
    return float(1.0 + 2.0 * slope + 4.0 / 3.0 * slope**2)
