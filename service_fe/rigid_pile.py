"""Motion and load of the rigid pile: translations and rotations, each prescribed or loaded.

    u(x) = (q_0 - q_2 z, q_1 + q_2 x)            in the plane (x, z)
    u(x) = (q_0, q_1, q_2) + (q_3, q_4, q_5) x x     in space (x, y, z)

The reference point is the pile's axis at the ground surface.  In the plane the rotation is positive
from x towards z, in space rotations are right-handed.  What is imposed may be told in other
components s, such as those of a point of load above the ground: q = F s, and the loads on s are
F^T times those on q.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

PLANES = {2: ((0, 1),), 3: ((1, 2), (2, 0), (0, 1))}
"""Axes of the plane of each rotation, which is positive from the first towards the second."""


def n_motions(dim: int) -> int:
    """Return the number of rigid motions in ``dim`` dimensions: 3 or 6."""
    return dim + len(PLANES[dim])


def rigid_motion(positions: np.ndarray) -> np.ndarray:
    """Return the matrices (n, dim, n_motions) from rigid motion to displacement at ``positions``.

    These are (n, dim) in m.
    """
    dim = positions.shape[1]
    motion = np.zeros((len(positions), dim, n_motions(dim)))
    for axis in range(dim):
        motion[:, axis, axis] = 1.0
    for rotation, (first, second) in enumerate(PLANES[dim], start=dim):
        motion[:, first, rotation] = -positions[:, second]
        motion[:, second, rotation] = positions[:, first]
    return motion


def head_frame(height: float, direction: float) -> np.ndarray:
    """Return F (6, 6) of the motion of a point of the axis ``height`` m above the ground.

    The first horizontal component points in the ``direction``, an angle in rad from x towards y.
    """
    cosine, sine = np.cos(direction), np.sin(direction)
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    frame = np.zeros((6, 6))
    frame[:3, :3] = frame[3:, 3:] = turn
    # turned about a point at p, the origin moves by p x theta
    frame[:3, 3:] = height * np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0] * 3]) @ turn
    return frame


class PileControl(NamedTuple):
    """What is imposed on the modelled part of the pile in one step, in components s."""

    is_loaded: np.ndarray
    """(n_motions,) bool: the load is given and the motion unknown, or the other way round."""
    motion: np.ndarray
    """Increment of motion (n_motions,) in m and rad; used where not loaded."""
    load: np.ndarray
    """Load (n_motions,) in N and N m at the end of the step, without the weight; where loaded."""
    frame: np.ndarray | None = None
    """F (n_motions, n_motions); None: s is q."""


def frame_of(control: PileControl) -> np.ndarray:
    """Return F (n_motions, n_motions) of what is imposed."""
    return np.eye(len(control.motion)) if control.frame is None else control.frame


def held(dim: int = 2) -> PileControl:
    """Return the control that keeps the pile where it is."""
    return moved(0.0, dim)


def moved(displacement: float, dim: int = 2) -> PileControl:
    """Return the control that moves the pile downward by ``displacement`` in m along its axis."""
    size = n_motions(dim)
    return PileControl(np.zeros(size, dtype=bool), -displacement * axial(dim), np.zeros(size))


def loaded(head_load: float, dim: int = 2) -> PileControl:
    """Return the control that brings the downward load to ``head_load`` in N, else held."""
    size = n_motions(dim)
    return PileControl(axial(dim) > 0.0, np.zeros(size), -head_load * axial(dim))


def axial(dim: int) -> np.ndarray:
    """Return the unit motion (n_motions,) along the axis, upward."""
    unit = np.zeros(n_motions(dim))
    unit[dim - 1] = 1.0
    return unit
