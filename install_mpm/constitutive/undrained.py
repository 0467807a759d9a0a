"""Undrained soil: any law of effective stress together with a pore fluid that cannot leave.

    tau = tau' - u 1 ,   u = -K_w e_v

e_v is the volumetric strain since the pore pressure was hydrostatic and K_w the bulk modulus of the
fluid over the porosity (for water 2.2 GPa / n; far less serves as well, if it is some 50 times that
of the skeleton).  u is the *excess* pore pressure: together with the hydrostatic one, which
balances the weight of the water in and above the ground, it is the pore pressure.

The elastic strain that is carried has the trace e_v and the deviator of the skeleton's elastic
strain: the trace is a measure of the pore pressure, and all that keeps total pressures smooth from
point to point keeps pore pressures smooth.  What e_v has more than the elastic strain of the
skeleton is the state variable ``skeleton_volume``.
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit
from install_mpm.constitutive.mandel import trace

FLUID = -1
"""Column of the packed parameters: K_w in Pa, zero in drained soil."""
STATE_VARIABLES = ("excess_pore_pressure", "skeleton_volume")
PORE_PRESSURE, SKELETON_VOLUME = 0, 1
N_STATE = 2
"""The state variables of the law of the skeleton begin here."""

MAX_ITERATIONS = 100
N_SEARCH = 4
"""Numbers in a search: pore pressure, its bounds in Pa, whether there are bounds."""


def initial_state(skeleton_state: np.ndarray, skeleton_strain: np.ndarray) -> np.ndarray:
    """Return the state variables (n, 2 + n_state) without excess pore pressure.

    ``skeleton_strain`` (n, 6) is the elastic strain of the initial effective stress.
    """
    volume = -skeleton_strain[:, :3].sum(axis=1)
    return np.column_stack([np.zeros_like(volume), volume, skeleton_state])


@jit
def skeleton_strain(trial_strain, state_old, strain):
    """Fill the trial ``strain`` (6,) of the skeleton."""
    for i in range(6):
        strain[i] = trial_strain[i] - (state_old[SKELETON_VOLUME] / 3.0 if i < 3 else 0.0)


@jit
def add_pore_fluid(trial_strain, fluid, stress, elastic_strain, state, tangent):
    """Turn effective stress, elastic strain and tangent of the skeleton into those of the soil."""
    volumetric = trace(trial_strain)
    state[PORE_PRESSURE] = -fluid * volumetric
    state[SKELETON_VOLUME] = volumetric - trace(elastic_strain)
    for i in range(3):
        stress[i] += fluid * volumetric
        elastic_strain[i] += state[SKELETON_VOLUME] / 3.0
        for j in range(3):
            tangent[i, j] += fluid


@jit
def effective_stress(stress, pore_pressure, effective):
    """Fill ``effective`` (6,) stress in Pa from the total ``stress`` (6,)."""
    for i in range(6):
        effective[i] = stress[i] + (pore_pressure if i < 3 else 0.0)


@jit
def start_search(state, search):
    """Fill ``search`` (4,) with the start of the search for the pore pressure of a total stress."""
    search[:] = 0.0
    search[0] = state[PORE_PRESSURE]


@jit
def is_found(skeleton_strain, state, fluid, search):
    """Return whether ``search`` (4,) has found the pore pressure; if not, improve it.

    The strain of the skeleton grows with u, so that h(u) = e_v + u / K_w grows by at least 1 / K_w
    per unit: the root is bracketed by the first value, and bisection finds it.
    """
    excess = trace(skeleton_strain) + state[SKELETON_VOLUME] + search[0] / fluid
    size = abs(trace(skeleton_strain)) + abs(state[SKELETON_VOLUME])
    if abs(excess) <= 1e-15 * size or (search[3] == 1.0 and search[1] == search[2]):
        return True
    if search[3] == 0.0:
        other = search[0] - fluid * excess
        search[1], search[2], search[3] = min(search[0], other), max(search[0], other), 1.0
    elif excess > 0.0:
        search[2] = search[0]
    else:
        search[1] = search[0]
    middle = 0.5 * (search[1] + search[2])
    if middle == search[0]:
        return True
    search[0] = middle
    return False


@jit
def add_volume(state, elastic_strain):
    """Turn the elastic strain (6,) of the skeleton into that of the soil."""
    for i in range(3):
        elastic_strain[i] += state[SKELETON_VOLUME] / 3.0
