"""Tractions along the shaft of a screw pile in both models: means around it, in bands of depth."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from handoff.fe_state_file import FEInterfacePoints
from install_mpm.interface import InterfacePoints

AROUND, DOWNWARD, NORMAL = range(3)
"""Components of the traction on the soil at the shaft; the normal one is positive in tension."""
SPIKE = 0.25
"""Share of a band that soil must cover; the mean over less tells of single points."""


class ShaftProfiles(NamedTuple):
    """Means of the traction on the soil, from the tip upward; bands without soil are left out."""

    height: np.ndarray
    """Middle (n_bands,) of each band, z in m."""
    material_points: np.ndarray
    """(n_bands, 3) in Pa."""
    finite_elements: np.ndarray
    """(n_bands, 3) in Pa."""


def shaft_profiles(
    points: InterfacePoints,
    places: FEInterfacePoints,
    traction: np.ndarray,
    shaft: int,
    size: float,
) -> ShaftProfiles:
    """Return the tractions along the ``shaft``, a number of a part of the pile, in both models.

    ``points`` are those of the installation, ``places`` and ``traction`` (n_i, 3) in Pa those of
    the finite elements.  Bands are about ``size`` high, in m.
    """
    here, there = points.part == shaft, places.part == shaft
    height, top = points.position[here, 2], places.position[there, 2]
    low, high = top.min(), top.max()
    edges = np.linspace(low, high, max(2, round((high - low) / size)) + 1)
    beside_soil = points.area[here] * points.covered[here]
    before, covered = _means(height, beside_soil, points.traction[here], edges)
    after, area = _means(top, places.area[there], traction[there], edges)
    has_soil = covered > SPIKE * area
    middle = 0.5 * (edges[1:] + edges[:-1])
    return ShaftProfiles(middle[has_soil], before[has_soil], after[has_soil])


def profile_differences(profiles: ShaftProfiles) -> tuple[float, float]:
    """Return the relative L2 difference of contact pressure, and of shear, of the two models."""
    pressure, shear = slice(NORMAL, None), slice(NORMAL)
    return (
        _difference(profiles.finite_elements[:, pressure], profiles.material_points[:, pressure]),
        _difference(profiles.finite_elements[:, shear], profiles.material_points[:, shear]),
    )


def _means(
    height: np.ndarray, area: np.ndarray, traction: np.ndarray, edges: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean traction (n_bands, 3) and the area (n_bands,) of each band."""
    n_bands = len(edges) - 1
    band = np.clip(np.searchsorted(edges, height) - 1, 0, n_bands - 1)
    total = np.bincount(band, area, n_bands)
    force = np.stack([np.bincount(band, area * part, n_bands) for part in traction.T], axis=1)
    return force / np.where(total > 0.0, total, 1.0)[:, None], total


def _difference(values: np.ndarray, expected: np.ndarray) -> float:
    scale = float(np.linalg.norm(expected))
    change = float(np.linalg.norm(values - expected))
    return change / scale if scale else change
