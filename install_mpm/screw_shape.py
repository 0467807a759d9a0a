"""The surface of a screw pile: distances of places from its parts, and exact normals.

Everything is in the pile frame, see ``screw_pile``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm.screw_pile import (
    CONE,
    FLAT_TIP,
    LEADING_EDGE,
    LOWER_FACE,
    RIM,
    SHAFT,
    TRAILING_EDGE,
    UPPER_FACE,
    Helix,
    ScrewPile,
    edge_thickness,
    first_part,
    thickness_at,
    winding_angle,
)

ENDS = (-1, 1)
"""The leading and the trailing edge: against and along the way the plate winds."""


def _thickness_slope(helix: Helix, winding: np.ndarray) -> np.ndarray:
    """Return d thickness / d winding (n,) in m."""
    if helix.edge_thickness is None:
        return np.zeros_like(winding)
    slope = (helix.thickness - helix.edge_thickness) / helix.taper_angle
    grows, falls = winding < helix.taper_angle, helix.winding - winding < helix.taper_angle
    result: np.ndarray = slope * (grows.astype(float) - falls)
    return result


class EdgePlace(NamedTuple):
    """Places in the axes of a leading or trailing edge, each (n,) in m."""

    along: np.ndarray
    """The edge, from the pile axis outward."""
    ahead: np.ndarray
    """Horizontal distance beyond the end of the plate, square to the edge."""
    rise: np.ndarray
    """Above the middle surface of the plate, straight on with the climb that it has at its end."""

    @property
    def is_ahead(self) -> np.ndarray:
        """Whether a place lies beyond the end, on its side of the pile axis, (n,) bool."""
        result: np.ndarray = (self.ahead > 0.0) & (self.along > 0.0)
        return result


def edge_place(pile: ScrewPile, helix: Helix, points: np.ndarray, end: int) -> EdgePlace:
    """Return ``points`` (n, 3) in the axes of the leading (``end`` -1) or trailing (+1) edge."""
    winding = helix.winding if end > 0 else 0.0
    outward, onward = _edge_axes(pile, winding)
    along, across = points @ outward, points @ onward
    level = pile.leading_level(helix) + helix.pitch * winding / (2.0 * np.pi)
    climb = helix.pitch / (2.0 * np.pi * np.where(along > 0.0, along, np.inf))
    return EdgePlace(along, end * across, points[:, 2] - level - climb * across)


def distance_to_noses(pile: ScrewPile, helix: Helix, points: np.ndarray) -> np.ndarray:
    """Return the distance (n,) in m of ``points`` (n, 3) from the nearest rounded edge.

    It is negative inside the nose, and goes on beyond rim and axis.
    """
    half, nearest = edge_thickness(helix) / 2.0, np.full(len(points), np.inf)
    for end in ENDS:
        edge = edge_place(pile, helix, points, end)
        off_nose = np.where(edge.is_ahead, np.hypot(edge.ahead, edge.rise) - half, np.inf)
        nearest = np.minimum(nearest, off_nose)
    return nearest


def _edge_axes(pile: ScrewPile, winding: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the unit vectors (3,) outward along an edge, and square to it as the plate winds."""
    polar = pile.sense * winding
    outward = np.array([np.cos(polar), np.sin(polar), 0.0])
    return outward, pile.sense * np.array([-np.sin(polar), np.cos(polar), 0.0])


def _edge_normals(pile: ScrewPile, helix: Helix, points: np.ndarray, end: int) -> np.ndarray:
    """Return the normals (n, 3), from soil to pile, of an edge: of a plane or of its nose.

    The nose is the surface ahead^2 + rise^2 = (thickness / 2)^2; its gradient is the normal.  Faces
    of a plate without taper go over into it without a corner.
    """
    winding = helix.winding if end > 0 else 0.0
    outward, onward = _edge_axes(pile, winding)
    if helix.edges == "blunt":
        return np.tile(-end * onward, (len(points), 1))
    edge = edge_place(pile, helix, points, end)
    along = np.maximum(edge.along, 1e-12)
    climb = helix.pitch / (2.0 * np.pi * along)
    gradient = end * edge.ahead[:, None] * onward + edge.rise[:, None] * (
        np.array([0.0, 0.0, 1.0])
        - climb[:, None] * onward
        + (climb * end * edge.ahead / along)[:, None] * outward
    )
    length = np.maximum(np.linalg.norm(gradient, axis=1), 1e-300)
    normals: np.ndarray = -gradient / length[:, None]
    return normals


def distance_to_parts(pile: ScrewPile, points: np.ndarray) -> np.ndarray:
    """Return the distance (n, n_parts) in m of ``points`` (n, 3) from the surface of each part.

    Measured across the surface, as if the surface went on beyond its ends.
    """
    radius = np.linalg.norm(points[:, :2], axis=1)
    above_tip = points[:, 2] + pile.embedment
    columns = [
        np.abs(above_tip) if pile.tip_length == 0.0 else np.full(len(points), np.inf),
        _distance_to_cone(pile, radius, above_tip),
        np.abs(radius - pile.shaft_radius) + np.maximum(pile.tip_length - above_tip, 0.0),
    ]
    for helix in pile.helices:
        columns += _distance_to_helix(pile, helix, points, radius)
    return np.stack(columns, axis=1)


