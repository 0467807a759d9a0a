"""Modified Cam clay: an ellipse in p and q that grows and shrinks with plastic volume change.

    f = [q^2 / M^2 + p (p - p_c)] / p_c <= 0 ,   associated flow
    p_c = p_c,0 exp(-e_v^p / (lambda* - kappa*)) ,   K = p / kappa*

lambda* = lambda / (1 + e_0) and kappa* = kappa / (1 + e_0) are slopes of ln(volume) against ln p
(Roscoe and Burland 1968; in logarithmic strain Borja and Tamagnini 1998).  Backward Euler: two
equations for the elastic volumetric strain and the plastic multiplier, by Newton's method; where
that fails a bracketed search between the two ends of the ellipse finds a start that does not.
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit
from install_mpm.constitutive.invariants import assemble, shear_invariant, stress_invariants
from install_mpm.constitutive.mandel import trace
from install_mpm.constitutive.parameters import ModifiedCamClay
from install_mpm.constitutive.pressure_elasticity import (
    N_COLUMNS,
    bulk_modulus,
    initial_shear_modulus,
    mean_pressure,
    shear_ratio,
    strain_from_stress,
    updated_shear_modulus,
)

STRESS_RATIO, HARDENING = N_COLUMNS, N_COLUMNS + 1
"""Further columns of the packed parameters: M; lambda* - kappa*."""

STATE_VARIABLES = ("preconsolidation_pressure", "shear_modulus")
PRECONSOLIDATION, SHEAR = 0, 1

NOT_FINITE, NOT_RETURNED = 1, 2
"""Status: the trial strain is not finite; no stress on the ellipse was found."""
MAX_ITERATIONS = 30
BISECTIONS = 60
TOLERANCE = 1e-13
"""Of both equations, relative to their terms: round-off is 1e-15 to 1e-14."""
ON_SURFACE = 1e-12
"""Excess of a stress that counts as on the ellipse, relative to the terms of f."""


def pack(parameters: ModifiedCamClay) -> np.ndarray:
    """Return the packed parameters, shape (7,)."""
    volume = 1.0 + parameters.void_ratio
    swelling = parameters.swelling_index / volume
    lowest = parameters.lowest_pressure
    ratio = shear_ratio(parameters.poissons_ratio, parameters.shear_modulus)
    return np.array(
        [
            lowest, lowest / swelling, 1.0, lowest, ratio,
            parameters.critical_stress_ratio, parameters.compression_index / volume - swelling,
        ]
    )  # fmt: skip


def initial_state(parameters: ModifiedCamClay, depth: np.ndarray, stress: np.ndarray) -> np.ndarray:
    """Return the state variables (n, 2) of ground under ``stress`` (n, 3, 3) in Pa.

    The ellipse through the initial stress, p + q^2 / (M^2 p), times the overconsolidation ratio,
    plus the pre-overburden pressure; at least the lowest pressure.
    """
    row = pack(parameters)
    pressure = -np.trace(stress, axis1=1, axis2=2) / 3.0
    deviator = stress + pressure[:, None, None] * np.eye(3)
    squared = 1.5 * (deviator**2).sum(axis=(1, 2)) / parameters.critical_stress_ratio**2
    size = pressure + squared / np.where(pressure > 0.0, pressure, np.inf)
    preconsolidation = (
        parameters.overconsolidation_ratio * size + parameters.pre_overburden_pressure
    )
    shear = initial_shear_modulus(pressure, row, parameters.shear_modulus)
    return np.column_stack([np.maximum(preconsolidation, parameters.lowest_pressure), shear])


@jit
def elastic_strain_from_stress(stress, parameters, state, elastic_strain):
    """Fill ``elastic_strain`` (6,) of ``stress`` (6,) in Pa with the shear modulus in ``state``."""
    strain_from_stress(stress, parameters, state[SHEAR], elastic_strain)


@jit
def yield_function(stress, parameters, state):
    """Return f in Pa; zero or negative is admissible."""
    pressure, shear_stress = stress_invariants(stress)
    ratio = shear_stress / parameters[STRESS_RATIO]
    size = state[PRECONSOLIDATION]
    return ratio * ratio / size + pressure * (pressure / size - 1.0)


@jit
def update_stress(trial_strain, parameters, state_old, stress, elastic_strain, state, tangent):
    """Return to the ellipse; see ``dispatch.update_stress`` for arguments and status."""
    volumetric, sheared = trace(trial_strain), shear_invariant(trial_strain)
    shear, size = state_old[SHEAR], state_old[PRECONSOLIDATION]
    pressure = mean_pressure(volumetric, parameters)
    ratio = 3.0 * shear * sheared / parameters[STRESS_RATIO]
    if not np.isfinite(pressure + ratio):
        return NOT_FINITE
    state[:] = state_old
    elastic, multiplier = volumetric, 0.0
    terms = ratio * ratio + pressure * pressure + abs(pressure) * size
    if ratio * ratio + pressure * (pressure - size) > ON_SURFACE * terms:
        found, elastic, multiplier = _solve(volumetric, sheared, parameters, shear, size)
        if not found:
            return NOT_RETURNED
    slopes = np.empty(4)
    pressure, secant = _response(
        elastic, multiplier, volumetric, sheared, parameters, shear, size, slopes
    )
    assemble(trial_strain, pressure, secant, slopes, stress, tangent)
    if multiplier > 0.0:
        state[PRECONSOLIDATION] = size * np.exp((elastic - volumetric) / parameters[HARDENING])
    state[SHEAR] = updated_shear_modulus(pressure, parameters, shear)
    share = secant / (3.0 * state[SHEAR])
    for i in range(6):
        elastic_strain[i] = share * trial_strain[i]
        if i < 3:
            elastic_strain[i] += (elastic - share * volumetric) / 3.0
    return 0


@jit
def _equations(elastic, multiplier, volumetric, sheared, parameters, shear, size, equations):
    """Fill residuals and Jacobian of the return; see the derivation in docs/soil_laws.md.

    ``equations`` (8,): R1 = e - e_v,tr - g (2 p - p_c), R2 = q^2 / M^2 + p (p - p_c), their
    derivatives by e (elastic volumetric strain) and g (multiplier), by row, and the sizes of the
    terms of R1 and R2.
    """
    pressure = mean_pressure(elastic, parameters)
    slope = -bulk_modulus(pressure, parameters)
    current = size * np.exp((elastic - volumetric) / parameters[HARDENING])
    growth = current / parameters[HARDENING]
    softening = 6.0 * shear / parameters[STRESS_RATIO] ** 2
    ratio = 3.0 * shear * sheared / (1.0 + softening * multiplier) / parameters[STRESS_RATIO]
    excess = 2.0 * pressure - current
    equations[0] = elastic - volumetric - multiplier * excess
    equations[1] = ratio * ratio + pressure * (pressure - current)
    equations[2] = 1.0 - multiplier * (2.0 * slope - growth)
    equations[3] = -excess
    equations[4] = excess * slope - pressure * growth
    equations[5] = -2.0 * ratio * ratio * softening / (1.0 + softening * multiplier)
    equations[6] = (
        abs(elastic) + abs(volumetric) + abs(multiplier) * (2.0 * abs(pressure) + current)
    )
    equations[7] = ratio * ratio + pressure * pressure + abs(pressure) * current


@jit
def _newton(elastic, multiplier, volumetric, sheared, parameters, shear, size):
    """Return whether Newton's method found an admissible return, and e and g."""
    equations = np.empty(8)
    for _ in range(MAX_ITERATIONS):
        _equations(elastic, multiplier, volumetric, sheared, parameters, shear, size, equations)
        is_small = (
            abs(equations[0]) <= TOLERANCE * equations[6]
            and abs(equations[1]) <= TOLERANCE * equations[7]
        )
        determinant = equations[2] * equations[5] - equations[3] * equations[4]
        if not np.isfinite(determinant) or determinant == 0.0:
            break
        step = (equations[5] * equations[0] - equations[3] * equations[1]) / determinant
        other = (equations[2] * equations[1] - equations[4] * equations[0]) / determinant
        elastic -= step
        multiplier -= other
        if is_small:
            return multiplier > 0.0 and elastic <= 0.0, elastic, multiplier
    return False, elastic, multiplier


