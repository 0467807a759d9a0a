"""PA13: annulus torsion through an elasto-plastic interface on the rigid inner rim.

The interface and the annulus are springs in series, 1 / k = 1 / k_annulus + 1 / (2 pi a^3 k_s).
The interface carries at most c + p tan(phi), so T = min(k theta, 2 pi a^2 (c + p tan(phi))).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from workflows.verification.references.annulus_torsion import small_strain_torque


@dataclass(frozen=True)
class AnnulusInterface:
    """Torque of the inner rim and its two branches."""

    torque: np.ndarray
    """At the rotations, in N m per metre."""
    stiffness: float
    """Before slip, in N m per rad and metre."""
    strength: float
    """Torque while slipping, in N m per metre."""
    slip_onset: float
    """Rotation at first slip in rad."""


def annulus_interface(
    rotation: ArrayLike,
    *,
    inner_radius: float,
    outer_radius: float,
    youngs_modulus: float,
    poissons_ratio: float,
    shear_stiffness: float,
    cohesion: float,
    friction_angle: float,
    radial_pressure: float = 0.0,
) -> AnnulusInterface:
    """Return the torque at ``rotation``, any shape, in rad (small strain, no dilation).

    Parameters
    ----------
    inner_radius, outer_radius
        a and b in m.
    youngs_modulus, cohesion
        In Pa.
    shear_stiffness
        k_s of the interface in Pa/m.
    friction_angle
        In rad.
    radial_pressure
        Constant normal pressure on the interface, compression positive, in Pa.
    """
    of_annulus = small_strain_torque(
        1.0,
        inner_radius=inner_radius,
        outer_radius=outer_radius,
        youngs_modulus=youngs_modulus,
        poissons_ratio=poissons_ratio,
    )
    of_interface = 2.0 * np.pi * inner_radius**3 * shear_stiffness
    stiffness = 1.0 / (1.0 / of_annulus + 1.0 / of_interface)
    shear_strength = cohesion + radial_pressure * np.tan(friction_angle)
    strength = 2.0 * np.pi * inner_radius**2 * shear_strength
    torque = np.clip(stiffness * np.asarray(rotation, dtype=float), -strength, strength)
    return AnnulusInterface(torque, stiffness, strength, strength / stiffness)
