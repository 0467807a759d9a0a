"""Strength of undisturbed soil in the engineer's figures: friction angle, undrained strength."""

from __future__ import annotations

import numpy as np

from install_mpm.constitutive.parameters import SoilParameters, UndrainedClay


def friction_angle(soil: SoilParameters) -> float | None:
    """Return the angle of friction in rad in triaxial compression, None for soil without one."""
    angle: float | None = getattr(soil, "friction_angle", None)
    return angle


def has_undrained_shear_strength(soil: SoilParameters) -> bool:
    """Return whether the law has an undrained shear strength."""
    return isinstance(soil, UndrainedClay)


def undrained_shear_strength(
    soil: SoilParameters, depth: np.ndarray, stress: np.ndarray
) -> np.ndarray:
    """Return s_u (n,) in Pa at ``depth`` (n,) in m under ``stress`` (n, 3, 3), zero if none."""
    if isinstance(soil, UndrainedClay):
        return soil.undrained_shear_strength + soil.undrained_shear_strength_gradient * depth
    return np.zeros(len(depth))
