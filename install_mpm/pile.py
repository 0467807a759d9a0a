"""The rigid pile: its shape, its surface with exact normals, and its weight."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Annotated, NamedTuple

import numpy as np
from annotated_types import Ge, Gt

from install_mpm.conventions import WATER_UNIT_WEIGHT, Kinematics, Unit, rotation_matrix


class PilePart(IntEnum):
    """Parts of the pile surface, each with its own exact normal."""

    BASE = 0
    SHAFT = 1


@dataclass(frozen=True)
class Pile:
    """Flat-ended pile of a half model: a wall in plane strain, round in axisymmetry.

    X or r <= half_width, from its tip up through the surface.

    ``embedment`` is the depth of the tip at the start, at which the pile is wished in place.
    """

    half_width: Annotated[float, Unit("m"), Gt(0)]
    embedment: Annotated[float, Unit("m"), Gt(0)]
    unit_weight: Annotated[float, Unit("N/m^3"), Ge(0)]

    @property
    def width(self) -> float:
        """Width of the wall or diameter of the round pile in m."""
        return 2.0 * self.half_width


WHOLE_PILE = {
    Kinematics.PLANE_STRAIN: 2.0, Kinematics.AXISYMMETRIC: 1.0, Kinematics.THREE_D: 1.0
}  # fmt: skip
"""Whole pile over what the forces of a model stand for: half of a wall, or all of another pile.

Histories, curves and reports are for the whole pile.
"""


def surface_normals(part: np.ndarray) -> np.ndarray:
    """Return the exact unit normals (n, 2), from soil to pile, of points on ``part`` (n,)."""
    normals = np.zeros((len(part), 2))
    normals[part == PilePart.BASE] = (0.0, 1.0)
    normals[part == PilePart.SHAFT] = (-1.0, 0.0)
    return normals


def tangent_of(normals: np.ndarray) -> np.ndarray:
    """Return the tangents (n, 2): normals turned by +90 degrees, pointing down on the shaft."""
    return np.column_stack([-normals[:, 1], normals[:, 0]])


def buried_weight(
    pile: Pile,
    tip_depth: float,
    kinematics: Kinematics = Kinematics.PLANE_STRAIN,
    water_table: float | None = None,
) -> float:
    """Return the weight in N below the surface: of the half wall per metre run, or all of the pile.

    The latter in axisymmetry, where forces are those of the whole pile.  What is below the depth
    ``water_table`` in m, if there is one, weighs less by the water it displaces, because stresses
    are then those in excess of the hydrostatic pressure.
    """
    is_round = kinematics == Kinematics.AXISYMMETRIC
    area = np.pi * pile.half_width**2 if is_round else pile.half_width
    wet = 0.0 if water_table is None else max(tip_depth - water_table, 0.0)
    return float(area) * (pile.unit_weight * tip_depth - WATER_UNIT_WEIGHT * wet)


class PileMotion(NamedTuple):
    """Rigid motion of the pile in a step: a rotation about origin or z axis, and a translation."""

    translation: np.ndarray
    """(dim,) in m."""
    rotation: float = 0.0
    """In rad, see ``conventions.rotation_matrix``."""


def rigid_displacement(motion: PileMotion, position: np.ndarray) -> np.ndarray:
    """Return the displacement (n, dim) in m of points of the pile at ``position`` (n, dim)."""
    dim = position.shape[1]
    turn = rotation_matrix(motion.rotation, dim) - np.eye(dim)
    displacement: np.ndarray = position @ turn.T + motion.translation
    return displacement
