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
from install_mpm.constitutive.eigen import symmetric_eigen
from install_mpm.constitutive.elastic import (  # the elastic part of the law is shared
    BULK,
    SHEAR,
    elastic_strain_from_stress,
    elastic_stress,
    elastic_tangent,
)
from install_mpm.constitutive.mandel import COLUMN, ROW, SCALE, SQRT2, from_mandel, trace
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
def principal(vector, values, vectors):
    """Fill principal values (3,), largest first, and directions (3, 3), columns, of a six-vector.

    Returns the indices of the largest, middle and smallest value in ``values``.
    """
    tensor = np.empty((3, 3))
    from_mandel(vector, tensor)
    symmetric_eigen(tensor, values, vectors)
    major = 0 if values[0] >= values[1] and values[0] >= values[2] else 1
    if values[2] > values[major]:
        major = 2
    minor = (major + 1) % 3
    if values[(major + 2) % 3] < values[minor]:
        minor = (major + 2) % 3
    return major, 3 - major - minor, minor


@jit
def yield_function(stress, parameters, state):
    """Return f in Pa; zero or negative is admissible."""
    values, vectors = np.empty(3), np.empty((3, 3))
    major, _, minor = principal(stress, values, vectors)
    strength, _ = remoulded_strength(state[STRENGTH], state[PLASTIC_SHEAR], parameters)
    return values[major] - values[minor] - 2.0 * strength


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

    trial, directions = np.empty(3), np.empty((3, 3))
    major, middle, minor = principal(trial_strain, trial, directions)
    excess = 2.0 * shear * (trial[major] - trial[minor]) - 2.0 * strength
    if excess <= 0.0:
        return 0
    if not np.isfinite(excess):
        return NOT_FINITE

    returned, principal_tangent = np.empty(3), np.empty((3, 3))
    if not _return_softened(
        trial, major, middle, minor, strength, parameters, state_old, returned, principal_tangent
    ):
        return NOT_FINITE
    plastic = 0.0
    elastic_strain[:] = 0.0
    stress[:] = 0.0
    mean = trace(trial_strain) / 3.0
    for a in range(3):
        plastic += (trial[a] - mean - returned[a] / (2.0 * shear)) ** 2
        for component in range(6):
            dyad = _dyad(directions, a, a, component)
            elastic_strain[component] += (mean + returned[a] / (2.0 * shear)) * dyad
            stress[component] += (3.0 * parameters[BULK] * mean + returned[a]) * dyad
    state[PLASTIC_SHEAR] += SQRT2 * np.sqrt(plastic)
    _turn_tangent(trial, returned, directions, principal_tangent, 2.0 * shear, tangent)
    return 0


@jit
def _return_softened(
    trial, major, middle, minor, strength, parameters, state_old, returned, tangent
):
    """Fill what ``_return_principal`` fills, with the strength that the return leaves.

    ``strength`` in Pa is that before it.  Returns whether it was found: s_u = s_u(xi), xi = xi_old
    + sqrt(2) |eps_p(s_u)|, by Newton's method.  With c = d(returned)/d(s_u) and n = eps_p / |eps_p|
    the derivatives of xi are -c.n / (sqrt(2) G) by s_u and sqrt(2) n by the trial strain.
    """
    shear = parameters[SHEAR]
    mean = (trial[0] + trial[1] + trial[2]) / 3.0
    plastic, by_strength = np.empty(3), np.empty(3)
    for _ in range(MAX_ITERATIONS):
        _return_principal(
            trial, major, middle, minor, strength, parameters, returned, tangent, by_strength
        )
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
def _return_principal(
    trial, major, middle, minor, strength, parameters, returned, tangent, by_strength
):
    """Fill deviators (3,) of the returned stress and d(stress)/d(strain) (3, 3), principal axes.

    ``by_strength`` (3,) is filled with the derivatives of the deviators by the strength.
    """
    bulk, shear = parameters[BULK], parameters[SHEAR]
    mean = (trial[0] + trial[1] + trial[2]) / 3.0
    between = 2.0 * shear * (trial[middle] - mean)
    centre = shear * (trial[major] + trial[minor] - 2.0 * mean)
    tangent[:, :] = bulk
    if between >= centre + strength:  # edge of equal major and middle stress
        returned[major] = returned[middle] = 2.0 / 3.0 * strength
        returned[minor] = -4.0 / 3.0 * strength
        by_strength[major] = by_strength[middle] = 2.0 / 3.0
        by_strength[minor] = -4.0 / 3.0
        return
    if between <= centre - strength:  # edge of equal middle and minor stress
        returned[major] = 4.0 / 3.0 * strength
        returned[middle] = returned[minor] = -2.0 / 3.0 * strength
        by_strength[major] = 4.0 / 3.0
        by_strength[middle] = by_strength[minor] = -2.0 / 3.0
        return
    by_strength[major], by_strength[middle], by_strength[minor] = 1.0, 0.0, -1.0
    returned[major], returned[minor] = centre + strength, centre - strength
    returned[middle] = between
    # on the plane 2 G I_dev loses what moves major and minor stress apart
    for a in range(3):
        tangent[a, a] += 2.0 * shear
        for b in range(3):
            tangent[a, b] -= 2.0 / 3.0 * shear
    tangent[major, major] -= shear
    tangent[minor, minor] -= shear
    tangent[major, minor] += shear
    tangent[minor, major] += shear


@jit
def _turn_tangent(trial, returned, directions, principal_tangent, largest, tangent):
    """Fill ``tangent`` (6, 6) from the principal one and the turning of the principal axes.

    Where two axes turn into each other the stress changes by (tau_a - tau_b) / (eps_a - eps_b),
    at most ``largest`` in Pa.  Strains can only be equal where the stresses are, on an edge.
    """
    tangent[:, :] = 0.0
    for a in range(3):
        for b in range(3):
            turning = 0.0
            if a != b and returned[a] != returned[b] and trial[a] != trial[b]:
                turning = (returned[a] - returned[b]) / (trial[a] - trial[b])
                turning = min(turning, largest)  # round-off next to an edge
            for row in range(6):
                first, mixed = _dyad(directions, a, a, row), _dyad(directions, a, b, row)
                for column in range(6):
                    tangent[row, column] += principal_tangent[a, b] * first * _dyad(
                        directions, b, b, column
                    ) + turning * mixed * _dyad(directions, a, b, column)


@jit
def _dyad(directions, a, b, component):
    """Return one Mandel component of the symmetric dyad of two principal directions."""
    i, j = ROW[component], COLUMN[component]
    return (
        0.5
        * SCALE[component]
        * (directions[i, a] * directions[j, b] + directions[j, a] * directions[i, b])
    )
