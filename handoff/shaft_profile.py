"""Tractions along the shaft of a screw pile in both models: means around it, level by level.

A level takes its mean with a weight that falls linearly to zero at the next ones: points of the two
models lie at different heights, and in bands with sharp ends a ring of points would count or not.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from handoff.fe_state_file import FEInterfacePoints
from install_mpm.interface import InterfacePoints

AROUND, DOWNWARD, NORMAL = range(3)
"""Components of the traction on the soil at the shaft; the normal one is positive in tension."""
LEAST_COVERED = 0.25
"""Share of a level that soil must cover; the mean over less tells of single points."""


class ShaftProfiles(NamedTuple):
    """Means of the traction on the soil, from the tip upward; levels without soil are left out."""

    height: np.ndarray
    """z (n_levels,) in m of each level."""
    material_points: np.ndarray
    """(n_levels, 3) in Pa."""
    finite_elements: np.ndarray
    """(n_levels, 3) in Pa."""


def shaft_profiles(
    points: InterfacePoints,
    places: FEInterfacePoints,
    traction: np.ndarray,
    shaft: int,
    size_at_pile: float,
) -> ShaftProfiles:
    """Return the tractions along the ``shaft``, a number of a part of the pile, in both models.

    ``points`` are those of the installation, ``places`` and ``traction`` (n_i, 3) in Pa those of
    the finite elements.  Levels are an element of the shaft apart: twice ``size_at_pile``, in m.
    """
    here, there = points.part == shaft, places.part == shaft
    height, top = points.position[here, 2], places.position[there, 2]
    low, high = top.min(), top.max()
    n_gaps = max(2, round((high - low) / (2.0 * size_at_pile)))
    levels = np.linspace(low, high, n_gaps + 1)
    beside_soil = points.area[here] * points.covered[here]
    before, covered = _means(height, beside_soil, points.traction[here], levels)
    after, area = _means(top, places.area[there], traction[there], levels)
    has_soil = covered > LEAST_COVERED * area
    return ShaftProfiles(levels[has_soil], before[has_soil], after[has_soil])


def profile_differences(profiles: ShaftProfiles) -> tuple[float, float]:
    """Return the relative L2 difference of contact pressure, and of shear, of the two models."""
    pressure, shear = slice(NORMAL, None), slice(NORMAL)
    return (
        _difference(profiles.finite_elements[:, pressure], profiles.material_points[:, pressure]),
        _difference(profiles.finite_elements[:, shear], profiles.material_points[:, shear]),
    )


def _means(
    height: np.ndarray, area: np.ndarray, traction: np.ndarray, levels: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean traction (n_levels, 3) and the area (n_levels,) of each level."""
    away = np.abs(height - levels[:, None]) / (levels[1] - levels[0])
    weights = np.maximum(1.0 - away, 0.0) * area
    total = weights.sum(axis=1)
    return weights @ traction / np.where(total > 0.0, total, 1.0)[:, None], total


def _difference(values: np.ndarray, expected: np.ndarray) -> float:
    scale = float(np.linalg.norm(expected))
    change = float(np.linalg.norm(values - expected))
    return change / scale if scale else change
