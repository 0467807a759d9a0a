"""The ground surface after the installation, from the displacements of the material points."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class SurfaceProfile(NamedTuple):
    """Height of the ground surface, linear between stations and constant outside."""

    x: np.ndarray
    """Stations (n,) in m, increasing."""
    height: np.ndarray
    """Height (n,) in m above z = 0, positive for heave."""


def level_surface() -> SurfaceProfile:
    """Return the undisturbed surface z = 0."""
    return SurfaceProfile(np.zeros(1), np.zeros(1))


def height_at(surface: SurfaceProfile, x: np.ndarray) -> np.ndarray:
    """Return the height (n,) in m of the surface at ``x`` (n,)."""
    heights: np.ndarray = np.interp(x, surface.x, surface.height)
    return heights