def distance_to_plates(pile: ScrewPile, points: np.ndarray) -> np.ndarray:
    """Return the distance (n,) in m of ``points`` (n, 3) from the nearest plate.

    It is measured to the height of the plate at the winding angle of the point; infinite without a
    plate.
    """
    radius = np.linalg.norm(points[:, :2], axis=1)
    nearest = np.full(len(points), np.inf)
    for helix in pile.helices:
        winding = np.clip(winding_angle(pile, helix, points), 0.0, helix.winding)
        middle = pile.leading_level(helix) + helix.pitch * winding / (2.0 * np.pi)
        off_level = np.maximum(np.abs(points[:, 2] - middle) - helix.thickness / 2.0, 0.0)
        nearest = np.minimum(nearest, np.hypot(np.maximum(radius - helix.radius, 0.0), off_level))
    return nearest


def _distance_to_cone(pile: ScrewPile, radius: np.ndarray, above_tip: np.ndarray) -> np.ndarray:
    if pile.tip_length == 0.0:
        return np.full(len(radius), np.inf)
    slant = np.hypot(pile.tip_length, pile.shaft_radius)
    across = radius * pile.tip_length - above_tip * pile.shaft_radius
    distance: np.ndarray = np.abs(across) / slant
    return distance


def _distance_to_helix(
    pile: ScrewPile, helix: Helix, points: np.ndarray, radius: np.ndarray
) -> list[np.ndarray]:
    """Return the distances (n,) in m from lower and upper face, rim, leading and trailing edge.

    Of a plate held as a surface there are only the faces, at the same place.
    """
    winding = winding_angle(pile, helix, points)
    middle = pile.leading_level(helix) + helix.pitch * winding / (2.0 * np.pi)
    half = thickness_at(helix, winding) / 2.0
    rise = points[:, 2] - middle
    beyond = np.maximum(np.maximum(-winding, winding - helix.winding), 0.0) * radius
    inside = np.maximum(pile.shaft_radius - radius, 0.0)
    faces = [np.abs(rise + side * half) + beyond + inside for side in (1.0, -1.0)]
    if helix.is_surface:
        return [*faces, *(np.full(len(points), np.inf) for _ in (RIM, *ENDS))]
    off_plate = np.maximum(np.abs(rise) - half, 0.0) + beyond
    if helix.edges == "rounded":
        off_nose = np.maximum(distance_to_noses(pile, helix, points), 0.0)
        off_plate = np.minimum(off_plate, off_nose)
    return [
        *faces,
        np.abs(radius - helix.radius) + off_plate,
        *(_distance_to_edge(pile, helix, points, end) + inside for end in ENDS),
    ]


def _distance_to_edge(pile: ScrewPile, helix: Helix, points: np.ndarray, end: int) -> np.ndarray:
    """Return the distance (n,) in m from the end of a plate: a plane at the axis, or a nose."""
    edge, half = edge_place(pile, helix, points, end), edge_thickness(helix) / 2.0
    radius = np.linalg.norm(points[:, :2], axis=1)
    distance: np.ndarray
    if helix.edges == "rounded":
        behind = np.where(edge.along > 0.0, np.maximum(-edge.ahead, 0.0), radius)
        distance = np.abs(np.hypot(edge.ahead, edge.rise) - half) + behind
    else:
        off_level = np.maximum(np.abs(edge.rise) - half, 0.0)
        distance = np.abs(edge.ahead) + off_level + np.where(edge.along < 0.0, radius, 0.0)
    return distance


def surface_normals(pile: ScrewPile, part: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return the exact unit normals (n, 3), from soil to pile, of ``points`` (n, 3) on ``part``."""
    radius = np.linalg.norm(points[:, :2], axis=1)
    away = np.zeros_like(points)
    away[:, :2] = points[:, :2] / np.where(radius > 0.0, radius, 1.0)[:, None]
    around = np.column_stack([-away[:, 1], away[:, 0], np.zeros(len(points))])
    up = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    slant = np.hypot(pile.tip_length, pile.shaft_radius)
    of_part = {
        FLAT_TIP: up,
        CONE: (pile.shaft_radius * up - pile.tip_length * away) / slant,
        SHAFT: -away,
    }
    for index, helix in enumerate(pile.helices):
        first, winding = first_part(index), winding_angle(pile, helix, points)
        climb = helix.pitch / (2.0 * np.pi)
        slope = _thickness_slope(helix, winding) / 2.0
        for face, sign, rise in (
            (LOWER_FACE, 1.0, climb - slope),
            (UPPER_FACE, -1.0, climb + slope),
        ):
            gradient = up - (pile.sense * rise / np.maximum(radius, 1e-12))[:, None] * around
            of_part[first + face] = sign * gradient / np.linalg.norm(gradient, axis=1)[:, None]
        of_part[first + RIM] = -away
        for edge, end in zip((LEADING_EDGE, TRAILING_EDGE), ENDS, strict=True):
            of_part[first + edge] = _edge_normals(pile, helix, points, end)
    normals = np.empty_like(points)
    for number, field in of_part.items():
        normals[part == number] = field[part == number]
    return normals
