"""Strength of undisturbed soil in the engineer's figures: friction angle, undrained strength."""

from __future__ import annotations

import numpy as np

from install_mpm.constitutive import modified_cam_clay
from install_mpm.constitutive.parameters import (
    CriticalStateSand,
    ModifiedCamClay,
    SoilParameters,
    UndrainedClay,
)


def friction_angle(soil: SoilParameters) -> float | None:
    """Return the angle of friction in rad in triaxial compression, None for soil without one."""
    if isinstance(soil, ModifiedCamClay | CriticalStateSand):
        ratio = soil.critical_stress_ratio  # M = 6 sin(phi) / (3 - sin(phi))
        return float(np.arcsin(min(3.0 * ratio / (6.0 + ratio), 1.0)))
    angle: float | None = getattr(soil, "friction_angle", None)
    return angle


def has_undrained_shear_strength(soil: SoilParameters) -> bool:
    """Return whether the law has an undrained shear strength."""
    return isinstance(soil, UndrainedClay) or _is_undrained_cam_clay(soil)


def _is_undrained_cam_clay(soil: SoilParameters) -> bool:
    return isinstance(soil, ModifiedCamClay) and soil.pore_fluid_bulk_modulus > 0.0


def undrained_shear_strength(
    soil: SoilParameters, depth: np.ndarray, stress: np.ndarray
) -> np.ndarray:
    """Return s_u (n,) in Pa at ``depth`` (n,) in m under ``stress`` (n, 3, 3), zero if none.

    For undrained modified Cam clay it is that in triaxial compression, M / 2 times the critical
    pressure p^(1 - Lambda) (p_c / 2)^Lambda of the initial volume, Lambda = 1 - kappa / lambda.
    """
    if isinstance(soil, UndrainedClay):
        return soil.undrained_shear_strength + soil.undrained_shear_strength_gradient * depth
    if isinstance(soil, ModifiedCamClay) and _is_undrained_cam_clay(soil):
        size = modified_cam_clay.initial_state(soil, depth, stress)[:, 0]
        pressure = np.maximum(-np.trace(stress, axis1=1, axis2=2) / 3.0, soil.lowest_pressure)
        share = 1.0 - soil.swelling_index / soil.compression_index
        critical: np.ndarray = pressure ** (1.0 - share) * (size / 2.0) ** share
        return 0.5 * soil.critical_stress_ratio * critical
    return np.zeros(len(depth))
