"""A known stress field, sampled at the material points and mapped as the real one is.

The field balances gravity exactly: geostatic stress plus the field of an Airy function,

    phi = A L^2 sum exp(-((x -+ b)^2 + (z + d)^2) / (2 L^2)) ,
    s_xx = phi,zz ,   s_zz = phi,xx ,   s_xz = -phi,xz ,   s_yy = (s_xx + s_zz) / 2 ,

centred on the corners of the pile's tip, with L its half-width b: as steep as what a pile leaves
behind.  In axisymmetry phi is a function of r and z and the field that balances is

    s_rr = s_hoop = phi,zz ,   s_zz = phi,rr + phi,r / r ,   s_rz = -phi,rz .

  The error of the map is known for it without any reference solution, at the actual points.
"""

from __future__ import annotations

import numpy as np

from handoff.geostatic import VERTICAL
from handoff.state_transfer import StateMap, mapped
from install_mpm.conventions import Kinematics
from install_mpm.ground import GroundProfile, geostatic_stress, undrained_shear_strength
from install_mpm.pile import Pile

STRENGTHS = 4.0
"""Amplitude A of the Airy field over the undrained shear strength at the tip."""


def airy_stress(
    ground: GroundProfile,
    pile: Pile,
    tip_depth: float,
    positions: np.ndarray,
    kinematics: Kinematics = Kinematics.PLANE_STRAIN,
) -> np.ndarray:
    """Return the self-equilibrated part (n, 3, 3) in Pa of the synthetic field at (n, 2)."""
    strength = undrained_shear_strength(ground, np.array([-tip_depth]))[0]
    overburden = -geostatic_stress(ground, np.array([-tip_depth]), VERTICAL)[0, VERTICAL, VERTICAL]
    amplitude = STRENGTHS * strength if strength > 0.0 else overburden
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


def synthetic_errors(
    ground: GroundProfile,
    pile: Pile,
    tip_depth: float,
    state_map: StateMap,
    point_positions: np.ndarray,
    targets: np.ndarray,
    volumes: np.ndarray,
    kinematics: Kinematics = Kinematics.PLANE_STRAIN,
) -> tuple[float, float]:
    """Return the relative L2 errors of the mapped synthetic field, everywhere and near the pile.

    Both are errors over the norm of the Airy part alone, because the geostatic part, though far
    larger, is mapped exactly.  Near is within one pile width of the pile.
    """
    at_points = airy_stress(ground, pile, tip_depth, point_positions, kinematics)
    reference = airy_stress(ground, pile, tip_depth, targets, kinematics)
    error = mapped(state_map, at_points, np.zeros_like(reference)) - reference
    is_near = distance_to_pile(pile, tip_depth, targets) <= pile.width
    return (
        relative_norm(error, reference, volumes),
        relative_norm(error[is_near], reference[is_near], volumes[is_near]),
    )


def distance_to_pile(pile: Pile, tip_depth: float, positions: np.ndarray) -> np.ndarray:
    """Return the distance (n,) in m of places in the soil from the surface of the pile."""
    beside = np.maximum(positions[:, 0] - pile.half_width, 0.0)
    below = np.maximum(-tip_depth - positions[:, 1], 0.0)
    distance: np.ndarray = np.hypot(beside, below)
    return distance


def relative_norm(change: np.ndarray, reference: np.ndarray, volumes: np.ndarray) -> float:
    """Return the volume-weighted L2 norm of tensors ``change`` over that of ``reference``."""
    norms = [np.sqrt(volumes @ (field**2).sum(axis=(1, 2))) for field in (change, reference)]
    return float(norms[0] / norms[1])
