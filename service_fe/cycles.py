"""What a packet of load cycles leaves behind: displacement and rotation from cycle to cycle."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from service_fe.loading import TILT
from service_fe.options import Cycles
from service_fe.results import Curve
from service_fe.rigid_pile import head_frame


class CycleEnds(NamedTuple):
    """State of the pile's head at the same place of every cycle, since the packet's start."""

    displacement: np.ndarray
    """Of the curve (cycle + 1,) in m; the first row is before the first cycle, at the mean load."""
    rotation: np.ndarray
    """Tilt (cycle + 1,) in rad, positive in the direction of the load."""


def accumulated(programme: Cycles, curve: Curve) -> CycleEnds:
    """Return displacement and rotation at the mean load, at the end of every cycle."""
    return _at(programme, curve, _starts(programme, curve))


def peaks(programme: Cycles, curve: Curve) -> tuple[CycleEnds, CycleEnds]:
    """Return displacement and rotation (cycle,) at the largest and at the least load."""
    starts = _starts(programme, curve)[:-1]
    steps = programme.steps
    return _at(programme, curve, starts + steps), _at(programme, curve, starts + 3 * steps)


def _starts(programme: Cycles, curve: Curve) -> np.ndarray:
    """Return the rows (cycle + 1,) of the curve between the cycles.

    A packet whose mean is not the load at its start has a step to the mean before the first cycle.
    """
    per_cycle = 4 * programme.steps
    first = len(curve.displacement) - 1 - per_cycle * programme.cycles
    return first + per_cycle * np.arange(programme.cycles + 1)


def _at(programme: Cycles, curve: Curve, rows: np.ndarray) -> CycleEnds:
    tilt = curve.motion @ head_frame(0.0, programme.direction)[:, TILT]
    return CycleEnds((curve.displacement - curve.displacement[0])[rows], (tilt - tilt[0])[rows])