@jit
def _solve(volumetric, sheared, parameters, shear, size):
    """Return whether the return to the ellipse was found, and e and g."""
    found, elastic, multiplier = _newton(
        volumetric, 0.0, volumetric, sheared, parameters, shear, size
    )
    if found:
        return found, elastic, multiplier
    elastic, multiplier = _bracketed(volumetric, sheared, parameters, shear, size)
    return _newton(elastic, multiplier, volumetric, sheared, parameters, shear, size)


@jit
def _strain_at(share, volumetric, parameters, size):
    """Return the elastic strain where p is ``share`` of p_c: p falls and p_c grows with it."""
    upper, reach = 0.0, 0.1
    lower = min(volumetric, 0.0)
    for _ in range(BISECTIONS):
        current = size * np.exp((lower - volumetric) / parameters[HARDENING])
        if mean_pressure(lower, parameters) >= share * current:
            break
        lower -= reach
        reach *= 2.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (lower + upper)
        current = size * np.exp((middle - volumetric) / parameters[HARDENING])
        if mean_pressure(middle, parameters) >= share * current:
            lower = middle
        else:
            upper = middle
    return 0.5 * (lower + upper)


@jit
def _bracketed(volumetric, sheared, parameters, shear, size):
    """Return e and g near the return: bisection between an end of the ellipse and its top.

    On the ellipse q follows from e, g from q, and the remaining equation R1 changes sign between
    the top, where the plastic volume change is zero, and the end on the side of the trial strain.
    """
    top = _strain_at(0.5, volumetric, parameters, size)
    lower, upper = top, 0.0
    if top > volumetric:
        lower, upper = _strain_at(1.0, volumetric, parameters, size), top
    elastic, multiplier = top, 0.0
    softening = 6.0 * shear / parameters[STRESS_RATIO] ** 2
    for _ in range(BISECTIONS):
        elastic = 0.5 * (lower + upper)
        pressure = mean_pressure(elastic, parameters)
        current = size * np.exp((elastic - volumetric) / parameters[HARDENING])
        ratio = np.sqrt(max(pressure * (current - pressure), 0.0))
        trial = 3.0 * shear * sheared / parameters[STRESS_RATIO]
        if ratio <= 0.0:
            ratio = 1e-12 * current
        multiplier = (trial / ratio - 1.0) / softening
        if elastic - volumetric - multiplier * (2.0 * pressure - current) > 0.0:
            upper = elastic
        else:
            lower = elastic
    return elastic, multiplier


