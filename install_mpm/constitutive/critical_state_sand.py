"""Sand of critical-state theory: friction and dilation follow from the state parameter.

    psi = e - e_c(p) ,   e_c = Gamma - lambda ln(p / 1 kPa)
    f = q - M_b p <= 0 ,   M_b = M exp(-k psi) ,   k = (1 - N) chi / M
    D = (M - M_b) / (1 - N) ,   D = plastic volume loss per plastic shear strain e_q^p

It is what NorSand comes to at its limit, where hardening is complete (Jefferies 1993; Jefferies and
Been 2016, chapter 3): Nova's flow rule D = (M - q/p) / (1 - N) at the peak, where the dilation is D
= chi psi.  The exponential agrees with M_b = M - (1 - N) chi psi for small psi, and keeps very
loose sand from losing all its strength.  Dense sand (psi < 0) is strong and dilates, loose sand is
weak and contracts, and both go to q = M p with D = 0 as the void ratio becomes e_c.  Hardening
before the peak is left out: the sand is elastic there.

The void ratio at the end of a step is known from the trial strain and the state, so that the return
is one equation for the elastic volumetric strain; the stress keeps the direction of the trial
deviator, or goes to the apex p = 0.  What opens at the apex has to close before pressure builds up
again.
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit
from install_mpm.constitutive.frictional import APEX_STIFFNESS
from install_mpm.constitutive.invariants import assemble, shear_invariant, stress_invariants
from install_mpm.constitutive.mandel import trace
from install_mpm.constitutive.parameters import CriticalStateSand
from install_mpm.constitutive.pressure_elasticity import (
    N_COLUMNS,
    bulk_modulus,
    initial_shear_modulus,
    mean_pressure,
    shear_ratio,
    strain_from_stress,
    updated_shear_modulus,
    volumetric_strain,
)

STRESS_RATIO, STATE_FACTOR, FLOW, ALTITUDE, CRITICAL_SLOPE = range(N_COLUMNS, N_COLUMNS + 5)
"""Further columns of the packed parameters: M, k, 1 - N, Gamma (at 1 kPa), lambda."""

STATE_VARIABLES = ("plastic_log_volume", "opening", "shear_modulus")
LOG_VOLUME, OPENING, SHEAR = 0, 1, 2

NOT_FINITE, NOT_RETURNED = 1, 2
"""Status: the trial strain is not finite; no stress on the cone was found."""
MAX_ITERATIONS = 100
TOLERANCE = 1e-14
ON_SURFACE = 1e-12
"""Excess of a stress that counts as on the cone, relative to q + M_b p."""
LARGEST_STRESS_RATIO = 2.25
"""M_b never exceeds that of a friction angle of 55 degrees, more than any sand has."""
REFERENCE_PRESSURE = 1e3
"""Pressure in Pa at which the critical void ratio is Gamma (Jefferies and Been 2016)."""


def pack(parameters: CriticalStateSand) -> np.ndarray:
    """Return the packed parameters, shape (10,)."""
    flow = 1.0 - parameters.volumetric_coupling
    ratio = shear_ratio(parameters.poissons_ratio, 0.0)
    return np.array(
        [
            parameters.reference_pressure, parameters.reference_shear_modulus / ratio,
            parameters.stiffness_exponent, parameters.lowest_pressure, ratio,
            parameters.critical_stress_ratio,
            flow * parameters.state_dilatancy / parameters.critical_stress_ratio, flow,
            parameters.critical_void_ratio, parameters.critical_state_slope,
        ]
    )  # fmt: skip


def initial_state(
    parameters: CriticalStateSand, depth: np.ndarray, stress: np.ndarray
) -> np.ndarray:
    """Return the state variables (n, 3) of sand of its void ratio under ``stress`` (n, 3, 3)."""
    row = pack(parameters)
    pressure = -np.trace(stress, axis1=1, axis2=2) / 3.0
    elastic = np.array([volumetric_strain(p, row) for p in pressure])
    shear = initial_shear_modulus(pressure, row, 0.0)
    volume = np.log1p(parameters.void_ratio) - elastic
    return np.column_stack([volume, np.zeros_like(volume), shear])


@jit
def elastic_strain_from_stress(stress, parameters, state, elastic_strain):
    """Fill ``elastic_strain`` (6,) of ``stress`` (6,) in Pa with the shear modulus in ``state``."""
    strain_from_stress(stress, parameters, state[SHEAR], elastic_strain)


@jit
def peak_stress_ratio(pressure, log_volume, parameters):
    """Return M_b and its derivatives by p in 1/Pa and by ``log_volume``, which is ln(1 + e)."""
    lowest = parameters[3]
    critical = parameters[ALTITUDE] - parameters[CRITICAL_SLOPE] * np.log(
        max(pressure, lowest) / REFERENCE_PRESSURE
    )
    state_parameter = np.expm1(log_volume) - critical
    ratio = parameters[STRESS_RATIO] * np.exp(-parameters[STATE_FACTOR] * state_parameter)
    if ratio >= LARGEST_STRESS_RATIO:
        return LARGEST_STRESS_RATIO, 0.0, 0.0
    by_volume = -parameters[STATE_FACTOR] * np.exp(log_volume) * ratio
    if pressure < lowest:
        return ratio, 0.0, by_volume
    by_pressure = -ratio * parameters[STATE_FACTOR] * parameters[CRITICAL_SLOPE] / pressure
    return ratio, by_pressure, by_volume


@jit
def yield_function(stress, parameters, state):
    """Return f in Pa; zero or negative is admissible."""
    pressure, shear_stress = stress_invariants(stress)
    log_volume = state[LOG_VOLUME] + volumetric_strain(pressure, parameters)
    ratio, _, _ = peak_stress_ratio(pressure, log_volume, parameters)
    return shear_stress - ratio * pressure


@jit
def update_stress(trial_strain, parameters, state_old, stress, elastic_strain, state, tangent):
    """Return to the cone; see ``dispatch.update_stress`` for arguments and status."""
    volumetric = trace(trial_strain) + state_old[OPENING]
    sheared, shear = shear_invariant(trial_strain), state_old[SHEAR]
    log_volume = state_old[LOG_VOLUME] + trace(trial_strain)  # the opening is part of it
    pressure = mean_pressure(volumetric, parameters)
    ratio, _, _ = peak_stress_ratio(pressure, log_volume, parameters)
    if not np.isfinite(pressure + ratio + sheared):
        return NOT_FINITE
    state[:] = state_old
    slopes = np.empty(4)
    elastic, secant = volumetric, 3.0 * shear
    slopes[0], slopes[1] = bulk_modulus(pressure, parameters), 0.0
    slopes[2], slopes[3] = 0.0, secant
    limit = ratio * pressure
    if secant * sheared - limit > ON_SURFACE * (secant * sheared + abs(limit)) or pressure < 0.0:
        elastic, secant = _return(volumetric, sheared, parameters, shear, log_volume, slopes)
        if not np.isfinite(elastic):
            return NOT_RETURNED
    pressure, is_open = mean_pressure(elastic, parameters), secant == 0.0
    assemble(trial_strain, pressure, slopes[3] if is_open else secant, slopes, stress, tangent)
    if is_open:
        stress[:] = 0.0
    state[OPENING] = max(volumetric, 0.0) if elastic == 0.0 else 0.0
    state[LOG_VOLUME] = log_volume - elastic
    state[SHEAR] = updated_shear_modulus(pressure, parameters, shear)
    share = secant / (3.0 * state[SHEAR])
    for i in range(6):
        elastic_strain[i] = share * trial_strain[i]
        if i < 3:
            elastic_strain[i] += (elastic - share * trace(trial_strain)) / 3.0
    return 0


@jit
def _equation(elastic, volumetric, sheared, parameters, shear, log_volume, terms):
    """Return R = e - e_v,tr - D (e_q,tr - q / 3G) and fill ``terms`` (6,).

    On the cone q = M_b p; ``terms``: dR/de, q in Pa, dq/de in Pa, D, dM_b/d ln(1 + e), plastic
    shear strain.
    """
    pressure = mean_pressure(elastic, parameters)
    ratio, by_pressure, by_volume = peak_stress_ratio(pressure, log_volume, parameters)
    slope = -bulk_modulus(pressure, parameters)
    flow = (parameters[STRESS_RATIO] - ratio) / parameters[FLOW]
    terms[1] = ratio * pressure
    terms[2] = (ratio + by_pressure * pressure) * slope
    terms[3], terms[4] = flow, by_volume
    terms[5] = sheared - terms[1] / (3.0 * shear)
    terms[0] = (
        1.0 + by_pressure * slope / parameters[FLOW] * terms[5] + flow * terms[2] / (3.0 * shear)
    )
    return elastic - volumetric - flow * terms[5]


@jit
def _return(volumetric, sheared, parameters, shear, log_volume, slopes):
    """Return the elastic volumetric strain and q / e_q,tr in Pa; fill ``slopes`` (4,).

    NaN if there is none.  The root lies between the strain at which the trial q is on the cone and
    the apex; Newton's method, with bisection where it leaves the bracket.
    """
    terms = np.empty(6)
    stiffness = bulk_modulus(0.0, parameters)
    upper = 0.0
    if _equation(upper, volumetric, sheared, parameters, shear, log_volume, terms) <= 0.0:
        slopes[0], slopes[1] = APEX_STIFFNESS * stiffness, 0.0
        slopes[2], slopes[3] = 0.0, 3.0 * APEX_STIFFNESS * shear
        return 0.0, 0.0
    lower, reach = min(volumetric, 0.0), 1e-3
    for _ in range(MAX_ITERATIONS):
        if _equation(lower, volumetric, sheared, parameters, shear, log_volume, terms) < 0.0:
            break
        lower -= reach
        reach *= 2.0
    elastic = lower
    for _ in range(MAX_ITERATIONS):
        residual = _equation(elastic, volumetric, sheared, parameters, shear, log_volume, terms)
        if residual > 0.0:
            upper = elastic
        else:
            lower = elastic
        previous = elastic
        elastic -= residual / terms[0]
        if abs(elastic - previous) <= TOLERANCE * (abs(elastic) + abs(volumetric)):
            _fill_slopes(elastic, volumetric, sheared, parameters, shear, log_volume, slopes)
            return elastic, terms[1] / sheared
        if not (lower < elastic < upper):
            elastic = 0.5 * (lower + upper)
    return np.nan, 0.0


@jit
def _fill_slopes(elastic, volumetric, sheared, parameters, shear, log_volume, slopes):
    """Fill ``slopes`` (4,) of ``assemble`` by the implicit derivative of R = 0."""
    terms = np.empty(6)
    _equation(elastic, volumetric, sheared, parameters, shear, log_volume, terms)
    pressure = mean_pressure(elastic, parameters)
    # the void ratio changes with the trial volume: d ln(1 + e) = d e_v,tr
    by_volume = terms[4]
    shear_by_volume = by_volume * pressure
    residual_by_volume = (
        -1.0 + by_volume / parameters[FLOW] * terms[5] + terms[3] * shear_by_volume / (3.0 * shear)
    )
    stiffness = bulk_modulus(pressure, parameters)
    by_volumetric, by_sheared = -residual_by_volume / terms[0], terms[3] / terms[0]
    slopes[0], slopes[1] = stiffness * by_volumetric, stiffness * by_sheared
    slopes[2] = terms[2] * by_volumetric + shear_by_volume
    slopes[3] = terms[2] * by_sheared
