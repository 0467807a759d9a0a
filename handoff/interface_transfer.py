"""Transfer of interface tractions along the parts of a flat-ended pile, base by x, shaft by height.

What is carried over is the difference from the geostatic traction, by its integral along the part:
the integral up to a place is interpolated without overshoot, and each target takes its mean over
the piece of surface it stands for.  The resultant of a part is kept, and undisturbed ground comes
out exactly.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from handoff.geostatic import geostatic_traction
from install_mpm.ground import GroundProfile
from install_mpm.interface import InterfacePoints
from install_mpm.interface_axes import axes_of
from install_mpm.pile import PilePart, surface_normals

COORDINATE = {PilePart.BASE: 0, PilePart.SHAFT: 1}
"""Axis along which each part runs; both parts begin at its smallest value."""


class FESurface(NamedTuple):
    """Integration points of the interface of a finite-element model."""

    positions: np.ndarray
    """(n_i, dim) in m."""
    normals: np.ndarray
    """Exact unit normals (n_i, dim) from soil to pile."""
    facet_normals: np.ndarray
    """Unit normals (n_i, dim) of the facets."""
    areas: np.ndarray
    """Integration weights (n_i,) in m^2, of a wall per metre run."""
    parts: np.ndarray
    """Part of the pile (n_i,) int64."""


def transferred_traction(
    ground: GroundProfile,
    points: InterfacePoints,
    targets: np.ndarray,
    target_areas: np.ndarray,
    target_parts: np.ndarray,
) -> np.ndarray:
    """Return the tractions (n, 2) in Pa, (tangential, normal), at ``targets`` (n, 2).

    Points without soil beside them (not active) take the difference of their active neighbours.

    Raises
    ------
    ValueError
        If a part of the pile has no active interface point.
    """
    source_geostatic = geostatic_traction(ground, points.position, points.normal)
    difference = points.traction - source_geostatic
    traction = geostatic_traction(ground, targets, surface_normals(target_parts))
    for part, axis in COORDINATE.items():
        here, there = points.part == part, target_parts == part
        active = here & (points.covered > 0.0)
        if not active.any():
            raise ValueError(
                f"no soil touches the {part.name.lower()} of the installed pile;"
                " look at the interface points of the installed state"
            )
        for component in range(2):
            filled = _filled(points.position[:, axis], difference[:, component], here, active)
            traction[there, component] += _remapped(
                points.position[here, axis],
                points.area[here],
                filled,
                targets[there, axis],
                target_areas[there],
            )
    return traction


def forces_on_pile(
    traction: np.ndarray, normals: np.ndarray, areas: np.ndarray, positions: np.ndarray
) -> np.ndarray:
    """Return the forces (n, dim) in N of the soil on the pile at all points of its surface."""
    on_soil = np.einsum("nki,nk->ni", axes_of(normals, positions), traction)
    forces: np.ndarray = -on_soil * areas[:, None]
    return forces


def part_forces(forces: np.ndarray, parts: np.ndarray, n_parts: int) -> np.ndarray:
    """Return the sum (n_parts, dim) in N of ``forces`` (n, dim) on each part of the pile."""
    return np.stack([np.bincount(parts, force, n_parts) for force in forces.T], axis=1)


def _filled(
    place: np.ndarray, values: np.ndarray, here: np.ndarray, active: np.ndarray
) -> np.ndarray:
    """Return ``values`` of the points ``here``, interpolated from the active ones."""
    order = np.flatnonzero(active)[np.argsort(place[active], kind="stable")]
    filled: np.ndarray = np.interp(place[here], place[order], values[order])
    return filled


def _remapped(
    place: np.ndarray,
    areas: np.ndarray,
    values: np.ndarray,
    target_place: np.ndarray,
    target_areas: np.ndarray,
) -> np.ndarray:
    """Return the means of ``values`` over the pieces of surface of the targets."""
    order, target_order = np.argsort(place, kind="stable"), np.argsort(target_place, kind="stable")
    ends = np.concatenate([[0.0], np.cumsum(areas[order])])
    integral = np.concatenate([[0.0], np.cumsum(areas[order] * values[order])])
    target_ends = np.concatenate([[0.0], np.cumsum(target_areas[target_order])])
    inside = np.minimum(target_ends, ends[-1])
    beyond = (target_ends - inside) * values[order[-1]]
    means = np.empty(len(target_place))
    means[target_order] = np.diff(PchipInterpolator(ends, integral)(inside) + beyond) / np.diff(
        target_ends
    )
    return means
