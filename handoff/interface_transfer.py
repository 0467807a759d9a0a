"""Transfer of interface tractions along the parts of the pile, base by x and shaft by height.

What is carried over is the difference from the geostatic traction, by its integral along the part:
the integral up to a place is interpolated without overshoot, and each target takes its mean over
the piece of surface it stands for.  The resultant of a part is kept, and undisturbed ground comes
out exactly.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import PchipInterpolator

from handoff.geostatic import geostatic_traction
from install_mpm.conventions import Kinematics
from install_mpm.ground import GroundProfile
from install_mpm.interface import InterfacePoints
from install_mpm.pile import WHOLE_PILE, PilePart, surface_normals, tangent_of

COORDINATE = {PilePart.BASE: 0, PilePart.SHAFT: 1}
"""Axis along which each part runs; both parts begin at its smallest value."""


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


def pile_forces(
    traction: np.ndarray,
    normals: np.ndarray,
    areas: np.ndarray,
    parts: np.ndarray,
    kinematics: Kinematics = Kinematics.PLANE_STRAIN,
) -> dict[PilePart, float]:
    """Return the upward soil reaction in N on each part of the *whole* pile.

    Of a wall in plane strain it is per metre run.
    """
    upward_on_soil = traction[:, 0] * tangent_of(normals)[:, 1] + traction[:, 1] * normals[:, 1]
    return {
        part: -WHOLE_PILE[kinematics] * float((upward_on_soil * areas)[parts == part].sum())
        for part in PilePart
    }


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