@jit
def _response(elastic, multiplier, volumetric, sheared, parameters, shear, size, slopes):
    """Return p and q / e_q in Pa and fill ``slopes`` (4,) of ``assemble``."""
    pressure = mean_pressure(elastic, parameters)
    stiffness = bulk_modulus(pressure, parameters)
    if multiplier == 0.0:
        slopes[0], slopes[1], slopes[2], slopes[3] = stiffness, 0.0, 0.0, 3.0 * shear
        return pressure, 3.0 * shear
    equations = np.empty(8)
    _equations(elastic, multiplier, volumetric, sheared, parameters, shear, size, equations)
    stress_ratio = parameters[STRESS_RATIO]
    softening = 6.0 * shear / stress_ratio**2
    growth = size * np.exp((elastic - volumetric) / parameters[HARDENING]) / parameters[HARDENING]
    secant = 3.0 * shear / (1.0 + softening * multiplier)
    shear_stress = secant * sheared
    loss = -shear_stress * softening / (1.0 + softening * multiplier)
    determinant = equations[2] * equations[5] - equations[3] * equations[4]
    # dR = J (de, dg) + dR/d(trial) = 0, first by e_v, then by e_q of the trial strain
    for column in range(2):
        first = 1.0 + multiplier * growth if column == 0 else 0.0
        second = (
            -pressure * growth if column == 0 else -2.0 * shear_stress / stress_ratio**2 * secant
        )
        strain = (equations[5] * first - equations[3] * second) / determinant
        plastic = (equations[2] * second - equations[4] * first) / determinant
        slopes[column] = stiffness * strain
        slopes[2 + column] = loss * plastic + (secant if column == 1 else 0.0)
    return pressure, secant
