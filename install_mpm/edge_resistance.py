"""What edges and rim of a plate resist that the mesh holds as a surface: stated by hand.

The mesh of such a plate has its two faces only.  Leading and trailing edge cut through the soil
with the bearing resistance N su on their thickness, against the way that each place of them goes;
on the rim the shear limit of the interface acts along the slip.  Soil parts to both sides of an
edge, so that adhesion on it has no resultant.  The bearing factor N is that of
``Helix.edge_bearing``: in the clay of the prototype study, which carried the solid plate to its
limit of fine meshes and small steps, it was 6 to 8 for each edge of a plate of one turn.

These are limits, of a pile that moves.  They stand beside torque and crowd force, never in them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm.constitutive import coulomb_interface
from install_mpm.constitutive.coulomb_interface import COHESION
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.ground import GroundProfile, undrained_shear_strength
from install_mpm.screw_pile import Helix, ScrewPile
from install_mpm.screw_programme import Pose

PLACES = 16
"""Places along an edge, and along the rim, between which the resistance is summed up."""


class EdgeResistance(NamedTuple):
    """Resistance of edges and rims in a step, positive against driving the pile down."""

    edge_torque: float
    """In N m; NaN where it cannot be stated."""
    edge_force: float
    """In N, upward on a pile that is screwed in."""


NOT_STATED = EdgeResistance(np.nan, np.nan)


def edge_resistance(
    pile: ScrewPile, ground: GroundProfile, law: CoulombInterface, advance: float, motion: Pose
) -> EdgeResistance:
    """Return the resistance in a step that ends at ``advance`` (m) and had ``motion``.

    It is not stated without a plate held as a surface, without motion, and in ground without an
    undrained shear strength at an edge or the rim.
    """
    helices = [helix for helix in pile.helices if helix.is_surface]
    turn = -pile.sense * motion.rotation
    if not helices or (turn == 0.0 and motion.advance == 0.0):
        return NOT_STATED
    of_helix = [
        part
        for helix in helices
        for part in (
            _of_edges(pile, helix, ground, advance, (turn, motion.advance)),
            _of_rim(pile, helix, ground, law, advance, (turn, motion.advance)),
        )
    ]
    torque, force = np.sum(of_helix, axis=0)
    return EdgeResistance(float(torque), float(force))


def _of_edges(
    pile: ScrewPile, helix: Helix, ground: GroundProfile, advance: float,
    motion: tuple[float, float],
) -> np.ndarray:  # fmt: skip
    """Return torque and force (2,) of leading and trailing edge."""
    strength = _strength(pile, helix, ground, advance, np.array([0.0, helix.winding])).sum()
    width = helix.radius - pile.shaft_radius
    radius = pile.shaft_radius + width * (np.arange(PLACES) + 0.5) / PLACES
    load = np.full(PLACES, helix.edge_bearing * strength * helix.thickness * width / PLACES)
    return _against(motion, radius, load)


def _of_rim(
    pile: ScrewPile, helix: Helix, ground: GroundProfile, law: CoulombInterface, advance: float,
    motion: tuple[float, float],
) -> np.ndarray:  # fmt: skip
    """Return torque and force (2,) of the rim."""
    windings = helix.winding * (np.arange(PLACES) + 0.5) / PLACES
    strength = _strength(pile, helix, ground, advance, windings)
    limit = coulomb_interface.pack(law, strength)[:, COHESION]
    load = limit * helix.thickness * helix.radius * helix.winding / PLACES
    return _against(motion, np.full(PLACES, helix.radius), load)


def _strength(
    pile: ScrewPile, helix: Helix, ground: GroundProfile, advance: float, winding: np.ndarray
) -> np.ndarray:
    """Return the undrained shear strength (n,) in Pa at winding angles (n,); NaN without one."""
    level = pile.leading_level(helix) - advance + helix.pitch * winding / (2.0 * np.pi)
    strength = undrained_shear_strength(ground, level)
    return np.where(strength > 0.0, strength, np.nan)


def _against(motion: tuple[float, float], radius: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Return torque and force (2,) of loads (n,) in N at radii (n,) against a motion.

    The ``motion`` is a turn in rad and an advance in m; a place goes radius times turn round the
    axis and the advance down.
    """
    around, down = radius * motion[0], np.full_like(radius, motion[1])
    way = np.hypot(around, down)
    return np.array([(load * radius * around / way).sum(), (load * down / way).sum()])
