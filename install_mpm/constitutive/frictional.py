"""What frictional soils share: volume as a state, dilation that ends, openings that close first.

The logarithm of the specific volume, ln(1 + e) with the void ratio e, is the sum of the trace of
the elastic strain and of the state ``plastic_log_volume``; no other measure of volume is needed.
During a step the total is known from the trial strain.

With a critical void ratio e_c the sine of the dilation angle fades linearly,

    sin(psi) = sin(psi_0) (e_c - e) / (e_c - e_0)   between 0 and sin(psi_0),

because dilatancy is about proportional to the distance from the critical state (Been and Jefferies
1985; a cut-off in one step is that of common finite element codes).  What opens at the apex, where
the soil carries no more tension, is then kept as ``opening`` and has to close again before pressure
builds up.  Without this, soil that is pulled and pressed in turn would grow with every cycle.
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit
from install_mpm.constitutive.elastic import pack as pack_elastic
from install_mpm.constitutive.mandel import SQRT2, trace
from install_mpm.constitutive.parameters import FrictionalSoil

STATE_VARIABLES = ("plastic_log_volume", "opening", "plastic_shear_strain")

LOG_VOLUME, OPENING, PLASTIC_SHEAR = 0, 1, 2

CRITICAL, FADING = 2, 3
"""Columns of the packed parameters: critical void ratio, and the part of dilation that is lost per
void ratio, 1 / (e_c - e_0); zero if dilation never ends."""

N_PARAMETERS = 4
"""Number of packed parameters that all frictional laws share."""

ROUND_OFF = 1e-13
"""Excess of the yield function over the shear modulus that counts as none.

Soil that has yielded and rests is on its yield surface but for round-off.  Without this bound the
tangent at the start of a step would be elastic or plastic by chance, from point to point.
"""

APEX_STIFFNESS = 1e-12
"""Share of the elastic tangent at the apex, where the law itself has no stiffness.

It keeps matrices regular and is not part of the stress: the equilibrium that is found is that of
the law.  But Newton's method reduces what it gets wrong by the ratio of this stiffness to that of
the soil beside the apex, which resists turning with its stress over its shear strain.  Flowing sand
that carries 10 Pa at a shear strain of 0.3 has a millionth of an elastic stiffness of 100 MPa, and
with a share of 1e-7 convergence there is linear; so the share is five orders below that.
"""


def pack_density(soil: FrictionalSoil) -> list[float]:
    """Return the first ``N_PARAMETERS`` packed parameters; moduli in Pa."""
    moduli = [float(modulus) for modulus in pack_elastic(soil)]
    if soil.critical_void_ratio is None:
        return [*moduli, 0.0, 0.0]
    margin = soil.critical_void_ratio - soil.initial_void_ratio
    if margin <= 0.0:
        return [*moduli, -1.0, 1.0]  # loose soil never dilates: every void ratio is above -1
    return [*moduli, soil.critical_void_ratio, 1.0 / margin]


def initial_state(soil: FrictionalSoil, depth: np.ndarray, stress: np.ndarray) -> np.ndarray:
    """Return the state variables (n, 3) of soil of its initial void ratio under ``stress``."""
    bulk, _ = pack_elastic(soil)
    elastic_volume = np.trace(stress, axis1=1, axis2=2) / (3.0 * bulk)
    state = np.zeros((len(depth), len(STATE_VARIABLES)))
    state[:, LOG_VOLUME] = np.log1p(soil.initial_void_ratio) - elastic_volume
    return state


@jit
def fill_opening(trial_strain, state_old, strain):
    """Fill ``strain`` (6,) with the trial strain, in which the opening counts as elastic."""
    third = state_old[OPENING] / 3.0
    for i in range(6):
        strain[i] = trial_strain[i] + third if i < 3 else trial_strain[i]


@jit
def dilation_left(trial_strain, parameters, state_old):
    """Return the part of the dilation angle's sine that is left at the end of the step, 0 to 1.

    And its derivative by the trace of the trial strain.
    """
    if parameters[FADING] == 0.0:
        return 1.0, 0.0
    volume = np.exp(state_old[LOG_VOLUME] + trace(trial_strain))
    part = (parameters[CRITICAL] + 1.0 - volume) * parameters[FADING]
    if part <= 0.0:
        return 0.0, 0.0
    if part >= 1.0:
        return 1.0, 0.0
    return part, -volume * parameters[FADING]


@jit
def update_state(trial_strain, strain, elastic_strain, is_open, parameters, state_old, state):
    """Fill the state variables (3,) at the end of the step.

    ``strain`` is the trial strain with the opening, ``is_open`` whether the stress is at the apex.
    """
    plastic_volume = trace(strain) - trace(elastic_strain)
    norm = 0.0
    for i in range(6):
        plastic = strain[i] - elastic_strain[i] - (plastic_volume / 3.0 if i < 3 else 0.0)
        norm += plastic * plastic
    state[LOG_VOLUME] = state_old[LOG_VOLUME] + trace(trial_strain) - trace(elastic_strain)
    state[OPENING] = 0.0
    if is_open and parameters[FADING] > 0.0:
        state[OPENING] = plastic_volume
    state[PLASTIC_SHEAR] = state_old[PLASTIC_SHEAR] + SQRT2 * np.sqrt(norm)
