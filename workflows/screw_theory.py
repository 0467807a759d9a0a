"""Closed forms of the torque that acts along the parts of a screw pile, beside the computed one.

Full slip along a surface needs no more than the shear limit of the interface and the direction of
the slip: soil that stays behind while the part moves on, without leaving it.  On the faces of a
plate that is the direction of the helix at whatever rate the pile goes down (PC1), on cylinder and
cone that of the pile's motion (PC3), on a flat tip the circumference.  The edges that cut through
the soil have no such form; their torque comes from normal traction.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.integrate import trapezoid

from install_mpm.constitutive.coulomb_interface import COHESION, TAN_FRICTION
from install_mpm.exact_patches import strength_shares
from install_mpm.interface import InterfacePoints
from install_mpm.screw_history import ScrewHistory, driven
from install_mpm.screw_pile import (
    CONE,
    FLAT_TIP,
    LOWER_FACE,
    PARTS_OF_PILE,
    RIM,
    SHAFT,
    UPPER_FACE,
    Helix,
    ScrewPile,
    first_part,
    part_names,
)
from install_mpm.screw_record import plate_volume
from install_mpm.screw_surface import pile_elements
from install_mpm.state_file import InstalledState
from workflows.screw_frames import PileSurface
from workflows.verification.references.screw_pile import helix_resistance, shaft_resistance

LEAST_ROTATION = 1e-3
"""Rotation of a step times the shaft radius, over its advance, below which there is no torque."""


class PartTorque(NamedTuple):
    """Torque of a part of the pile in the last step, positive against driving it down."""

    name: str
    tangential: float
    """Computed, from traction along the surface, in N m."""
    normal: float
    """Computed, from normal traction, in N m."""
    closed_form: float | None
    """Of the tangential torque in N m; None where there is none."""

    @property
    def deviation(self) -> float | None:
        """Computed over closed form, less one."""
        if not self.closed_form:
            return None
        return self.tangential / self.closed_form - 1.0


class Motion(NamedTuple):
    """Motion of the pile in the last step."""

    turn: float
    """In rad, positive in the sense that drives the pile down."""
    advance: float
    """In m, positive downward."""

    @property
    def advance_per_turn(self) -> float:
        """In m; the pitch for a pitch-matched pile."""
        return 2.0 * np.pi * self.advance / self.turn


def last_motion(pile: ScrewPile, history: ScrewHistory) -> Motion:
    """Return the motion of the last step of ``history``; none if it has only the first."""
    if len(history.travel) < 2:
        return Motion(0.0, 0.0)
    return Motion(
        -pile.sense * float(history.rotation[-1] - history.rotation[-2]),
        float(history.penetration[-1] - history.penetration[-2]),
    )


def edge_remark(torque: float, force: float) -> list[str]:
    """Return the line on what edges and rims resist that are not in the mesh; none if not stated.

    ``torque`` in N m and ``force`` in N.
    """
    if np.isnan(torque):
        return []
    return [
        f"edges and rims that are not in the mesh, by hand: {torque / 1e3:.2f} kN m and "
        f"{force / 1e3:.2f} kN more"
    ]


def part_torques(
    pile: ScrewPile, installed: InstalledState, surface: PileSurface | None
) -> list[PartTorque]:
    """Return torque and closed form of every part of the pile in the last step it was driven.

    ``surface`` is the pile surface in that step; with friction there is no closed form without it.
    """
    history, interface = driven(installed.history), installed.interface
    n_parts = len(part_names(pile))
    forms = {}
    if surface is not None or not has_friction(interface):
        pressure = None if surface is None else surface.pressure.ravel()
        elements, part, _ = pile_elements(installed.background_mesh, pile)
        share = strength_shares(pile, elements, part, installed.background_mesh.reference_nodes)
        tau = shear_limits(interface, pressure, n_parts, share)
        depth = pile.embedment + float(history.penetration[-1])
        forms = closed_forms(pile, depth, last_motion(pile, history), tau)
    area = np.bincount(interface.part, interface.area, n_parts)
    tangential = history.part_torque[-1] - history.part_normal_torque[-1]
    normal = history.part_normal_torque[-1]
    return [
        PartTorque(name, float(tangential[number]), float(normal[number]), forms.get(number))
        for number, name in enumerate(part_names(pile))
        if area[number] > 0.0
    ]


def closed_forms(
    pile: ScrewPile, depth: float, motion: Motion, tau: np.ndarray
) -> dict[int, float]:
    """Return the closed forms in N m by part; none for a pile that does not turn.

    ``depth`` of the tip in m, ``tau`` (n_parts,) mean shear limit of each part in Pa.
    """
    if abs(motion.turn) * pile.shaft_radius <= LEAST_ROTATION * abs(motion.advance):
        return {}
    if motion.turn == 0.0:
        return {}
    a = pile.shaft_radius
    disc = helix_resistance(
        helix_diameter=2.0 * a, shaft_diameter=0.0, pitch=0.0, shear_strength=tau[FLAT_TIP]
    )
    forms = {
        FLAT_TIP: disc.torque / 2.0,
        CONE: cone_torque(pile, motion, tau[CONE]),
        SHAFT: _cylinder(a, _free_shaft_length(pile, depth), motion, tau[SHAFT]),
    }
    for number, helix in enumerate(pile.helices):
        forms |= _plate_forms(pile, helix, first_part(number), motion, tau)
    sense = float(np.sign(motion.turn))
    return {part: sense * torque for part, torque in forms.items()}


def _plate_forms(
    pile: ScrewPile, helix: Helix, first: int, motion: Motion, tau: np.ndarray
) -> dict[int, float]:
    """Return the closed forms in N m of faces (PC1) and rim of a plate, without their sense."""
    forms = {}
    for face in (LOWER_FACE, UPPER_FACE):
        both = helix_resistance(
            helix_diameter=helix.diameter,
            shaft_diameter=pile.shaft_diameter,
            pitch=helix.pitch,
            shear_strength=tau[first + face],
            turns=helix.turns,
        )
        forms[first + face] = both.torque / 2.0
    length = mean_thickness(pile, helix) * helix.turns
    forms[first + RIM] = _cylinder(helix.radius, length, motion, tau[first + RIM])
    return forms


def _cylinder(radius: float, length: float, motion: Motion, tau: float) -> float:
    """Return the torque in N m of a rough cylinder (PC3), without its sense."""
    return shaft_resistance(
        radius=radius,
        length=length,
        pitch=abs(motion.advance_per_turn),
        advancement_ratio=1.0,
        shear_strength=tau,
    ).torque


def cone_torque(pile: ScrewPile, motion: Motion, tau: float) -> float:
    """Return the torque in N m of a rough conical tip: slip along the cone, none across it.

    At the radius r the cone moves by r d(turn) round the axis and, along its slope, by the advance
    times the cosine of the half-angle; dA = 2 pi r dr / sin(half-angle).
    """
    if pile.tip_length == 0.0:
        return 0.0
    slant = float(np.hypot(pile.tip_length, pile.shaft_radius))
    radius = np.linspace(0.0, pile.shaft_radius, 401)
    around = np.abs(motion.turn) * radius
    along = motion.advance * pile.tip_length / slant
    share = around / np.maximum(np.hypot(around, along), 1e-300)
    integrand = tau * radius * share * 2.0 * np.pi * radius * slant / pile.shaft_radius
    return float(trapezoid(integrand, radius))


def mean_thickness(pile: ScrewPile, helix: Helix) -> float:
    """Return the mean thickness in m of a plate whose edges may be thinner."""
    annulus = (helix.radius**2 - pile.shaft_radius**2) / 2.0
    return plate_volume(pile, helix) / (annulus * helix.winding)


def _free_shaft_length(pile: ScrewPile, tip_depth: float) -> float:
    """Return the length in m of the shaft in the ground less what the plates cover of it."""
    covered = sum(mean_thickness(pile, helix) * helix.turns for helix in pile.helices)
    return tip_depth - pile.tip_length - covered


def shear_limits(
    points: InterfacePoints, pressure: np.ndarray | None, n_parts: int, share: np.ndarray
) -> np.ndarray:
    """Return the mean shear limit (n_parts,) in Pa of each part below the surface.

    The cohesion of the interface and, with friction, the contact ``pressure`` (n_points,) in Pa
    times tan(phi), without the ``share`` (n_points,) of the exact surface that facets stand for.
    """
    area = points.area * points.covered * (points.position[:, 2] < 0.0)
    limit = points.parameters[:, COHESION]
    if pressure is not None:
        limit = limit + points.parameters[:, TAN_FRICTION] * np.maximum(pressure, 0.0)
    total = np.bincount(points.part, area * limit / share, n_parts)
    covered = np.bincount(points.part, area, n_parts)
    mean: np.ndarray = total / np.where(covered > 0.0, covered, 1.0)
    return mean


def has_friction(points: InterfacePoints) -> bool:
    """Return whether the shear limit depends on the computed contact pressure."""
    return bool((points.parameters[:, TAN_FRICTION] > 0.0).any())


def totals_by_kind(pile: ScrewPile, values: np.ndarray) -> dict[str, np.ndarray]:
    """Return ``values`` (n_steps, n_parts) summed over the plates, by kind of part."""
    names = part_names(pile)
    sums: dict[str, np.ndarray] = {}
    for number, name in enumerate(names):
        kind = name if number < len(PARTS_OF_PILE) else " ".join(name.split()[-2:])
        kind = "rim" if kind.endswith("rim") else kind
        sums[kind] = sums.get(kind, 0.0) + values[:, number]
    return sums
