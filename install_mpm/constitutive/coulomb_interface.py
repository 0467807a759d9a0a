"""Elasto-plastic Mohr-Coulomb law of the pile-soil interface (paper, eqs 10-14), backward Euler.

    t = t_n + D (dw - dw_p) ,  D = diag(k_s, ..., k_n)
    f = |t_s| + t_n tan(phi) - c <= 0 ,   dw_p = lambda dg/dt ,  g = |t_s| + t_n tan(psi)

Local vectors hold the tangential components first and the normal last, (s, n) in two and (s1, s2,
n) in three dimensions.  The slip direction in the surface follows from |t_s| as a vector norm, so
one slip direction is shared by all tangential components.

The normal traction has a limit T: the cone's apex c / tan(phi), or the tensile strength if that is
less.  What is left up to the limit is the contact pressure N = T - t_n >= 0, and the strength is

    F(N) = N tan(phi) + (c - T tan(phi)) m(N) ,

m falling to zero with N: an open interface carries no shear.  N follows from the pressure x of the
normal spring.  Exactly, N = max(x, 0); with a smoothing stress d it is

    N = 0 for x <= -d ,  (x + d)^2 / (4 d) between ,  x for x >= d ,
    m = 1 - (1 - N / d)^2 for N < d ,  1 for N >= d ,

so that the law is the exact one wherever N >= d.  The smoothing acts on the spring and not on a
step: from the stored N the spring starts at x = 2 sqrt(d N) - d, and a step without motion changes
no traction.  The gap is remembered as far as d / k_n; one that is wider counts as this wide.
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit, parallel_jit, prange
from install_mpm.constitutive.parameters import CoulombInterface

(
    NORMAL_STIFFNESS, SHEAR_STIFFNESS, COHESION, TAN_FRICTION, TAN_DILATION, TENSILE_LIMIT,
    SMOOTHING,
) = range(7)  # fmt: skip
N_PARAMETERS = 7
STICK, SLIP, OPEN = 0, 1, 2

BONDED = 1e300
"""Limit T in Pa of an interface that never opens: a number, because state files hold numbers."""

ITERATIONS = 60
"""Of the return with dilation at the apex: bisection alone reaches round-off with so many."""


def pack(parameters: CoulombInterface, undrained_shear_strength: np.ndarray) -> np.ndarray:
    """Return packed parameters (n, 7) of points beside soil of this strength (n,) in Pa."""
    strength = np.asarray(undrained_shear_strength)
    cohesion = parameters.cohesion + parameters.adhesion_factor * strength
    tan_friction = np.tan(parameters.friction_angle)
    limit = np.full(len(cohesion), BONDED)
    if tan_friction > 0.0:
        limit = cohesion / tan_friction
    if parameters.tensile_strength is not None:
        limit = np.minimum(limit, parameters.tensile_strength)
    packed = np.empty((len(cohesion), N_PARAMETERS))
    packed[:, NORMAL_STIFFNESS] = parameters.normal_stiffness
    packed[:, SHEAR_STIFFNESS] = parameters.shear_stiffness
    packed[:, COHESION] = cohesion
    packed[:, TAN_FRICTION] = tan_friction
    packed[:, TAN_DILATION] = np.tan(parameters.dilation_angle)
    packed[:, TENSILE_LIMIT] = limit
    packed[:, SMOOTHING] = parameters.smoothing_stress
    return packed


@jit
def update_traction(slip_increment, parameters, traction_old, traction, tangent):
    """Evaluate the interface law at one point.

    Parameters
    ----------
    slip_increment : (dim,)
        Relative displacement of the step in m, pile minus soil, local axes.
    parameters : (7,)
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
    normal = slip_increment.shape[0] - 1
    stiffness_n, stiffness_s = parameters[NORMAL_STIFFNESS], parameters[SHEAR_STIFFNESS]
    limit = parameters[TENSILE_LIMIT] if parameters[TENSILE_LIMIT] < BONDED else 0.0
    tangent[:, :] = 0.0
    shear_squared = 0.0
    for i in range(normal):
        traction[i] = traction_old[i] + stiffness_s * slip_increment[i]
        tangent[i, i] = stiffness_s
        shear_squared += traction[i] * traction[i]
    shear_trial = np.sqrt(shear_squared)
    spring = _spring_pressure(limit - traction_old[normal], parameters)
    spring -= stiffness_n * slip_increment[normal]

    pressure, rate = _contact_pressure(spring, parameters)
    shear, _ = _strength(pressure, parameters)
    is_in_contact = pressure > 0.0 or parameters[TENSILE_LIMIT] == BONDED
    if shear_trial <= shear and is_in_contact:
        traction[normal] = limit - pressure
        tangent[normal, normal] = stiffness_n * rate
        return STICK

    if parameters[TAN_DILATION] > 0.0:
        plastic_slip = _plastic_slip(shear_trial, spring, parameters)
        spring += stiffness_n * parameters[TAN_DILATION] * plastic_slip
        pressure, rate = _contact_pressure(spring, parameters)
    traction[normal] = limit - pressure
    if pressure <= 0.0 and parameters[TENSILE_LIMIT] < BONDED:
        traction[:normal] = 0.0
        tangent[:, :] = 0.0
        return OPEN
    # from the yield condition: the difference of trial and plastic part leaves the round-off of
    # the trial, which in a large step is far beyond the strength
    shear, friction = _strength(pressure, parameters)
    _slip(shear_trial, shear, friction * rate, rate, parameters, traction, tangent)
    return SLIP


