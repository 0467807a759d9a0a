"""Isotropic laws written in two strain invariants, with a return along the trial deviator.

    e_v = tr(eps) ,   e_q = sqrt(2/3) |dev(eps)| ,   p = -tr(tau) / 3 ,   q = sqrt(3/2) |dev(tau)|

A law whose yield surface and plastic potential know p and q only keeps the direction of the trial
deviator, so that stress and consistent tangent follow from p, q and their derivatives with respect
to the two invariants of the trial strain (Borja and Tamagnini 1998, section 4).
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit
from install_mpm.constitutive.mandel import trace

ROOT_TWO_THIRDS = np.sqrt(2.0 / 3.0)


@jit
def shear_invariant(strain):
    """Return e_q of ``strain`` (6,)."""
    mean = trace(strain) / 3.0
    total = 0.0
    for i in range(6):
        deviator = strain[i] - mean if i < 3 else strain[i]
        total += deviator * deviator
    return ROOT_TWO_THIRDS * np.sqrt(total)


@jit
def stress_invariants(stress):
    """Return p and q in Pa of ``stress`` (6,)."""
    return -trace(stress) / 3.0, 1.5 * shear_invariant(stress)


@jit
def assemble(trial, pressure, secant, slopes, stress, tangent):
    """Fill stress (6,) and consistent tangent (6, 6) in Pa from the response in the invariants.

    Parameters
    ----------
    trial : (6,)
        Trial strain.
    pressure, secant : float
        p, and q over e_q of the trial strain (its limit where e_q = 0), in Pa.
    slopes : (4,)
        Derivatives in Pa, by e_v and e_q of the trial strain: -dp/de_v, -dp/de_q, dq/de_v, dq/de_q.
    """
    mean = trace(trial) / 3.0
    invariant = shear_invariant(trial)
    direction = np.empty(6)
    for i in range(6):
        deviator = trial[i] - mean if i < 3 else trial[i]
        stress[i] = 2.0 / 3.0 * secant * deviator - (pressure if i < 3 else 0.0)
        direction[i] = ROOT_TWO_THIRDS * deviator / invariant if invariant > 0.0 else 0.0
    for i in range(6):
        for j in range(6):
            value = 2.0 / 3.0 * (slopes[3] - secant) * direction[i] * direction[j]
            if i < 3:
                value += ROOT_TWO_THIRDS * slopes[1] * direction[j]
            if j < 3:
                value += ROOT_TWO_THIRDS * slopes[2] * direction[i]
            if i < 3 and j < 3:
                value += slopes[0] - 2.0 / 9.0 * secant
            if i == j:
                value += 2.0 / 3.0 * secant
            tangent[i, j] = value
