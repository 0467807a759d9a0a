"""How a screw pile is driven: phases in which the rig gives motions, or loads.

Of advance and rotation each is given in a phase, or the load that goes with it: crowd force or
torque.  Screwing in, pushing, pulling, backing out and turning on the spot are given motions; with
a given crowd force the pile goes as deep as that takes it.  A phase without any given motion is a
rest: held, or left to loads.  The way through a phase is the travel, in m, of the rim of the
largest plate (of the shaft, if there is none) in the given motions; a rest counts as so many steps
as it has.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np
from annotated_types import Ge, Gt, Le

from install_mpm.conventions import Unit
from install_mpm.screw_pile import ScrewPile

Length = Annotated[float, Unit("m"), Gt(0)]


@dataclass(frozen=True)
class Phase:
    """Rotation and advance at a constant ratio, or crowd force and torque in their place."""

    name: str
    turns: Annotated[float, Ge(-20), Le(20)] = 0.0
    """Positive in the sense in which the helices draw the pile down."""
    advancement_ratio: Annotated[float | None, Ge(0), Le(3)] = None
    """Advance per turn over the pitch of the lowest helix; 1: pitch-matched."""
    advance: Annotated[float | None, Unit("m")] = None
    """Instead of the ratio, or without turns: positive downward."""
    crowd_force: Annotated[float | None, Unit("N")] = None
    """Instead of both: vertical force of the rig, positive downward; the advance is found."""
    torque: Annotated[float | None, Unit("N m")] = None
    """Instead of turns: torque of the rig, positive as they are; the rotation is found."""
    steps: Annotated[int, Ge(1)] = 4
    """Steps in which crowd force and torque come to their values from those before; in a phase
    without turns and advance they are all of it.
    """


RELEASE = Phase("release", crowd_force=0.0, torque=0.0)
"""The rig lets go: what follows the phases of a programme."""


@dataclass(frozen=True)
class ScrewProgramme:
    """The phases of an installation and the size of its steps."""

    phases: tuple[Phase, ...]
    step: Length
    """Travel of the rim in a step; about a third of the cell size at the edges."""
    reset_angle: Annotated[float, Unit("rad"), Gt(0)] = float(np.radians(30.0))
    """Rotation after which the mesh is wound back; a whole number of sides of the outer wall."""
    release: bool = True
    """At the end the rig lets go: torque and crowd force go to zero."""


class Pose(NamedTuple):
    """Where the pile is on its way."""

    advance: float
    """In m, positive downward."""
    rotation: float
    """In rad, right-handed about +z: negative while a right-handed pile is screwed in."""


class ProgrammeError(ValueError):
    """A programme that cannot be; the message says what to change."""


def rim_radius(pile: ScrewPile) -> float:
    """Return the radius in m whose travel measures the path."""
    return max([pile.shaft_radius, *(helix.radius for helix in pile.helices)])


def rim_travel(pile: ScrewPile, motion: Pose) -> float:
    """Return the travel of the rim in m in a ``motion``."""
    return float(np.hypot(rim_radius(pile) * motion.rotation, motion.advance))


def phase_motion(pile: ScrewPile, phase: Phase) -> Pose:
    """Return advance and rotation that a whole phase gives; zero for what is found.

    Raises
    ------
    ProgrammeError
        If the phase gives too much or too little.
    """
    _check_keys(phase)
    advance = 0.0
    if phase.advance is not None:
        advance = phase.advance
    elif phase.crowd_force is None:
        if phase.advancement_ratio is None or not pile.helices:
            raise ProgrammeError(
                f"phase {phase.name!r} does not say how far the pile goes; "
                "give advancement_ratio (of a pile with helices), advance or crowd_force"
            )
        advance = phase.advancement_ratio * lowest_pitch(pile) * phase.turns
    return Pose(advance, -pile.sense * 2.0 * np.pi * phase.turns)


def lowest_pitch(pile: ScrewPile) -> float:
    """Return the pitch in m of the lowest helix, by which advancement ratios are measured."""
    return min(pile.helices, key=lambda helix: helix.height).pitch


def advancement_ratio(pile: ScrewPile, motion: Pose) -> float:
    """Return the advancement ratio of a ``motion``; NaN without a rotation or a helix."""
    if motion.rotation == 0.0 or not pile.helices:
        return float("nan")
    turns = -pile.sense * motion.rotation / (2.0 * np.pi)
    return motion.advance / (turns * lowest_pitch(pile))


def _check_keys(phase: Phase) -> None:
    """Check that a phase gives either a motion or its load, and no ratio without turns."""
    given = [
        key for key in ("advancement_ratio", "advance", "crowd_force")
        if getattr(phase, key) is not None
    ]  # fmt: skip
    if len(given) > 1:
        raise ProgrammeError(
            f"phase {phase.name!r} gives both {given[0]} and {given[1]}; give one of them"
        )
    if phase.torque is not None and phase.turns != 0.0:
        raise ProgrammeError(f"phase {phase.name!r} gives both turns and torque; give one of them")
    if phase.advancement_ratio is not None and phase.turns == 0.0:
        raise ProgrammeError(
            f"phase {phase.name!r} gives an advancement_ratio without turns; give turns, or advance"
        )


def is_loaded(phase: Phase) -> bool:
    """Return whether a motion of the pile is found in the phase, because its load is given."""
    return phase.crowd_force is not None or phase.torque is not None


def phase_length(pile: ScrewPile, programme: ScrewProgramme, phase: Phase) -> float:
    """Return the length in m of the way through a phase."""
    return rim_travel(pile, phase_motion(pile, phase)) or phase.steps * programme.step


def total_length(pile: ScrewPile, programme: ScrewProgramme) -> float:
    """Return the length in m of the way through all phases, without the release."""
    return sum(phase_length(pile, programme, phase) for phase in programme.phases)


def all_phases(programme: ScrewProgramme) -> tuple[Phase, ...]:
    """Return the phases in order, and the release if there is one."""
    return (*programme.phases, RELEASE) if programme.release else programme.phases


def corners(pile: ScrewPile, programme: ScrewProgramme) -> list[Pose]:
    """Return the poses at the ends of the phases by the given motions, the start first."""
    motions = [phase_motion(pile, phase) for phase in programme.phases]
    ends = np.cumsum([Pose(0.0, 0.0), *motions], axis=0)
    return [Pose(float(advance), float(rotation)) for advance, rotation in ends]


def deepest_advance(pile: ScrewPile, programme: ScrewProgramme) -> tuple[float, float]:
    """Return the smallest and largest given advance in m at the ends of the phases."""
    ends = [pose.advance for pose in corners(pile, programme)]
    return min(ends), max(ends)
