"""PD8: vertical point force inside an elastic half-space.

R_1 and R_2 are the distances from the force, at depth c, and from its image, at -c.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def mindlin_displacement(
    radius: ArrayLike,
    depth: ArrayLike,
    *,
    force: float,
    force_depth: float,
    shear_modulus: float,
    poissons_ratio: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Return radial and vertical displacement in m, outward and downward positive.

    Source: Mindlin (1936), Physics 7, 195-202.

    Parameters
    ----------
    radius, depth
        From the axis of the force and below the surface, z >= 0, in m; arrays that broadcast.
    force, force_depth, shear_modulus
        P downward positive in N, c >= 0 in m, G in Pa.
    """
    r, z = np.asarray(radius, dtype=float), np.asarray(depth, dtype=float)
    c, nu = force_depth, poissons_ratio
    below, sum_, r1, r2 = z - c, z + c, np.hypot(r, z - c), np.hypot(r, z + c)
    k = 3.0 - 4.0 * nu
    vertical = (
        (k + (below / r1) ** 2) / r1
        + (8.0 * (1.0 - nu) ** 2 - k) / r2
        + (k * sum_**2 - 2.0 * c * z) / r2**3
        + 6.0 * c * z * sum_**2 / r2**5
    )
    radial = r * (
        below / r1**3
        + k * below / r2**3
        - 4.0 * (1.0 - nu) * (1.0 - 2.0 * nu) / (r2 * (r2 + sum_))
        + 6.0 * c * z * sum_ / r2**5
    )
    scale = force / (16.0 * np.pi * shear_modulus * (1.0 - nu))
    return scale * radial, scale * vertical
