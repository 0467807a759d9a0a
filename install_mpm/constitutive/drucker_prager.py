"""Perfectly plastic Drucker-Prager solid with its apex, in closed form.

    f = sqrt(J_2) + alpha tr(tau) - k <= 0

Tension is positive.  The flow follows the same function with beta in place of alpha.  The stress
returns to the cone or, if it would pass the axis, to the apex k / (3 alpha) (de Souza Neto, Peric
and Owen 2008, section 8.3).  alpha, beta and k match Mohr-Coulomb's pyramid as ``pack`` says.
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
from install_mpm.constitutive.mandel import SQRT2, trace
from install_mpm.constitutive.parameters import DruckerPrager
from install_mpm.constitutive.von_mises import deviator_norm

FRICTION, STRENGTH, DILATION = (frictional.N_PARAMETERS + column for column in range(3))
"""Columns of the packed parameters: alpha, k in Pa, beta of dense soil."""

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


def pack(soil: DruckerPrager) -> np.ndarray:
    """Return the packed parameters, shape (7,)."""
    friction, dilation = cone(soil)
    strength = 3.0 * friction * soil.cohesion / np.tan(soil.friction_angle)
    return np.array([*frictional.pack_density(soil), friction, strength, dilation])


def cone(soil: DruckerPrager) -> tuple[float, float]:
    """Return alpha and beta of the cone that matches the pyramid; the apex is always the same.

    In triaxial compression or extension 2 sin / (sqrt(3) (3 -+ sin)).  In plane strain the flow
    must not stretch the third direction, where the deviator is therefore -2 beta sqrt(J_2); with w
    = sqrt(1 - 3 beta^2), sin(psi) = 3 beta / w and alpha = sin(phi) / (3 (w + beta sin(phi))).  For
    equal angles that is the cone inside the pyramid, sin / sqrt(9 + 3 sin^2).
    """
    friction, dilation = np.sin(soil.friction_angle), np.sin(soil.dilation_angle)
    if soil.cone in ("compression", "extension"):
        sign = -1.0 if soil.cone == "compression" else 1.0
        alpha, beta = (
            2.0 * sine / (np.sqrt(3.0) * (3.0 + sign * sine)) for sine in (friction, dilation)
        )
        return alpha, beta
    alpha, beta = (sine / np.sqrt(9.0 + 3.0 * sine**2) for sine in (friction, dilation))
    if soil.cone == "plane_strain":
        alpha = friction / (3.0 * (np.sqrt(1.0 - 3.0 * beta**2) + beta * friction))
    return alpha, beta


@jit
def yield_function(stress, parameters, state):
    """Return f in Pa; zero or negative is admissible."""
    return (
        deviator_norm(stress) / SQRT2 + parameters[FRICTION] * trace(stress) - parameters[STRENGTH]
    )


@jit
def update_stress(trial_strain, parameters, state_old, stress, elastic_strain, state, tangent):
    """Return to the cone; see ``dispatch.update_stress`` for arguments and status."""
    strain = np.empty(6)
    frictional.fill_opening(trial_strain, state_old, strain)
    elastic_stress(strain, parameters, stress)
    elastic_tangent(parameters, tangent)
    elastic_strain[:] = strain
    state[:] = state_old
    frictional.update_state(trial_strain, strain, strain, False, parameters, state_old, state)
    excess = yield_function(stress, parameters, state)
    if excess <= frictional.ROUND_OFF * parameters[SHEAR]:
        return 0
    if not np.isfinite(excess):
        return NOT_FINITE

    left, slope = frictional.dilation_left(trial_strain, parameters, state_old)
    dilation = left * parameters[DILATION]
    bulk, shear = parameters[BULK], parameters[SHEAR]
    resistance = shear + 9.0 * bulk * parameters[FRICTION] * dilation
    is_open = deviator_norm(stress) / SQRT2 <= shear * excess / resistance
    if is_open:
        stress[:] = 0.0
        stress[:3] = parameters[STRENGTH] / (3.0 * parameters[FRICTION])
        for i in range(6):
            for j in range(6):
                tangent[i, j] *= frictional.APEX_STIFFNESS
    else:
        _return_to_cone(excess, dilation, slope * parameters[DILATION], parameters, stress, tangent)
    elastic_strain_from_stress(stress, parameters, state_old, elastic_strain)
    frictional.update_state(
        trial_strain, strain, elastic_strain, is_open, parameters, state_old, state
    )
    return 0


@jit
def _return_to_cone(excess, dilation, dilation_slope, parameters, stress, tangent):
    """Move the trial ``stress`` (6,) to the cone, and correct the elastic ``tangent`` (6, 6).

    With the unit deviator n, the flow D b = sqrt(2) G n + 3 K beta 1, the same with alpha for the
    normal, and x = f / (a . D b): D loses (1 - r) 2 G (I_dev - n n) and D b a D / (a . D b), with r
    the ratio of the deviators.
    """
    bulk, shear = parameters[BULK], parameters[SHEAR]
    resistance = shear + 9.0 * bulk * parameters[FRICTION] * dilation
    multiplier = excess / resistance
    size, mean = deviator_norm(stress), trace(stress) / 3.0
    shrink = 1.0 - SQRT2 * shear * multiplier / size
    direction, flow, normal = np.empty(6), np.empty(6), np.empty(6)
    for i in range(6):
        diagonal = 1.0 if i < 3 else 0.0
        direction[i] = (stress[i] - mean * diagonal) / size
        flow[i] = SQRT2 * shear * direction[i] + 3.0 * bulk * dilation * diagonal
        normal[i] = SQRT2 * shear * direction[i] + 3.0 * bulk * parameters[FRICTION] * diagonal
        stress[i] -= multiplier * flow[i]
    loss = 2.0 * shear * (1.0 - shrink)
    # the multiplier itself falls with dilation
    fall = 9.0 * bulk * parameters[FRICTION] / resistance
    for i in range(6):
        is_normal = 1.0 if i < 3 else 0.0
        fading = multiplier * (fall * flow[i] - 3.0 * bulk * is_normal) * dilation_slope
        for j in range(6):
            tangent[i, j] += loss * direction[i] * direction[j] - flow[i] * normal[j] / resistance
            if i == j:
                tangent[i, j] -= loss
            if j < 3:
                tangent[i, j] += fading + is_normal * loss / 3.0
