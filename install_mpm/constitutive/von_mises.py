"""Von Mises solid for undrained clay, backward Euler with consistent tangent.

    f = |s| - sqrt(2) s_u <= 0 ,   s = dev(tau)

so that the shear strength in simple shear and in plane strain is s_u (Simo and Hughes 1998, box
3.2).  The strength is constant, or falls as the clay is remoulded (``remoulding``).
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit
from install_mpm.constitutive import elastic
from install_mpm.constitutive.elastic import (  # the elastic part of the law is shared
    SHEAR,
    elastic_strain_from_stress,
    elastic_stress,
    elastic_tangent,
)
from install_mpm.constitutive.mandel import SQRT2, trace
from install_mpm.constitutive.parameters import UndrainedClay
from install_mpm.constitutive.remoulding import (
    MAX_ITERATIONS,
    TOLERANCE,
    pack_remoulding,
    remoulded_strength,
)

STATE_VARIABLES = ("undrained_shear_strength", "plastic_shear_strain")
"""Undisturbed strength in Pa; accumulated plastic shear strain sqrt(2) |d eps_p|."""

STRENGTH, PLASTIC_SHEAR = 0, 1

NOT_RETURNED = 1
"""Status: not finite, or the clay softens faster than it unloads elastically."""

__all__ = ["elastic_strain_from_stress", "initial_state", "pack", "update_stress", "yield_function"]


def pack(parameters: UndrainedClay) -> np.ndarray:
    """Return the packed parameters (4,): moduli in Pa, remoulding; the strength is a state."""
    softening = pack_remoulding(parameters.sensitivity, parameters.remoulding_strain)
    return np.concatenate([elastic.pack(parameters), softening])


def initial_state(parameters: UndrainedClay, depth: np.ndarray, stress: np.ndarray) -> np.ndarray:
    """Return the state variables (n, 2) of material at ``depth`` (n,) in m."""
    strength = (
        parameters.undrained_shear_strength + parameters.undrained_shear_strength_gradient * depth
    )
    return np.column_stack([strength, np.zeros_like(depth)])


@jit
def deviator_norm(stress):
    """Return |s|, the norm of the deviator of ``stress`` (6,)."""
    mean = trace(stress) / 3.0
    total = 0.0
    for i in range(6):
        deviator = stress[i] - mean if i < 3 else stress[i]
        total += deviator * deviator
    return np.sqrt(total)


@jit
def yield_function(stress, parameters, state):
    """Return f in Pa; zero or negative is admissible."""
    strength, _ = remoulded_strength(state[STRENGTH], state[PLASTIC_SHEAR], parameters)
    return deviator_norm(stress) - SQRT2 * strength


@jit
def update_stress(trial_strain, parameters, state_old, stress, elastic_strain, state, tangent):
    """Return radially to the cylinder; see ``dispatch.update_stress`` for arguments and status."""
    elastic_stress(trial_strain, parameters, stress)
    elastic_tangent(parameters, tangent)
    elastic_strain[:] = trial_strain
    state[:] = state_old

    trial_norm = deviator_norm(stress)
    strength, _ = remoulded_strength(state_old[STRENGTH], state_old[PLASTIC_SHEAR], parameters)
    if trial_norm <= SQRT2 * strength:
        return 0

    shear = parameters[SHEAR]
    mean = trace(stress) / 3.0
    radius, softening = _returned_radius(trial_norm, parameters, state_old)
    if softening <= -1.0 or not np.isfinite(radius):
        return NOT_RETURNED
    plastic_strain = (trial_norm - radius) / (2.0 * shear)
    shrink = radius / trial_norm
    direction = np.empty(6)
    for i in range(6):
        direction[i] = (stress[i] - mean if i < 3 else stress[i]) / trial_norm
        stress[i] = (mean if i < 3 else 0.0) + radius * direction[i]
        elastic_strain[i] -= plastic_strain * direction[i]
    state[PLASTIC_SHEAR] += SQRT2 * plastic_strain

    # D = K 1x1 + 2G r/|s_tr| (I_dev - n x n) + 2G dr/d|s_tr| n x n
    # the elastic tangent already holds K 1x1 + 2G I_dev
    loss = 2.0 * shear * (1.0 - shrink)
    along = 2.0 * shear * (shrink - softening / (1.0 + softening))
    for i in range(6):
        tangent[i, i] -= loss
        for j in range(6):
            tangent[i, j] -= along * direction[i] * direction[j]
    for i in range(3):
        for j in range(3):
            tangent[i, j] += loss / 3.0
    return 0


@jit
def _returned_radius(trial_norm, parameters, state_old):
    """Return the radius r in Pa after the return, and dr/d|eps_p| over 2G; NaN if there is none.

    |s_tr| - 2G |eps_p| = r(xi) with xi = xi_old + sqrt(2) |eps_p|, by Newton's method.
    """
    shear = parameters[SHEAR]
    undisturbed, before = state_old[STRENGTH], state_old[PLASTIC_SHEAR]
    strength, _ = remoulded_strength(undisturbed, before, parameters)
    radius = SQRT2 * strength
    for _ in range(MAX_ITERATIONS):
        plastic_strain = (trial_norm - radius) / (2.0 * shear)
        strength, slope = remoulded_strength(
            undisturbed, before + SQRT2 * plastic_strain, parameters
        )
        softening = slope / shear  # d(sqrt(2) s_u)/d|eps_p| over 2G
        excess = SQRT2 * strength - radius
        if abs(excess) <= TOLERANCE * trial_norm or softening <= -1.0:
            return radius, softening
        radius += excess / (1.0 + softening)
    return np.nan, 0.0
