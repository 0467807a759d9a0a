"""PA4 and PA5: stress that is carried along by a rigid rotation, sigma' = R sigma R^T.

PA4 is its special case of a stress-free body.
"""

from __future__ import annotations

import numpy as np


def rotated_stress(
    stress_xx: float, stress_yy: float, stress_xy: float, *, angle: float
) -> np.ndarray:
    """Return (xx, yy, xy) of the stress after its body has turned, (3,) in the unit given.

    Parameters
    ----------
    stress_xx, stress_yy, stress_xy
        Cauchy stress before the rotation, tension positive.
    angle
        Of the rotation, counter-clockwise positive (from x towards y), in rad.
    """
    mean, half_difference = 0.5 * (stress_xx + stress_yy), 0.5 * (stress_xx - stress_yy)
    cosine, sine = np.cos(2.0 * angle), np.sin(2.0 * angle)
    radial = half_difference * cosine - stress_xy * sine
    return np.array([mean + radial, mean - radial, half_difference * sine + stress_xy * cosine])
