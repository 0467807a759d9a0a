"""Tresca solid for undrained clay, exact at the edges.

    f = tau_1 - tau_3 - 2 s_u <= 0 ,   tau_1 >= tau_2 >= tau_3 principal stresses

The return leaves the principal directions and the mean stress as they are.  It ends on a plane of
the hexagonal prism, where tau_1 and tau_3 have come nearer by the same amount, or, if they would
pass tau_2, on an edge, where two principal stresses are equal and s_u gives all three deviators
(de Souza Neto, Peric and Owen 2008, section 8.1).  With constant strength the return is in closed
form; the strength of clay that is remoulded (``remoulding``) is found by Newton's method.
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit
from install_mpm.constitutive.elastic import (  # the elastic part of the law is shared
    BULK,
    SHEAR,
    elastic_strain_from_stress,
    elastic_stress,
    elastic_tangent,
)
from install_mpm.constitutive.mandel import SQRT2, trace
from install_mpm.constitutive.principal import (
    from_principal,
    principal_axes,
    tangent_from_principal,
)
from install_mpm.constitutive.remoulding import (
    MAX_ITERATIONS,
    REMOULDED,
    TOLERANCE,
    remoulded_strength,
)
from install_mpm.constitutive.von_mises import (  # and so are parameters and state
    PLASTIC_SHEAR,
    STATE_VARIABLES,
    STRENGTH,
    deviator_norm,
    initial_state,
    pack,
)

NOT_FINITE = 1
"""Status: the trial strain or the strength it leaves is not finite."""

__all__ = [
    "STATE_VARIABLES",
    "elastic_strain_from_stress",
    "initial_state",
    "pack",
    "update_stress",
    "yield_function",
]


@jit
def yield_function(stress, parameters, state):
    """Return f in Pa; zero or negative is admissible."""
    values, dyads = np.empty(3), np.empty((6, 6))
    principal_axes(stress, values, dyads)
    strength, _ = remoulded_strength(state[STRENGTH], state[PLASTIC_SHEAR], parameters)
    return values[0] - values[2] - 2.0 * strength


@jit
def update_stress(trial_strain, parameters, state_old, stress, elastic_strain, state, tangent):
    """Return to the hexagonal prism; see ``dispatch.update_stress`` for arguments and status."""
    elastic_stress(trial_strain, parameters, stress)
    elastic_tangent(parameters, tangent)
    elastic_strain[:] = trial_strain
    state[:] = state_old
    strength, _ = remoulded_strength(state_old[STRENGTH], state_old[PLASTIC_SHEAR], parameters)
    shear = parameters[SHEAR]
    if deviator_norm(stress) <= SQRT2 * strength:
        return 0  # the cylinder of von Mises lies inside the prism

    trial, dyads = np.empty(3), np.empty((6, 6))
    principal_axes(trial_strain, trial, dyads)
    excess = 2.0 * shear * (trial[0] - trial[2]) - 2.0 * strength
    if excess <= 0.0:
        return 0
    if not np.isfinite(excess):
        return NOT_FINITE

    returned, principal_tangent = np.empty(3), np.empty((3, 3))
    if not _return_softened(trial, strength, parameters, state_old, returned, principal_tangent):
        return NOT_FINITE
    tangent_from_principal(trial, returned, dyads, principal_tangent, 2.0 * shear, tangent)
    plastic, mean = 0.0, trace(trial_strain) / 3.0
    for a in range(3):
        elastic = mean + returned[a] / (2.0 * shear)
        plastic += (trial[a] - elastic) ** 2
        trial[a] = elastic
        returned[a] += 3.0 * parameters[BULK] * mean
    from_principal(trial, dyads, elastic_strain)
    from_principal(returned, dyads, stress)
    state[PLASTIC_SHEAR] += SQRT2 * np.sqrt(plastic)
    return 0


@jit
def _return_softened(trial, strength, parameters, state_old, returned, tangent):
    """Fill what ``_return_principal`` fills, with the strength that the return leaves.

    ``strength`` in Pa is that before it.  Returns whether it was found: s_u = s_u(xi), xi = xi_old
    + sqrt(2) |eps_p(s_u)|, by Newton's method.  With c = d(returned)/d(s_u) and n = eps_p / |eps_p|
    the derivatives of xi are -c.n / (sqrt(2) G) by s_u and sqrt(2) n by the trial strain.
    """
    shear = parameters[SHEAR]
    mean = (trial[0] + trial[1] + trial[2]) / 3.0
    plastic, by_strength = np.empty(3), np.empty(3)
    for _ in range(MAX_ITERATIONS):
        _return_principal(trial, strength, parameters, returned, tangent, by_strength)
        if parameters[REMOULDED] == 1.0:
            return True
        norm = along = 0.0
        for a in range(3):
            plastic[a] = trial[a] - mean - returned[a] / (2.0 * shear)
            norm += plastic[a] * plastic[a]
            along += plastic[a] * by_strength[a]
        norm = np.sqrt(norm)
        if norm == 0.0:
            return True
        new, slope = remoulded_strength(
            state_old[STRENGTH], state_old[PLASTIC_SHEAR] + SQRT2 * norm, parameters
        )
        stiffness = 1.0 + slope * along / (norm * SQRT2 * shear)
        if stiffness <= 0.0 or not np.isfinite(stiffness):
            return False
        if abs(new - strength) <= TOLERANCE * state_old[STRENGTH]:
            for a in range(3):
                for b in range(3):
                    tangent[a, b] += by_strength[a] * slope * SQRT2 * plastic[b] / norm / stiffness
            return True
        strength += (new - strength) / stiffness
    return False


@jit
def _return_principal(trial, strength, parameters, returned, tangent, by_strength):
    """Fill deviators (3,) of the returned stress and d(stress)/d(strain) (3, 3), principal axes.

    ``by_strength`` (3,) is filled with the derivatives of the deviators by the strength.
    """
    bulk, shear = parameters[BULK], parameters[SHEAR]
    mean = (trial[0] + trial[1] + trial[2]) / 3.0
    between = 2.0 * shear * (trial[1] - mean)
    centre = shear * (trial[0] + trial[2] - 2.0 * mean)
    tangent[:, :] = bulk
    if between >= centre + strength:  # edge of equal major and middle stress
        returned[0] = returned[1] = 2.0 / 3.0 * strength
        returned[2] = -4.0 / 3.0 * strength
        by_strength[0] = by_strength[1] = 2.0 / 3.0
        by_strength[2] = -4.0 / 3.0
        return
    if between <= centre - strength:  # edge of equal middle and minor stress
        returned[0] = 4.0 / 3.0 * strength
        returned[1] = returned[2] = -2.0 / 3.0 * strength
        by_strength[0] = 4.0 / 3.0
        by_strength[1] = by_strength[2] = -2.0 / 3.0
        return
    by_strength[0], by_strength[1], by_strength[2] = 1.0, 0.0, -1.0
    returned[0], returned[2] = centre + strength, centre - strength
    returned[1] = between
    # on the plane 2 G I_dev loses what moves major and minor stress apart
    for a in range(3):
        tangent[a, a] += 2.0 * shear
        for b in range(3):
            tangent[a, b] -= 2.0 / 3.0 * shear
    tangent[0, 0] -= shear
    tangent[2, 2] -= shear
    tangent[0, 2] += shear
    tangent[2, 0] += shear
