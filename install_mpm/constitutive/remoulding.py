"""Loss of undrained strength as clay is sheared: remoulding.

    s_u(xi) = s_u0 [d + (1 - d) exp(-3 xi / xi_95)] ,   d = 1 / sensitivity

xi is the accumulated plastic shear strain and xi_95 that at which 95 % of the loss has taken place
(Einav and Randolph 2005, eq. 8).  The undisturbed strength s_u0 and xi are state variables.
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit

REMOULDED, RATE = 2, 3
"""Columns of the packed parameters: d, and 3 / xi_95."""
TOLERANCE = 1e-14
MAX_ITERATIONS = 50


def pack_remoulding(sensitivity: float, remoulding_strain: float) -> list[float]:
    """Return the packed parameters d and 3 / xi_95."""
    return [1.0 / sensitivity, 3.0 / remoulding_strain]


@jit
def remoulded_strength(undisturbed, shear_strain, parameters):
    """Return s_u in Pa and its derivative by ``shear_strain`` in Pa."""
    remoulded = parameters[REMOULDED]
    if remoulded == 1.0:
        return undisturbed, 0.0
    lost = (1.0 - remoulded) * np.exp(-parameters[RATE] * shear_strain)
    return undisturbed * (remoulded + lost), -undisturbed * parameters[RATE] * lost
