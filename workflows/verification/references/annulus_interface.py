"""PA13: annulus torsion through an elasto-plastic interface on the rigid inner rim.

The interface and the annulus are springs in series, 1 / k = 1 / k_annulus + 1 / (2 pi a^3 k_s).
The interface carries at most c + p tan(phi), so T = min(k theta, 2 pi a^2 (c + p tan(phi))).

At finite strain shearing presses the soil against the pile (Poynting's effect): the pressure while
it slips is that of the annulus whose rim carries c + p tan(phi) (``annulus_torsion``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from workflows.verification.references.annulus_energy import EnergyLaw
from workflows.verification.references.annulus_torsion import (
    AnnulusTorsion,
    annulus_torsion,
    small_strain_torque,
)


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


@dataclass(frozen=True)
class SlippingAnnulus:
    """Annulus of finite strain whose inner rim slips."""

    torque: float
    """On the inner rim, in N m per metre."""
    pressure: float
    """On the inner rim in Pa, compression positive."""
    rotation: float
    """Of the soil at the inner rim, in rad."""


def slipping_annulus(
    *,
    energy: EnergyLaw,
    inner_radius: float,
    outer_radius: float,
    youngs_modulus: float,
    poissons_ratio: float,
    cohesion: float,
    friction_angle: float,
) -> SlippingAnnulus:
    """Return the annulus whose inner rim, rigid across, carries 2 pi a^2 (c + p tan(phi)).

    Parameters as in ``annulus_interface``; ``energy`` as in ``annulus_torsion``.

    Raises
    ------
    ArithmeticError
        If the soil is lost before it slips.
    """
    area = 2.0 * np.pi * inner_radius**2

    def turned(rotation: float) -> AnnulusTorsion:
        return annulus_torsion(
            rotation,
            energy=energy,
            inner_radius=inner_radius,
            outer_radius=outer_radius,
            youngs_modulus=youngs_modulus,
            poissons_ratio=poissons_ratio,
        )

    def beyond(rotation: float) -> float:
        state = turned(rotation)
        strength = cohesion - state.radial_stress[0] * np.tan(friction_angle)
        return float(state.torque - area * strength)

    high = area * cohesion / small_strain_torque(
        1.0,
        inner_radius=inner_radius,
        outer_radius=outer_radius,
        youngs_modulus=youngs_modulus,
        poissons_ratio=poissons_ratio,
    )  # fmt: skip
    while beyond(high) < 0.0:
        high *= 1.1
    rotation = brentq(beyond, 0.0, high, xtol=1e-12 * high)
    state = turned(rotation)
    return SlippingAnnulus(state.torque, -float(state.radial_stress[0]), rotation)