@jit
def _spring_pressure(pressure, parameters):
    """Return the pressure x in Pa of the normal spring that gives the contact ``pressure`` N."""
    smoothing = parameters[SMOOTHING]
    if parameters[TENSILE_LIMIT] == BONDED or pressure >= smoothing:
        return pressure
    return 2.0 * np.sqrt(smoothing * max(pressure, 0.0)) - smoothing


@jit
def _contact_pressure(spring, parameters):
    """Return the contact pressure N in Pa at the spring pressure x, and dN/dx."""
    smoothing = parameters[SMOOTHING]
    if parameters[TENSILE_LIMIT] == BONDED or spring >= smoothing:
        return spring, 1.0
    if spring <= -smoothing:
        return 0.0, 0.0
    return (spring + smoothing) ** 2 / (4.0 * smoothing), (spring + smoothing) / (2.0 * smoothing)


@jit
def _strength(pressure, parameters):
    """Return the shear strength F in Pa at the contact ``pressure`` N, and dF/dN."""
    tan_friction, smoothing = parameters[TAN_FRICTION], parameters[SMOOTHING]
    if parameters[TENSILE_LIMIT] == BONDED:
        return parameters[COHESION], 0.0
    left = max(parameters[COHESION] - parameters[TENSILE_LIMIT] * tan_friction, 0.0)
    if pressure <= 0.0:
        return 0.0, tan_friction
    if pressure >= smoothing:
        return left + pressure * tan_friction, tan_friction
    share = pressure / smoothing
    return (
        left * share * (2.0 - share) + pressure * tan_friction,
        left * 2.0 * (1.0 - share) / smoothing + tan_friction,
    )


@jit
def _plastic_slip(shear_trial, spring, parameters):
    """Return lambda in m, the root of |t_s| - k_s lambda = F(N(x + k_n tan(psi) lambda)).

    The left side falls and the right side rises with lambda; beyond the smoothing both are
    straight, otherwise the root is found by Newton's method between bounds.
    """
    stiffness = parameters[SHEAR_STIFFNESS]
    rise = parameters[NORMAL_STIFFNESS] * parameters[TAN_DILATION]
    low, high = 0.0, shear_trial / stiffness
    if parameters[TENSILE_LIMIT] < BONDED and spring + rise * high <= -parameters[SMOOTHING]:
        return high
    # as if the whole strength were there: exact unless the pressure ends within the smoothing
    end = max(spring + rise * high, parameters[SMOOTHING])
    strength, friction = _strength(end, parameters)
    strength += friction * (spring - end)
    slip = min(max((shear_trial - strength) / (stiffness + rise * friction), low), high)
    for _ in range(ITERATIONS):
        pressure, rate = _contact_pressure(spring + rise * slip, parameters)
        strength, friction = _strength(pressure, parameters)
        excess = shear_trial - stiffness * slip - strength
        if abs(excess) <= 1e-15 * shear_trial:
            break
        if excess > 0.0:
            low = slip
        else:
            high = slip
        slip += excess / (stiffness + rise * rate * friction)
        if not low < slip < high:
            slip = 0.5 * (low + high)
    return slip


@jit
def _slip(shear_trial, shear, hardening, rate, parameters, traction, tangent):
    """Scale the trial shear in ``traction`` to ``shear`` and fill the ``tangent``.

    ``hardening`` is dF/dx and ``rate`` dN/dx, both at the end of the step.
    """
    normal = traction.shape[0] - 1
    stiffness_n, stiffness_s = parameters[NORMAL_STIFFNESS], parameters[SHEAR_STIFFNESS]
    rise = stiffness_n * parameters[TAN_DILATION]
    softening = stiffness_s / (stiffness_s + hardening * rise)
    for i in range(normal):
        first = traction[i] / shear_trial
        for j in range(normal):
            product = first * traction[j] / shear_trial
            same = 1.0 if i == j else 0.0
            tangent[i, j] = stiffness_s * (
                shear / shear_trial * (same - product) + (1.0 - softening) * product
            )
        tangent[i, normal] = -softening * stiffness_n * hardening * first
        tangent[normal, i] = -softening * rate * rise * first
    tangent[normal, normal] = stiffness_n * softening * rate
    for i in range(normal):
        traction[i] *= shear / shear_trial


@parallel_jit
def update_all(slip_increment, parameters, traction_old, traction, tangent, status):
    """Evaluate the law at all points, point axis first; the last three arrays are filled."""
    for p in prange(slip_increment.shape[0]):
        status[p] = update_traction(
            slip_increment[p], parameters[p], traction_old[p], traction[p], tangent[p]
        )
