"""Elasto-plastic Mohr-Coulomb law of the pile-soil interface (paper, eqs 10-14), backward Euler.

    t = t_n + D (dw - dw_p) ,  D = diag(k_s, ..., k_n)
    f = |t_s| + t_n tan(phi) - c <= 0 ,   dw_p = lambda dg/dt ,  g = |t_s| + t_n tan(psi)

Local vectors hold the tangential components first and the normal last, (s, n) in two and (s1, s2,
n) in three dimensions.  The slip direction in the surface follows from |t_s| as a vector norm, so
one slip direction is shared by all tangential components.  Stresses beyond the cone's apex t_n = c
/ tan(phi) are returned to it: the interface opens.
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit, parallel_jit, prange
from install_mpm.constitutive.parameters import CoulombInterface

NORMAL_STIFFNESS, SHEAR_STIFFNESS, COHESION, TAN_FRICTION, TAN_DILATION = range(5)
STICK, SLIP, OPEN = 0, 1, 2


def pack(parameters: CoulombInterface, undrained_shear_strength: np.ndarray) -> np.ndarray:
    """Return packed parameters (n, 5) of points beside soil of this strength (n,) in Pa."""
    cohesion = parameters.cohesion + parameters.adhesion_factor * np.asarray(
        undrained_shear_strength
    )
    packed = np.empty((len(cohesion), 5))
    packed[:, NORMAL_STIFFNESS] = parameters.normal_stiffness
    packed[:, SHEAR_STIFFNESS] = parameters.shear_stiffness
    packed[:, COHESION] = cohesion
    packed[:, TAN_FRICTION] = np.tan(parameters.friction_angle)
    packed[:, TAN_DILATION] = np.tan(parameters.dilation_angle)
    return packed


@jit
def update_traction(slip_increment, parameters, traction_old, traction, tangent):
    """Evaluate the interface law at one point.

    Parameters
    ----------
    slip_increment : (dim,)
        Relative displacement of the step in m, pile minus soil, local axes.
    parameters : (5,)
        Packed parameters.
    traction_old : (dim,)
        Traction at the start of the step in Pa, local axes.
    traction, tangent
        Filled: traction (dim,) in Pa and consistent tangent (dim, dim) in Pa/m.

    Returns
    -------
    int
        ``STICK``, ``SLIP`` or ``OPEN``.
    """
    dim = slip_increment.shape[0]
    normal = dim - 1
    stiffness_n, stiffness_s = parameters[NORMAL_STIFFNESS], parameters[SHEAR_STIFFNESS]
    tan_friction, tan_dilation = parameters[TAN_FRICTION], parameters[TAN_DILATION]
    cohesion = parameters[COHESION]

    tangent[:, :] = 0.0
    shear_squared = 0.0
    for i in range(normal):
        traction[i] = traction_old[i] + stiffness_s * slip_increment[i]
        tangent[i, i] = stiffness_s
        shear_squared += traction[i] * traction[i]
    traction[normal] = traction_old[normal] + stiffness_n * slip_increment[normal]
    tangent[normal, normal] = stiffness_n

    shear_trial = np.sqrt(shear_squared)
    overstress = shear_trial + traction[normal] * tan_friction - cohesion
    if overstress <= 0.0:
        return STICK

    plastic_slip = overstress / (stiffness_s + stiffness_n * tan_friction * tan_dilation)
    # from the yield condition: the difference of trial and plastic part leaves the round-off of
    # the trial, which in a large step is far beyond the strength
    normal_returned = traction[normal] - stiffness_n * tan_dilation * plastic_slip
    shear = cohesion - normal_returned * tan_friction
    if shear < 0.0 and tan_friction > 0.0:
        # shear strength cannot be negative: the point has left the cone through its apex
        traction[:] = 0.0
        traction[normal] = cohesion / tan_friction
        tangent[:, :] = 0.0
        return OPEN
    shear = max(shear, 0.0)  # a smooth interface has no apex: only round-off makes it negative

    softening = stiffness_s / (stiffness_s + stiffness_n * tan_friction * tan_dilation)
    direction = np.empty(normal)
    for i in range(normal):
        direction[i] = traction[i] / shear_trial
    for i in range(normal):
        for j in range(normal):
            same = 1.0 if i == j else 0.0
            tangent[i, j] = stiffness_s * (
                shear / shear_trial * (same - direction[i] * direction[j])
                + (1.0 - softening) * direction[i] * direction[j]
            )
        tangent[i, normal] = -softening * stiffness_n * tan_friction * direction[i]
        tangent[normal, i] = -softening * stiffness_n * tan_dilation * direction[i]
        traction[i] = shear * direction[i]
    tangent[normal, normal] = stiffness_n * softening
    traction[normal] = normal_returned
    return SLIP


@parallel_jit
def update_all(slip_increment, parameters, traction_old, traction, tangent, status):
    """Evaluate the law at all points, point axis first; the last three arrays are filled."""
    for p in prange(slip_increment.shape[0]):
        status[p] = update_traction(
            slip_increment[p], parameters[p], traction_old[p], traction[p], tangent[p]
        )
