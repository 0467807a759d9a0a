"""PD9: interface under cycles of relative displacement, elastic and perfectly plastic.

The loop is a parallelogram between the displacements -u_a and u_a and the shear stresses -tau_y
and tau_y, with the elastic slope k_s.
"""

from __future__ import annotations

import numpy as np


def dissipation_per_cycle(
    *, amplitude: float, shear_stiffness: float, shear_strength: float
) -> float:
    """Return 4 tau_y (u_a - tau_y / k_s) in J/m^2, zero if the interface never slips.

    Parameters
    ----------
    amplitude
        u_a in m.
    shear_stiffness, shear_strength
        k_s in Pa/m, tau_y in Pa.
    """
    return 4.0 * shear_strength * max(0.0, amplitude - shear_strength / shear_stiffness)


def loop_corners(
    *, amplitude: float, shear_stiffness: float, shear_strength: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return displacement in m and shear stress in Pa of the four corners of the loop, (4,) each.

    In the order of time from the largest displacement; the interface slips in every half cycle.
    """
    u, back = amplitude, 2.0 * shear_strength / shear_stiffness
    displacement = np.array([u, u - back, -u, -u + back])
    return displacement, shear_strength * np.array([1.0, -1.0, -1.0, 1.0])
