"""Where a screw pile is on its path, told by the history, and where the next step goes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm.screw_history import ScrewHistory
from install_mpm.screw_pile import ScrewPile
from install_mpm.screw_programme import (
    Pose,
    ScrewProgramme,
    all_phases,
    phase_length,
    phase_motion,
    total_length,
)

ALMOST = 1e-9
"""Share of a step by which the last one of a phase may be longer, so that no stub is left."""


class Target(NamedTuple):
    """Where a step goes: to a pose, or to loads in place of what is not given of the pose."""

    phase: int
    """Number of the phase; the release comes after the last."""
    share: float
    """Of the phase that is done at the end of the step."""
    way: float
    """Of the step in m; zero for the first one, which moves nothing."""
    pose: Pose
    """What is to be found of it stands as it was before the step."""
    crowd_force: float | None = None
    """In N, positive downward; None: the advance is given."""
    torque: float | None = None
    """In N m, positive in the sense that drives the pile down; None: the rotation is given."""

    @property
    def is_loaded(self) -> bool:
        """Whether a motion of the pile is to be found."""
        return self.crowd_force is not None or self.torque is not None


START = Target(phase=0, share=0.0, way=0.0, pose=Pose(0.0, 0.0))
"""The first step: the pile stays where it was wished in place."""


def next_target(
    pile: ScrewPile, programme: ScrewProgramme, history: ScrewHistory, size: float
) -> Target | None:
    """Return where a step of ``size`` (m) goes, which ends with its phase; None after the last."""
    number, share = int(history.phase[-1]), float(history.phase_share[-1])
    if share == 1.0:
        number, share = number + 1, 0.0
    if number == len(all_phases(programme)):
        return None
    length = phase_length(pile, programme, all_phases(programme)[number])
    left = (1.0 - share) * length
    if left < size * (1.0 + ALMOST):
        return _target(pile, programme, history, number, 1.0, left)
    return _target(pile, programme, history, number, share + size / length, size)


def _target(
    pile: ScrewPile,
    programme: ScrewProgramme,
    history: ScrewHistory,
    number: int,
    share: float,
    way: float,
) -> Target:
    """Return the target at a ``share`` of a phase, ``way`` (m) from the last step."""
    phase = all_phases(programme)[number]
    motion = phase_motion(pile, phase)
    before = np.flatnonzero(history.phase < number)
    start = before[-1] if len(before) else 0  # the last step before the phase
    length = phase_length(pile, programme, phase)
    rise = min(phase.steps * programme.step, length)
    risen = min(share * length / rise, 1.0)

    def load(value: float | None, recorded: np.ndarray) -> float | None:
        if value is None:
            return None
        return float((1.0 - risen) * recorded[start] + risen * value)

    here = [
        float(values[-1] if is_found else values[start] + share * whole)
        for values, is_found, whole in (
            (history.penetration, phase.crowd_force is not None, motion.advance),
            (history.rotation, phase.torque is not None, motion.rotation),
        )
    ]
    return Target(
        number, share, way, Pose(*here),
        load(phase.crowd_force, history.crowd_force), load(phase.torque, history.torque),
    )  # fmt: skip


def way_done(pile: ScrewPile, programme: ScrewProgramme, history: ScrewHistory) -> float:
    """Return the length in m of the way so far, without the release."""
    number = int(history.phase[-1])
    if number == len(programme.phases):
        return total_length(pile, programme)
    lengths = [phase_length(pile, programme, phase) for phase in programme.phases[: number + 1]]
    return sum(lengths[:-1]) + float(history.phase_share[-1]) * lengths[-1]


def last_way(pile: ScrewPile, programme: ScrewProgramme, history: ScrewHistory) -> float:
    """Return the way in m of the last step; zero for the first one."""
    if not len(history.phase):
        return 0.0
    number, share = int(history.phase[-1]), float(history.phase_share[-1])
    if len(history.phase) > 1 and history.phase[-2] == number:
        share -= float(history.phase_share[-2])
    return share * phase_length(pile, programme, all_phases(programme)[number])


def last_motion(history: ScrewHistory) -> Pose:
    """Return advance in m and rotation in rad of the last step; none of the first one."""
    if len(history.travel) < 2:
        return Pose(0.0, 0.0)
    return Pose(
        float(history.penetration[-1] - history.penetration[-2]),
        float(history.rotation[-1] - history.rotation[-2]),
    )
