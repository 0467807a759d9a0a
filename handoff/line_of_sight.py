"""Which material points a place in the ground sees: the pile hides those behind it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm._jit import jit
from install_mpm.screw_pile import ScrewPile

SLACK = 0.02
"""Depth, over the half-width, to which the edges of a flat-ended pile are transparent."""

CORE = 0.7
"""Share of shaft radius and plate thickness that hides: the facets of a mesh cut into the rest."""

CORE_OF_PLATE = 0.9
"""Share of the radius of a plate that hides."""

N_WALL = 2
"""Entries of a flat-ended pile as an obstacle."""

ROTATION, SENSE, SHAFT_RADIUS, TIP_HEIGHT, SPACING, N_SHAFT = range(6)
PLATE_RADIUS, PITCH, THICKNESS, LEADING_LEVEL, WINDING, N_PLATE = range(6)
"""Entries of a screw pile as an obstacle: those of the shaft, then those of each plate."""


class Obstacle(NamedTuple):
    """The pile, x < half_width and z > tip_height, which hides points from each other."""

    half_width: float
    tip_height: float


NO_OBSTACLE = Obstacle(-1e9, 1e9)


def screw_obstacle(pile: ScrewPile, rotation: float) -> np.ndarray:
    """Return the obstacle that is a screw pile with its tip at ``embedment``, turned in rad."""
    thickness = min([CORE * helix.thickness for helix in pile.helices], default=pile.shaft_radius)
    shaft = [rotation, pile.sense, CORE * pile.shaft_radius, -pile.embedment, 0.5 * thickness]
    plates = [
        [
            CORE_OF_PLATE * helix.radius, helix.pitch, CORE * helix.thickness,
            pile.leading_level(helix), helix.winding,
        ]
        for helix in pile.helices
    ]  # fmt: skip
    return np.array(shaft + [value for plate in plates for value in plate])


@jit
def hides(obstacle: np.ndarray, start: np.ndarray, end: np.ndarray) -> bool:
    """Return whether the straight line between two places passes through the obstacle."""
    if obstacle.shape[0] == N_WALL:
        return is_hidden_by_wall(start, end, obstacle)
    return is_hidden_by_screw_pile(start, end, obstacle)


@jit
def is_hidden_by_wall(start: np.ndarray, end: np.ndarray, corner: np.ndarray) -> bool:
    """Return whether the straight line between two places passes through the pile.

    ``corner`` holds half-width and tip height of the pile, x < half_width, z > tip_height; its
    edges are transparent to a depth of ``SLACK`` half-widths.  Line x(t) = start + t (end - start).
    """
    slack = SLACK * corner[0]
    enter, leave = 0.0, 1.0
    for axis in range(2):
        # inside the half-plane: distance_start + t (distance_end - distance_start) > 0
        sign = -1.0 if axis == 0 else 1.0
        distance_start = sign * (start[axis] - corner[axis]) - slack
        distance_end = sign * (end[axis] - corner[axis]) - slack
        if distance_start <= 0.0 and distance_end <= 0.0:
            return False
        if distance_start <= 0.0:
            enter = max(enter, distance_start / (distance_start - distance_end))
        elif distance_end <= 0.0:
            leave = min(leave, distance_start / (distance_start - distance_end))
    return enter < leave


@jit
def is_hidden_by_screw_pile(start: np.ndarray, end: np.ndarray, obstacle: np.ndarray) -> bool:
    """Return whether the straight line between two places passes through the core of a screw pile.

    Places on the line are looked at, so densely that a plate cannot be missed.
    """
    reach = obstacle[SHAFT_RADIUS]
    for first in range(N_SHAFT, obstacle.shape[0], N_PLATE):
        reach = max(reach, obstacle[first + PLATE_RADIUS])
    along = end - start
    in_plan = along[0] ** 2 + along[1] ** 2
    nearest = 0.0
    if in_plan > 0.0:
        nearest = min(max(-(start[0] * along[0] + start[1] * along[1]) / in_plan, 0.0), 1.0)
    closest = np.hypot(start[0] + nearest * along[0], start[1] + nearest * along[1])
    if closest > reach or max(start[2], end[2]) < obstacle[TIP_HEIGHT]:
        return False
    count = int(np.sqrt((along**2).sum()) / obstacle[SPACING]) + 1
    for step in range(1, count):
        if is_inside_screw_pile(start + step / count * along, obstacle):
            return True
    return False


@jit
def is_inside_screw_pile(place: np.ndarray, obstacle: np.ndarray) -> bool:
    """Return whether ``place`` (3,) lies in the core of the pile."""
    radius = np.hypot(place[0], place[1])
    if radius < obstacle[SHAFT_RADIUS] and place[2] > obstacle[TIP_HEIGHT]:
        return True
    polar = np.arctan2(place[1], place[0]) - obstacle[ROTATION]
    angle = np.mod(obstacle[SENSE] * polar, 2.0 * np.pi)
    for first in range(N_SHAFT, obstacle.shape[0], N_PLATE):
        pitch, winding = obstacle[first + PITCH], obstacle[first + WINDING]
        rise = place[2] - obstacle[first + LEADING_LEVEL]
        turn = np.round(rise / pitch - angle / (2.0 * np.pi))
        wound = angle + 2.0 * np.pi * turn
        off_middle = abs(rise - pitch * wound / (2.0 * np.pi))
        if (
            radius < obstacle[first + PLATE_RADIUS]
            and 0.0 <= wound <= winding
            and off_middle < 0.5 * obstacle[first + THICKNESS]
        ):
            return True
    return False
