"""Undisturbed ground: unit weight, K0 and soil, and the geostatic state that follows from them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Ge, Gt

from install_mpm.constitutive.parameters import SoilParameters, UndrainedClay
from install_mpm.conventions import Unit


@dataclass(frozen=True)
class Ground:
    """Uniform ground with a level surface at z = 0 and total stresses (undrained)."""

    unit_weight: Annotated[float, Unit("N/m^3"), Ge(0)]
    k0: Annotated[float, Gt(0)]
    soil: SoilParameters


def geostatic_stress(ground: Ground, height: np.ndarray, vertical: int) -> np.ndarray:
    """Return the initial Cauchy stress (n, 3, 3) in Pa at ``height`` (n,) in m.

    Zero above the surface.

    ``vertical`` is the index of the vertical axis; sigma_v = unit_weight * z, sigma_h = K0 sigma_v.
    """
    vertical_stress = ground.unit_weight * np.minimum(height, 0.0)
    stress = np.zeros((len(height), 3, 3))
    for axis in range(3):
        stress[:, axis, axis] = vertical_stress * (1.0 if axis == vertical else ground.k0)
    return stress


def undrained_shear_strength(ground: Ground, height: np.ndarray) -> np.ndarray:
    """Return the undrained shear strength (n,) in Pa of the ground at ``height``, zero if none."""
    soil = ground.soil
    if not isinstance(soil, UndrainedClay):
        return np.zeros(len(height))
    depth = np.maximum(-height, 0.0)
    return soil.undrained_shear_strength + soil.undrained_shear_strength_gradient * depth
