"""Axes, signs and units: the one place where they are fixed (docs/conventions.md explains them).

SI without prefix in memory and in files; tension positive; z up with the ground surface at z = 0;
the pile axis is the z axis.  In two dimensions positions are stored as (x, z) or (r, z), so the
vertical is tensor axis 1 and the out-of-plane or hoop direction is always tensor axis 2.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

GRAVITY = 9.81
"""Gravitational acceleration in m/s^2, acting in the negative vertical direction."""

WATER_UNIT_WEIGHT = 1000.0 * GRAVITY
"""Unit weight of water in N/m^3."""


class Kinematics(IntEnum):
    """How nodal displacements make a 3 x 3 gradient."""

    PLANE_STRAIN = 0
    AXISYMMETRIC = 1
    THREE_D = 2


@dataclass(frozen=True)
class Unit:
    """SI unit of a quantity, as metadata of its annotation: ``Annotated[float, Unit("Pa")]``.

    The case reader converts quantity strings to this unit.
    """

    symbol: str


def dimension(kinematics: Kinematics) -> int:
    """Return the number of stored coordinates: 2, or 3 in three dimensions."""
    return 3 if kinematics == Kinematics.THREE_D else 2


def rotation_matrix(angle: float, dim: int) -> np.ndarray:
    """Return the rotation (dim, dim) by ``angle`` in rad.

    Right-handed about +z in space, anticlockwise in the stored axes of two dimensions.
    """
    matrix = np.eye(dim)
    cosine, sine = np.cos(angle), np.sin(angle)
    matrix[:2, :2] = [[cosine, -sine], [sine, cosine]]
    return matrix


def vertical_axis(kinematics: Kinematics) -> int:
    """Return the index of the vertical axis: 1 in two dimensions, 2 in three."""
    return dimension(kinematics) - 1


CONVENTIONS = (
    "units: SI without prefix (m, kg, s, N, Pa, rad)",
    "axes: z up, ground surface z = 0, 2D stored as (x, z), tensor axis 2 out of plane",
    "stress and strain: tension positive",
    "kirchhoff_stress = volume_ratio * cauchy_stress; elastic strain logarithmic",
    "penetration: positive downward; rotation: right-handed about +z",
    "interface: normal from soil to pile, normal_gap > 0 open, slip = pile minus soil",
    "interface traction: acts on the soil from the pile, local order (tangential ..., normal)",
    "six-vectors: Mandel xx, yy, zz, xy, xz, yz, inside constitutive only",
    "arrays: entity axis first, C order, float64 and int64",
)
"""The conventions that a state file depends on; their hash is stored in it."""


def conventions_hash() -> str:
    """Return the hash by which a state file betrays that a convention has changed since."""
    return hashlib.sha256("\n".join(CONVENTIONS).encode()).hexdigest()[:16]
