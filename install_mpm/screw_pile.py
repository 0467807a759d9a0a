"""The screw pile: its shape, the parts of its surface and their exact normals.

Everything here is in the pile frame: the pile axis is the z axis, and z is that of the pile at its
starting depth.  A helix of hand h (+1 right, -1 left) winds upward from its leading edge at the
polar angle 0; the winding angle is w = h * polar angle >= 0, counted through all turns, and the
middle of the plate lies at

    z(w) = z_leading + pitch w / (2 pi) .
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from annotated_types import Ge, Gt, Le, Lt

from install_mpm.conventions import Unit

Length = Annotated[float, Unit("m"), Gt(0)]


@dataclass(frozen=True)
class Helix:
    """One helical plate, welded to the shaft."""

    diameter: Length
    pitch: Length
    """Rise of the plate in a turn."""
    thickness: Length
    height: Annotated[float, Unit("m"), Ge(0)]
    """Of the middle of the leading edge above the pile tip."""
    turns: Annotated[float, Gt(0), Le(4)] = 1.0
    edge_thickness: Annotated[float | None, Unit("m"), Gt(0)] = None
    """At the leading and trailing edge; by default that of the plate (blunt edges)."""
    taper_angle: Annotated[float, Unit("rad"), Gt(0), Lt(3.2)] = 1.0
    """Winding angle over which the plate thins towards an edge of another thickness."""

    @property
    def winding(self) -> float:
        """Winding angle in rad of the trailing edge."""
        return 2.0 * np.pi * self.turns

    @property
    def radius(self) -> float:
        """Outer radius in m."""
        return self.diameter / 2.0


@dataclass(frozen=True)
class ScrewPile:
    """Rigid tubular shaft, closed at the tip, with one or several helices.

    ``embedment`` is the depth of the tip at the start, at which the pile is wished in place.
    """

    shaft_diameter: Length
    embedment: Length
    helices: tuple[Helix, ...]
    unit_weight: Annotated[float, Unit("N/m^3"), Ge(0)]
    """Of the space inside the pile surface."""
    tip_length: Annotated[float, Unit("m"), Ge(0)] = 0.0
    """Length of a conical tip; zero: flat."""
    hand: Literal["right", "left"] = "right"
    model: Literal["screw_pile"] = "screw_pile"

    @property
    def shaft_radius(self) -> float:
        """Radius of the shaft in m."""
        return self.shaft_diameter / 2.0

    @property
    def width(self) -> float:
        """Diameter in m of the largest plate, or of the shaft."""
        return max([self.shaft_diameter, *(helix.diameter for helix in self.helices)])

    @property
    def sense(self) -> float:
        """Hand of the helices: +1 right, -1 left."""
        return 1.0 if self.hand == "right" else -1.0

    @property
    def highest_plate(self) -> float:
        """Height in m of the top of the uppermost helix above the tip."""
        return max(
            (h.height + h.pitch * h.turns + h.thickness / 2.0 for h in self.helices), default=0.0
        )

    def leading_level(self, helix: Helix) -> float:
        """Return z in m of the middle of the leading edge at the start."""
        return -self.embedment + helix.height


FLAT_TIP, CONE, SHAFT = 0, 1, 2
LOWER_FACE, UPPER_FACE, RIM, LEADING_EDGE, TRAILING_EDGE = range(5)
PARTS_OF_PILE = ("tip", "cone", "shaft")
PARTS_OF_HELIX = ("lower face", "upper face", "rim", "leading edge", "trailing edge")


def part_names(pile: ScrewPile) -> tuple[str, ...]:
    """Return the names of the parts of the surface, in the order of their numbers."""
    several = len(pile.helices) > 1
    names = list(PARTS_OF_PILE)
    for n in range(len(pile.helices)):
        prefix = f"helix {n + 1} " if several else ""
        names += [prefix + part for part in PARTS_OF_HELIX]
    return tuple(names)


def first_part(helix_index: int) -> int:
    """Return the number of the first part, the lower face, of a helix."""
    return len(PARTS_OF_PILE) + helix_index * len(PARTS_OF_HELIX)


def edge_parts(pile: ScrewPile) -> list[int]:
    """Return the numbers of the leading and trailing edges: they cut through the soil."""
    return [
        first_part(n) + edge
        for n in range(len(pile.helices))
        for edge in (LEADING_EDGE, TRAILING_EDGE)
    ]


def winding_angle(pile: ScrewPile, helix: Helix, points: np.ndarray) -> np.ndarray:
    """Return the winding angle (n,) in rad of ``points`` (n, 3): of the turn nearest in height."""
    angle = np.mod(pile.sense * np.arctan2(points[:, 1], points[:, 0]), 2.0 * np.pi)
    rise = points[:, 2] - pile.leading_level(helix)
    turn = np.round(rise / helix.pitch - angle / (2.0 * np.pi))
    last = np.ceil(helix.turns)
    winding: np.ndarray = angle + 2.0 * np.pi * np.clip(turn, -1.0, last)
    return winding


def thickness_at(helix: Helix, winding: np.ndarray) -> np.ndarray:
    """Return the plate thickness (n,) in m at winding angles (n,)."""
    if helix.edge_thickness is None:
        return np.full_like(winding, helix.thickness)
    to_edge = np.minimum(winding, helix.winding - winding)
    share = np.clip(to_edge / helix.taper_angle, 0.0, 1.0)
    thickness: np.ndarray = helix.edge_thickness + share * (helix.thickness - helix.edge_thickness)
    return thickness


def _thickness_slope(helix: Helix, winding: np.ndarray) -> np.ndarray:
    """Return d thickness / d winding (n,) in m."""
    if helix.edge_thickness is None:
        return np.zeros_like(winding)
    slope = (helix.thickness - helix.edge_thickness) / helix.taper_angle
    grows, falls = winding < helix.taper_angle, helix.winding - winding < helix.taper_angle
    result: np.ndarray = slope * (grows.astype(float) - falls)
    return result


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
    """Return the distances (n,) in m from lower and upper face, rim, leading and trailing edge."""
    winding = winding_angle(pile, helix, points)
    middle = pile.leading_level(helix) + helix.pitch * winding / (2.0 * np.pi)
    half = thickness_at(helix, winding) / 2.0
    rise = points[:, 2] - middle
    beyond = np.maximum(np.maximum(-winding, winding - helix.winding), 0.0) * radius
    inside = np.maximum(pile.shaft_radius - radius, 0.0)
    off_plate = np.maximum(np.abs(rise) - half, 0.0)
    return [
        np.abs(rise + half) + beyond + inside,
        np.abs(rise - half) + beyond + inside,
        np.abs(radius - helix.radius) + off_plate + beyond,
        *(
            _distance_to_edge(pile, helix, points, radius, angle) + inside
            for angle in (0.0, helix.winding)
        ),
    ]


def _distance_to_edge(
    pile: ScrewPile, helix: Helix, points: np.ndarray, radius: np.ndarray, winding: float
) -> np.ndarray:
    """Return the distance (n,) in m from the end of a plate, in the plane of the axis."""
    polar = pile.sense * winding
    across = points[:, 1] * np.cos(polar) - points[:, 0] * np.sin(polar)
    along = points[:, 0] * np.cos(polar) + points[:, 1] * np.sin(polar)
    level = pile.leading_level(helix) + helix.pitch * winding / (2.0 * np.pi)
    half = float(thickness_at(helix, np.array([winding]))[0]) / 2.0
    off_level = np.maximum(np.abs(points[:, 2] - level) - half, 0.0)
    behind = np.where(along < 0.0, radius, 0.0)
    distance: np.ndarray = np.abs(across) + off_level + behind
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
        of_part[first + LEADING_EDGE] = pile.sense * around
        of_part[first + TRAILING_EDGE] = -pile.sense * around
    normals = np.empty_like(points)
    for number, field in of_part.items():
        normals[part == number] = field[part == number]
    return normals
