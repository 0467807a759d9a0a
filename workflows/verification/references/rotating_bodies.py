"""Torque on rigid bodies of revolution that turn in soil and slip along all of their surface."""

from __future__ import annotations

import numpy as np


def shaft_torque(*, radius: float, length: float, shear_strength: float) -> float:
    """Return T = 2 pi a^2 L tau of a shaft, in N m; a and L in m, tau in Pa."""
    return 2.0 * np.pi * radius**2 * length * shear_strength


def disc_torque(*, radius: float, thickness: float, shear_strength: float) -> float:
    """Return T = 4 pi / 3 tau R^3 + 2 pi R^2 t tau of both faces and the rim of a disc, in N m.

    R and t in m, tau in Pa.
    """
    faces = 4.0 * np.pi / 3.0 * radius**3 * shear_strength
    return faces + 2.0 * np.pi * radius**2 * thickness * shear_strength
