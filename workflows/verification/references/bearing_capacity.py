"""PB1, PB3 and PB6: bearing capacity of strips and of a deep cylinder, exact or plasticity bounds.

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
