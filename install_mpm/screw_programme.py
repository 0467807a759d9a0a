"""How a screw pile is driven: phases of rotation and advance, and the path that they make.

A phase is a straight line in the plane of advance and rotation: screwing in, pushing, pulling,
backing out or turning on the spot.  The path is measured by the travel of the rim of the largest
plate (of the shaft, if there is none), in m.
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
    """Rotation and advance at a constant ratio."""

    name: str
    turns: Annotated[float, Ge(-20), Le(20)] = 0.0
    """Positive in the sense in which the helices draw the pile down."""
    advancement_ratio: Annotated[float | None, Ge(0), Le(3)] = None
    """Advance per turn over the pitch of the lowest helix; 1: pitch-matched."""
    advance: Annotated[float | None, Unit("m")] = None
    """Instead of the ratio, or without turns: positive downward."""


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


def phase_motion(pile: ScrewPile, phase: Phase) -> Pose:
    """Return advance and rotation of a whole phase.

    Raises
    ------
    ProgrammeError
        If the phase gives both or neither of ratio and advance, or does not move at all.
    """
    given = [phase.advancement_ratio is not None, phase.advance is not None]
    if all(given):
        raise ProgrammeError(
            f"phase {phase.name!r} gives both advancement_ratio and advance; give one of them"
        )
    if phase.advance is not None:
        advance = phase.advance
    elif phase.advancement_ratio is not None and pile.helices:
        lowest = min(pile.helices, key=lambda helix: helix.height)
        advance = phase.advancement_ratio * lowest.pitch * phase.turns
    else:
        raise ProgrammeError(
            f"phase {phase.name!r} does not say how far the pile goes; "
            "give advancement_ratio (of a pile with helices) or advance"
        )
    rotation = -pile.sense * 2.0 * np.pi * phase.turns
    if advance == 0.0 and rotation == 0.0:
        raise ProgrammeError(f"phase {phase.name!r} does not move the pile; remove it")
    return Pose(advance, rotation)


def phase_travel(pile: ScrewPile, phase: Phase) -> float:
    """Return the travel of the rim in m over a phase."""
    motion = phase_motion(pile, phase)
    return float(np.hypot(rim_radius(pile) * motion.rotation, motion.advance))


def total_travel(pile: ScrewPile, programme: ScrewProgramme) -> float:
    """Return the travel of the rim in m over all phases."""
    return sum(phase_travel(pile, phase) for phase in programme.phases)


def pose_at(pile: ScrewPile, programme: ScrewProgramme, travel: float) -> Pose:
    """Return the pose of the pile after ``travel`` of the rim in m."""
    advance = rotation = 0.0
    left = travel
    for phase in programme.phases:
        length, motion = phase_travel(pile, phase), phase_motion(pile, phase)
        share = min(left / length, 1.0)
        advance += share * motion.advance
        rotation += share * motion.rotation
        left -= share * length
        if left <= 0.0:
            break
    return Pose(advance, rotation)


def next_corner(pile: ScrewPile, programme: ScrewProgramme, travel: float) -> float:
    """Return the travel in m at the end of the phase that is going on; steps end there."""
    end = 0.0
    for phase in programme.phases:
        end += phase_travel(pile, phase)
        if travel < end * (1.0 - 1e-12):
            break
    return end


def deepest_advance(pile: ScrewPile, programme: ScrewProgramme) -> tuple[float, float]:
    """Return the smallest and largest advance in m at the ends of the phases, zero included."""
    ends = np.cumsum([0.0, *(phase_motion(pile, phase).advance for phase in programme.phases)])
    return float(ends.min()), float(ends.max())
