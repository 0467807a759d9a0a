"""The ground surface after the installation, from the displacements of the material points.

Local regression (loess) of the vertical displacement of the points that started near the surface,

    u_z(x, d) = a + b (x - x_s) + c d ,

at stations x_s along the present surface, in space at distances from the axis; d is the depth at
which a point started, so a is the motion of the surface itself rather than of the uppermost points.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm.conventions import Kinematics, dimension
from install_mpm.material_points import MaterialPoints, at_start, point_sizes

LAYER = 3.0
"""Points whose initial depth is less than this many point sizes follow the surface."""
NEIGHBOURS = {2: 30, 3: 120}
"""Points in each local regression by dimension; in space they are taken all around the pile."""
STEEPEST = 1.0
"""Slope (height over length) to which folds and gaps beside the shaft are flattened."""


class SurfaceProfile(NamedTuple):
    """Height of the ground surface, linear between stations and constant outside."""

    x: np.ndarray
    """Stations (n,) in m from the axis, increasing."""
    height: np.ndarray
    """Height (n,) in m above z = 0, positive for heave."""


def level_surface() -> SurfaceProfile:
    """Return the undisturbed surface z = 0."""
    return SurfaceProfile(np.zeros(1), np.zeros(1))


def height_at(surface: SurfaceProfile, x: np.ndarray) -> np.ndarray:
    """Return the height (n,) in m of the surface at ``x`` (n,)."""
    heights: np.ndarray = np.interp(x, surface.x, surface.height)
    return heights


def surface_profile(
    points: MaterialPoints,
    half_width: float,
    station: float,
    kinematics: Kinematics = Kinematics.PLANE_STRAIN,
) -> SurfaceProfile:
    """Return the present surface beside the pile of ``half_width`` m, in pieces of ``station`` m.

    Level, exactly, if no point has moved.  Where the soil has left a gap beside the shaft the
    profile runs on level from the nearest soil; slopes are limited to ``STEEPEST``.

    Raises
    ------
    ValueError
        If no material point started near the surface.
    """
    if not points.displacement.any():
        return level_surface()
    initial_size = point_sizes(at_start(points), kinematics)
    depth = points.displacement[:, -1] - points.position[:, -1]
    radius = _distance_from_axis(points.position)
    top = np.flatnonzero((depth < LAYER * initial_size) & (radius > half_width))
    count = NEIGHBOURS[dimension(kinematics)]
    if len(top) < count:
        raise ValueError(
            f"only {len(top)} material points started near the surface, {count} are needed to"
            " find it; use more material points or smaller cells"
        )
    x = radius[top]
    stations = _stations(x, half_width, station)
    heights = _regressed(stations, x, depth[top], points.displacement[top, -1], count)
    return SurfaceProfile(stations, _flattened(stations, heights))


def _distance_from_axis(positions: np.ndarray) -> np.ndarray:
    """Return x or r (n,) in m, in the plane or in space."""
    if positions.shape[1] == 2:
        return positions[:, 0]
    return np.linalg.norm(positions[:, :2], axis=1)


def _stations(x: np.ndarray, half_width: float, spacing: float) -> np.ndarray:
    """Return even stations from the shaft, or the edge of a gap beside it, to the far end."""
    reach = 0.5 * spacing
    start = half_width if x.min() - half_width < reach else x.min()
    count = max(2, int(np.ceil((x.max() - start) / spacing)) + 1)
    stations: np.ndarray = np.linspace(start, x.max(), count)
    return stations


def _regressed(
    stations: np.ndarray,
    x: np.ndarray,
    depth: np.ndarray,
    displacement: np.ndarray,
    count: int,
) -> np.ndarray:
    """Return the regression (n_stations,) at depth zero, with tricube weights."""
    heights = np.empty(len(stations))
    for index, station in enumerate(stations):
        offset = x - station
        near = np.argsort(np.abs(offset), kind="stable")[:count]
        radius = 1.001 * np.abs(offset[near]).max()
        weights = (1.0 - np.abs(offset[near] / radius) ** 3) ** 3
        terms = np.column_stack([np.ones(count), offset[near] / radius, depth[near] / radius])
        heights[index] = _robust_fit(terms, displacement[near], weights)[0]
    return heights


def _robust_fit(terms: np.ndarray, values: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return least-squares coefficients after two bisquare reweightings (Cleveland 1979)."""
    robustness = np.ones_like(weights)
    coefficients = np.zeros(terms.shape[1])
    for _ in range(3):
        root = np.sqrt(weights * robustness)
        coefficients = np.linalg.lstsq(root[:, None] * terms, root * values, rcond=1e-8)[0]
        residual = np.abs(values - terms @ coefficients)
        scale = 6.0 * np.median(residual) + 1e-12 * np.abs(values).max()
        robustness = (1.0 - np.minimum(residual / scale, 1.0) ** 2) ** 2 if scale > 0.0 else 1.0
    return coefficients


def _flattened(stations: np.ndarray, heights: np.ndarray) -> np.ndarray:
    """Return the heights with slopes limited, working from the far field towards the shaft."""
    limited = heights.copy()
    for index in range(len(stations) - 2, -1, -1):
        reach = STEEPEST * (stations[index + 1] - stations[index])
        limited[index] = np.clip(
            limited[index], limited[index + 1] - reach, limited[index + 1] + reach
        )
    return limited
