"""The screw pile: its shape and the parts of its surface.

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
    edges: Literal["blunt", "rounded"] = "blunt"
    """Rounded: leading and trailing edge end in half a circle as wide as the plate is thick there.
    """
    plate: Literal["solid", "surface"] = "solid"
    """Surface: the mesh holds the plate without its thickness, and what soil resists at its edges
    and rim is stated by hand beside the torque.
    """
    edge_bearing: Annotated[float, Ge(0), Le(20)] = 7.0
    """Of a plate held as a surface: resistance of leading and trailing edge over su, thickness and
    length of the edge; the edges of thick plates had 6 to 8.
    """

    @property
    def is_surface(self) -> bool:
        """Whether the mesh holds the plate without its thickness."""
        return self.plate == "surface"

    @property
    def meshed_thickness(self) -> float:
        """Thickness in m that the mesh leaves out: none of a plate held as a surface."""
        return 0.0 if self.is_surface else self.thickness

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
    """Return the thickness (n,) in m that the mesh leaves out at winding angles (n,)."""
    if helix.edge_thickness is None:
        return np.full_like(winding, helix.meshed_thickness)
    to_edge = np.minimum(winding, helix.winding - winding)
    share = np.clip(to_edge / helix.taper_angle, 0.0, 1.0)
    thickness: np.ndarray = helix.edge_thickness + share * (helix.thickness - helix.edge_thickness)
    return thickness


def edge_thickness(helix: Helix) -> float:
    """Return the thickness in m that the mesh leaves out at the edges of the plate."""
    return helix.meshed_thickness if helix.edge_thickness is None else helix.edge_thickness
