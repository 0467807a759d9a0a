"""Motion and load of the rigid pile: along x, along z and rotation, each prescribed or loaded.

    u(x, z) = (q_0 - q_2 z, q_1 + q_2 x)

The reference point is the pile's axis at the ground surface; the rotation is positive from x
towards z.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

HORIZONTAL, VERTICAL, ROTATION = range(3)


def rigid_motion(positions: np.ndarray) -> np.ndarray:
    """Return the matrices (n, 2, 3) from rigid motion q (3,) to displacement at ``positions``."""
    motion = np.zeros((len(positions), 2, 3))
    motion[:, 0, HORIZONTAL] = motion[:, 1, VERTICAL] = 1.0
    motion[:, 0, ROTATION] = -positions[:, 1]
    motion[:, 1, ROTATION] = positions[:, 0]
    return motion


class PileControl(NamedTuple):
    """What is imposed on the pile in one step, for (x, z, rotation); all for the modelled half."""

    is_loaded: np.ndarray
    """(3,) bool: the load is given and the motion unknown, or the other way round."""
    motion: np.ndarray
    """Increment of motion (3,) in m, m, rad; used where not loaded."""
    load: np.ndarray
    """Load (3,) in N, N, N m at the end of the step, without the weight; used where loaded."""


def held() -> PileControl:
    """Return the control that keeps the pile where it is."""
    return moved(0.0)


def moved(displacement: float) -> PileControl:
    """Return the control that moves the pile downward by ``displacement`` in m along its axis."""
    return PileControl(np.zeros(3, dtype=bool), np.array([0.0, -displacement, 0.0]), np.zeros(3))


def loaded(head_load: float) -> PileControl:
    """Return the control that brings the downward load on the half to ``head_load`` in N."""
    return PileControl(
        np.array([False, True, False]), np.zeros(3), np.array([0.0, -head_load, 0.0])
    )
