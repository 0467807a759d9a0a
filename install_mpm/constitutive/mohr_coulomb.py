"""Perfectly plastic Mohr-Coulomb solid, exact at edges and apex, in closed form.

    f = (tau_1 - tau_3) + (tau_1 + tau_3) sin(phi) - 2 c cos(phi) <= 0 ,   tau_1 >= tau_2 >= tau_3

Tension is positive.  The plastic flow follows the same function with the dilation angle psi in
place of phi.  In principal axes the yield surface is a pyramid of planes.  The trial stress returns
to the plane of tau_1 and tau_3; if it would leave the order of the principal stresses, to the edge
of two planes; if the two equal stresses of the edge would pass the third, to the apex c cot(phi)
(de Souza Neto, Peric and Owen 2008, section 8.2; Clausen, Damkilde and Andersen 2006).
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit
from install_mpm.constitutive import frictional
from install_mpm.constitutive.elastic import (
    BULK,
    SHEAR,
    elastic_strain_from_stress,
    elastic_stress,
    elastic_tangent,
)
from install_mpm.constitutive.frictional import STATE_VARIABLES, initial_state
from install_mpm.constitutive.mandel import trace
from install_mpm.constitutive.parameters import MohrCoulomb
from install_mpm.constitutive.principal import (
    from_principal,
    principal_axes,
    tangent_from_principal,
)
from install_mpm.constitutive.von_mises import deviator_norm

SINE, COHESIVE, DILATION = (frictional.N_PARAMETERS + column for column in range(3))
"""Columns of the packed parameters: sin(phi), 2 c cos(phi) in Pa, sin(psi) of dense soil."""

NOT_FINITE = 1
"""Status: the trial strain is not finite."""

__all__ = [
    "STATE_VARIABLES",
    "elastic_strain_from_stress",
    "initial_state",
    "pack",
    "update_stress",
    "yield_function",
]


def pack(soil: MohrCoulomb) -> np.ndarray:
    """Return the packed parameters, shape (7,)."""
    cohesive = 2.0 * soil.cohesion * np.cos(soil.friction_angle)
    own = [np.sin(soil.friction_angle), cohesive, np.sin(soil.dilation_angle)]
    return np.array([*frictional.pack_density(soil), *own])


@jit
def yield_function(stress, parameters, state):
    """Return f in Pa; zero or negative is admissible."""
    values, dyads = np.empty(3), np.empty((6, 6))
    principal_axes(stress, values, dyads)
    return _yield_value(values[0], values[2], parameters)


@jit
def _yield_value(major, minor, parameters):
    return major - minor + (major + minor) * parameters[SINE] - parameters[COHESIVE]


@jit
def update_stress(trial_strain, parameters, state_old, stress, elastic_strain, state, tangent):
    """Return to the pyramid; see ``dispatch.update_stress`` for arguments and status."""
    strain = np.empty(6)
    frictional.fill_opening(trial_strain, state_old, strain)
    elastic_stress(strain, parameters, stress)
    elastic_tangent(parameters, tangent)
    elastic_strain[:] = strain
    state[:] = state_old
    frictional.update_state(trial_strain, strain, strain, False, parameters, state_old, state)
    if _is_inside_cone(stress, parameters):
        return 0

    trial, dyads = np.empty(3), np.empty((6, 6))
    principal_axes(strain, trial, dyads)
    returned, principal_tangent = np.empty(3), np.empty((3, 3))
    left, slope = frictional.dilation_left(trial_strain, parameters, state_old)
    where = _return_principal(trial, left, slope, parameters, returned, principal_tangent)
    if where == ELASTIC:
        return 0
    if where == NOWHERE:
        return NOT_FINITE
    from_principal(returned, dyads, stress)
    elastic_strain_from_stress(stress, parameters, state_old, elastic_strain)
    is_open = where == APEX
    frictional.update_state(
        trial_strain, strain, elastic_strain, is_open, parameters, state_old, state
    )
    if is_open:
        for i in range(6):
            for j in range(6):
                tangent[i, j] *= frictional.APEX_STIFFNESS
        return 0
    tangent_from_principal(
        trial, returned, dyads, principal_tangent, 2.0 * parameters[SHEAR], tangent
    )
    return 0


@jit
def _is_inside_cone(stress, parameters):
    """Return whether the stress is in the cone inside the pyramid: no axes are needed to see it."""
    sine = parameters[SINE]
    height = 1.5 * parameters[COHESIVE] - sine * trace(stress)
    return deviator_norm(stress) * np.sqrt(4.5 + 1.5 * sine * sine) <= height


ELASTIC, PLANE, UPPER_EDGE, LOWER_EDGE, APEX, NOWHERE = 0, 1, 2, 3, 4, 5
"""Where the returned stress lies: inside, on a plane, on the edge of equal tau_1 and tau_2 or of
equal tau_2 and tau_3, at the apex; nowhere if the trial strain is not finite."""


@jit
def _return_principal(trial, left, slope, parameters, stress, tangent):
    """Fill principal stresses (3,) in Pa and d(stress)/d(strain) (3, 3); return where they lie.

    Parameters
    ----------
    trial : (3,)
        Principal trial strains, largest first.
    left, slope
        Part of sin(psi) that is left, and its derivative by the trace of the trial strain.
    """
    lame, shear = parameters[BULK] - 2.0 / 3.0 * parameters[SHEAR], parameters[SHEAR]
    pressure = lame * (trial[0] + trial[1] + trial[2])
    for a in range(3):
        stress[a] = pressure + 2.0 * shear * trial[a]
        for b in range(3):
            tangent[a, b] = lame + (2.0 * shear if a == b else 0.0)
    excess = _yield_value(stress[0], stress[2], parameters)
    if excess <= frictional.ROUND_OFF * shear:
        return ELASTIC
    if not np.isfinite(excess):
        return NOWHERE
    dilation = left * parameters[DILATION]
    where = _plane_or_edge(stress, excess, dilation, parameters)
    _return_to_planes(where, dilation, slope * parameters[DILATION], parameters, stress, tangent)
    if where == UPPER_EDGE:
        stress[0] = stress[1] = 0.5 * (stress[0] + stress[1])  # equal but for round-off
    elif where == LOWER_EDGE:
        stress[1] = stress[2] = 0.5 * (stress[1] + stress[2])
    if where != PLANE and stress[0] <= stress[2]:
        stress[:] = 0.5 * parameters[COHESIVE] / parameters[SINE]
        tangent[:, :] = 0.0
        return APEX
    return where


@jit
def _plane_or_edge(stress, excess, dilation, parameters):
    """Return where the principal trial stress (3,) returns to, the apex not considered."""
    step = 2.0 * parameters[SHEAR] * excess / _resistance(dilation, parameters)
    # relative to tau_2 the flow of the plane lowers tau_1 and raises tau_3
    is_below = stress[0] - (1.0 + dilation) * step >= stress[1]
    is_above = stress[2] + (1.0 - dilation) * step <= stress[1]
    if is_below and is_above:
        return PLANE
    # and it leaves this sum as it is, which tells the two edges apart
    side = (1.0 - dilation) * stress[0] - 2.0 * stress[1] + (1.0 + dilation) * stress[2]
    return LOWER_EDGE if side > 0.0 else UPPER_EDGE


@jit
def _resistance(dilation, parameters):
    """Return what the yield function of a plane loses, in Pa, per flow of that plane."""
    lame, shear = parameters[BULK] - 2.0 / 3.0 * parameters[SHEAR], parameters[SHEAR]
    product = parameters[SINE] * dilation
    return 4.0 * (lame * product + shear * (1.0 + product))


@jit
def _cross_resistance(where, dilation, parameters):
    """Return what it loses, in Pa, per flow of the other plane of an edge."""
    lame, shear = parameters[BULK] - 2.0 / 3.0 * parameters[SHEAR], parameters[SHEAR]
    sign = -1.0 if where == UPPER_EDGE else 1.0  # of the principal stress that both planes have
    sine = parameters[SINE]
    return 4.0 * lame * sine * dilation + 2.0 * shear * (1.0 + sign * sine) * (
        1.0 + sign * dilation
    )


@jit
def _times_elastic(major, minor, sine, parameters, vector):
    """Fill ``vector`` (3,) in Pa with D times the normal (or flow) of the plane of two stresses."""
    shear = parameters[SHEAR]
    vector[:] = 2.0 * (parameters[BULK] - 2.0 / 3.0 * shear) * sine
    vector[major] += 2.0 * shear * (1.0 + sine)
    vector[minor] -= 2.0 * shear * (1.0 - sine)


@jit
def _return_to_planes(where, dilation, dilation_slope, parameters, stress, tangent):
    """Move the principal trial stress (3,) to one plane or two, and correct the tangent (3, 3).

    With normals a_i, flows b_i and the elastic D the multipliers solve (a_i . D b_j) x_j = f_i; the
    tangent loses D b_i (a . D b)^-1_ij a_j D.
    """
    major, minor = 1 if where == UPPER_EDGE else 0, 1 if where == LOWER_EDGE else 2
    normals, flows = np.empty((2, 3)), np.empty((2, 3))
    _times_elastic(0, 2, parameters[SINE], parameters, normals[0])
    _times_elastic(0, 2, dilation, parameters, flows[0])
    first = _yield_value(stress[0], stress[2], parameters)
    own = _resistance(dilation, parameters)
    if where == PLANE:
        second = 0.0
        first /= own
        _lose(1.0 / own, flows[0], normals[0], tangent)
    else:
        _times_elastic(major, minor, parameters[SINE], parameters, normals[1])
        _times_elastic(major, minor, dilation, parameters, flows[1])
        cross = _cross_resistance(where, dilation, parameters)
        determinant = (own - cross) * (own + cross)
        second = _yield_value(stress[major], stress[minor], parameters)
        first, second = (
            (own * first - cross * second) / determinant,
            (own * second - cross * first) / determinant,
        )
        for i in range(2):
            _lose(own / determinant, flows[i], normals[i], tangent)
            _lose(-cross / determinant, flows[i], normals[1 - i], tangent)
    for a in range(3):
        stress[a] -= first * flows[0, a] + (second * flows[1, a] if second != 0.0 else 0.0)
    if dilation_slope != 0.0:
        _fade(major, minor, first, second, dilation_slope, tangent)


@jit
def _lose(factor, flow, normal, tangent):
    """Subtract ``factor`` times the product of ``flow`` (3,) and ``normal`` (3,)."""
    for a in range(3):
        for b in range(3):
            tangent[a, b] -= factor * flow[a] * normal[b]


@jit
def _fade(major, minor, first, second, dilation_slope, tangent):
    """Add to the tangent (3, 3) what the fading of dilation does.

    The stress changes with sin(psi) by -(tangent) x_i d(b_i)/d(sin psi), where x_1 = ``first``
    belongs to the plane of stresses 0 and 2 and x_2 = ``second`` to that of ``major`` and
    ``minor``.
    """
    change = np.zeros(3)
    change[0] += first
    change[2] += first
    change[major] += second
    change[minor] += second
    for a in range(3):
        column = 0.0
        for b in range(3):
            column -= tangent[a, b] * change[b]
        for b in range(3):
            tangent[a, b] += column * dilation_slope
