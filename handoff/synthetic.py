"""A known stress field, sampled at the material points and mapped as the real one is.

The field balances gravity exactly: geostatic stress plus the field of an Airy function,

    phi = A L^2 sum exp(-((x -+ b)^2 + (z + d)^2) / (2 L^2)) ,
    s_xx = phi,zz ,   s_zz = phi,xx ,   s_xz = -phi,xz ,   s_yy = (s_xx + s_zz) / 2 ,

centred on the corners of the pile's tip, with L its half-width b: as steep as what a pile leaves
behind.  In axisymmetry phi is a function of r and z and the field that balances is

    s_rr = s_hoop = phi,zz ,   s_zz = phi,rr + phi,r / r ,   s_rz = -phi,rz .

In space, with a function phi of the distance from places at the rim of the plates and at the tip
and with L from the radius of the shaft, it is

    s_xx = s_yy = phi,zz ,   s_zz = phi,xx + phi,yy ,   s_xz = -phi,xz ,   s_yz = -phi,yz .

The error of the map is known for it without any reference solution, at the actual points.
"""

from __future__ import annotations

import numpy as np

from install_mpm.conventions import Kinematics, rotation_matrix
from install_mpm.ground import GroundProfile, geostatic_stress, undrained_shear_strength
from install_mpm.pile import Pile
from install_mpm.screw_pile import ScrewPile

STRENGTHS = 4.0
"""Amplitude A of the Airy field over the undrained shear strength at the tip."""

RIM_LENGTH = 1.5
"""Length L of the field in space over the radius of the shaft."""


def airy_stress(
    ground: GroundProfile,
    pile: Pile,
    tip_depth: float,
    positions: np.ndarray,
    kinematics: Kinematics = Kinematics.PLANE_STRAIN,
) -> np.ndarray:
    """Return the self-equilibrated part (n, 3, 3) in Pa of the synthetic field at (n, 2)."""
    amplitude = _amplitude(ground, tip_depth)
    stress = np.zeros((len(positions), 3, 3))
    below = (positions[:, 1] + tip_depth) / pile.half_width
    for side in (-1.0, 1.0):
        beside = (positions[:, 0] - side * pile.half_width) / pile.half_width
        bell = amplitude * np.exp(-0.5 * (beside**2 + below**2))
        stress[:, 0, 0] += bell * (below**2 - 1.0)
        stress[:, 1, 1] += bell * (beside**2 - 1.0)
        stress[:, 0, 1] -= bell * beside * below
        if kinematics == Kinematics.AXISYMMETRIC:
            stress[:, 1, 1] -= bell * beside * pile.half_width / positions[:, 0]
    stress[:, 1, 0] = stress[:, 0, 1]
    in_plane = 0.5 * (stress[:, 0, 0] + stress[:, 1, 1])
    stress[:, 2, 2] = stress[:, 0, 0] if kinematics == Kinematics.AXISYMMETRIC else in_plane
    return stress


def _amplitude(ground: GroundProfile, tip_depth: float) -> float:
    """Return the amplitude A in Pa: of the strength at the tip, or the stress there without one."""
    strength = undrained_shear_strength(ground, np.array([-tip_depth]))[0]
    overburden = -geostatic_stress(ground, np.array([-tip_depth]), vertical=1)[0, 1, 1]
    return float(STRENGTHS * strength if strength > 0.0 else overburden)


def rim_stress(
    ground: GroundProfile, pile: ScrewPile, rotation: float, positions: np.ndarray
) -> np.ndarray:
    """Return the self-equilibrated part (n, 3, 3) in Pa of the synthetic field around a screw pile.

    The pile has its tip at the depth ``embedment`` and has turned by ``rotation`` in rad.
    """
    amplitude, length = _amplitude(ground, pile.embedment), RIM_LENGTH * pile.shaft_radius
    stress = np.zeros((len(positions), 3, 3))
    for centre in _centres(pile) @ rotation_matrix(rotation, 3).T:
        x, y, z = ((positions - centre) / length).T
        bell = amplitude * np.exp(-0.5 * (x**2 + y**2 + z**2))
        stress[:, 0, 0] += bell * (z**2 - 1.0)
        stress[:, 1, 1] += bell * (z**2 - 1.0)
        stress[:, 2, 2] += bell * (x**2 + y**2 - 2.0)
        stress[:, 0, 2] -= bell * x * z
        stress[:, 1, 2] -= bell * y * z
    stress[:, 2, 0], stress[:, 2, 1] = stress[:, 0, 2], stress[:, 1, 2]
    return stress


def _centres(pile: ScrewPile) -> np.ndarray:
    """Return places (n, 3) in m in the frame of the pile: its tip, and three on each rim."""
    places = [np.array([0.0, 0.0, -pile.embedment])]
    for helix in pile.helices:
        for winding in np.array([0.0, 0.4, 0.8]) * helix.winding:
            polar = pile.sense * winding
            level = pile.leading_level(helix) + helix.pitch * winding / (2.0 * np.pi)
            places.append(np.array([np.cos(polar), np.sin(polar), 0.0]) * helix.radius)
            places[-1][2] = level
    return np.array(places)


def distance_to_pile(pile: Pile, tip_depth: float, positions: np.ndarray) -> np.ndarray:
    """Return the distance (n,) in m of places in the soil from the surface of the pile."""
    beside = np.maximum(positions[:, 0] - pile.half_width, 0.0)
    below = np.maximum(-tip_depth - positions[:, 1], 0.0)
    distance: np.ndarray = np.hypot(beside, below)
    return distance
