"""PC1, PC3 and PC7: torque and force on a thin helix and a shaft, uplift of a plate in sand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Resistance:
    """Resistance of the soil against screwing in."""

    torque: float
    """About the axis, in N m."""
    force: float
    """Along the axis, in N."""


def helix_resistance(
    *,
    helix_diameter: float,
    shaft_diameter: float,
    pitch: float,
    shear_strength: float,
    turns: float = 1.0,
) -> Resistance:
    """Return torque and force on both faces of a thin helix that follows its own pitch (PC1).

    The slip has the direction of the helix at each radius: circumferential part 2 pi r, axial part
    p over the length sqrt((2 pi r)^2 + p^2).  The area of the helicoid grows with the same length,
    so that T = 4 pi / 3 tau (R^3 - r^3) does not depend on the pitch, and F = 2 tau p (R - r).
    No resistance of the edges.

    Parameters
    ----------
    helix_diameter, shaft_diameter
        2 R and 2 r in m.
    pitch
        p, advance per turn, in m.
    shear_strength
        tau on the faces, adhesion factor times s_u, in Pa.
    turns
        Number of turns of the plate.
    """
    outer, inner = 0.5 * helix_diameter, 0.5 * shaft_diameter
    return Resistance(
        4.0 * np.pi / 3.0 * shear_strength * (outer**3 - inner**3) * turns,
        2.0 * shear_strength * pitch * (outer - inner) * turns,
    )


def shaft_slip_angle(*, radius: float, pitch: float, advancement_ratio: float) -> float:
    """Return beta in rad between slip and circumference: tan(beta) = AR p / (2 pi a) (PC3)."""
    return np.arctan(advancement_ratio * pitch / (2.0 * np.pi * radius))


def shaft_resistance(
    *,
    radius: float,
    length: float,
    pitch: float,
    advancement_ratio: float,
    shear_strength: float,
) -> Resistance:
    """Return T = 2 pi a^2 L tau cos(beta) and F = 2 pi a L tau sin(beta) of a shaft (PC3).

    Torque and axial force share one slip direction, that of ``shaft_slip_angle``.

    Parameters
    ----------
    radius, length, pitch
        a, L and p in m.
    advancement_ratio
        AR, advance per turn over pitch.
    shear_strength
        tau on the shaft in Pa.
    """
    beta = shaft_slip_angle(radius=radius, pitch=pitch, advancement_ratio=advancement_ratio)
    friction = 2.0 * np.pi * radius * length * shear_strength
    return Resistance(friction * radius * np.cos(beta), friction * np.sin(beta))


def plate_uplift_upper_bound(*, depth: float, diameter: float, friction_angle: float) -> float:
    """Return the uplift factor of a circular plate in sand, associated flow (PC7).

    N = 1 + 2 (H/D) tan(phi) + 4/3 (H/D)^2 tan^2(phi), the weight of a frustum that opens at phi,
    over the weight above the plate; H and D in m, angle in rad.
    """
    ratio = depth / diameter * np.tan(friction_angle)
    return 1.0 + 2.0 * ratio + 4.0 / 3.0 * ratio**2


def plate_uplift_slip_cone(
    *,
    depth: float,
    diameter: float,
    friction_angle: float,
    dilation_angle: float,
    k0: float,
) -> float:
    """Return the uplift factor of a frustum that opens at psi, with friction on it (PC7).

    N = [V + 2 pi k (tan(phi) - tan(psi)) (D H^2 / 4 + tan(psi) H^3 / 6)] / (H pi D^2 / 4), with the
    volume V of the frustum and the normal stress k gamma z on it from the undisturbed stress,
    k = (1 + K_0) / 2 - (1 - K_0) cos(2 psi) / 2.

    Source: White, Cheuk & Bolton (2008), Geotechnique 58, 771-779; Giampa, Bradshaw & Schneider
    (2017) for the circular plate.

    Parameters
    ----------
    depth, diameter
        H and D in m.
    friction_angle, dilation_angle
        In rad.
    """
    tan_phi, tan_psi = np.tan(friction_angle), np.tan(dilation_angle)
    lower, upper = 0.5 * diameter, 0.5 * diameter + depth * tan_psi
    volume = np.pi * depth / 3.0 * (lower**2 + lower * upper + upper**2)
    k = 0.5 * (1.0 + k0) - 0.5 * (1.0 - k0) * np.cos(2.0 * dilation_angle)
    lever = diameter * depth**2 / 4.0 + tan_psi * depth**3 / 6.0
    friction = 2.0 * np.pi * k * (tan_phi - tan_psi) * lever
    return (volume + friction) / (depth * np.pi * diameter**2 / 4.0)
