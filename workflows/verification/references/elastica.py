"""PA2: cantilever under a transverse dead load at its tip, inextensible elastica.

EI theta'' = -P cos(theta) has the first integral EI theta'^2 / 2 = P (sin(alpha) - sin(theta)),
with the tip angle alpha; with sin(theta) = 2 k^2 sin^2(phi) - 1 and k^2 = (1 + sin(alpha)) / 2 the
arc length and the deflection become elliptic integrals.

Source: Bisshopp & Drucker (1945), Quarterly of Applied Mathematics 3, 272-275.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipkinc, ellipkm1


@dataclass(frozen=True)
class Tip:
    """Position of the tip of the cantilever."""

    shortening: float
    """Displacement u towards the support; in m, or over the length."""
    deflection: float
    """Displacement w in the direction of the load; in m, or over the length."""
    angle: float
    """Rotation in rad."""


def elastica_tip(load_number: float) -> Tip:
    """Return the tip for the load number P l^2 / EI >= 0, lengths over the length l.

    The complement delta = pi/2 - alpha solves K(k) - F(phi_1, k) = sqrt(P l^2 / EI), with
    sin(phi_1) = 1 / (k sqrt(2)).

    Raises
    ------
    ValueError
        If the load number is negative.
    """
    if load_number < 0.0:
        raise ValueError(f"load number P l^2 / EI = {load_number} must not be negative")
    if load_number == 0.0:
        return Tip(0.0, 0.0, 0.0)
    root = np.sqrt(load_number)
    log_complement = brentq(
        lambda x: _arc_length(np.exp(x)) - root, -300.0, np.log(0.5 * np.pi), xtol=1e-14, rtol=1e-14
    )
    complement = np.exp(log_complement)
    modulus, amplitude = _modulus_and_amplitude(complement)
    return Tip(
        1.0 - np.sqrt(2.0 * np.cos(complement)) / root,
        1.0 - 2.0 * (ellipe(modulus) - ellipeinc(amplitude, modulus)) / root,
        0.5 * np.pi - complement,
    )


def cantilever_tip(
    *,
    load: float,
    length: float,
    depth: float,
    youngs_modulus: float,
    poissons_ratio: float,
    is_plane_strain: bool = True,
) -> Tip:
    """Return the tip of a cantilever of rectangular section, 1 m wide, lengths in m.

    EI = E d^3 / 12; in plane strain E is replaced by E / (1 - nu^2), because the section cannot
    bend sideways.

    Parameters
    ----------
    load
        In N per metre of width.
    length, depth
        In m.
    youngs_modulus
        In Pa.
    """
    modulus = youngs_modulus / (1.0 - poissons_ratio**2) if is_plane_strain else youngs_modulus
    tip = elastica_tip(12.0 * load * length**2 / (modulus * depth**3))
    return Tip(tip.shortening * length, tip.deflection * length, tip.angle)


def _modulus_and_amplitude(complement: float) -> tuple[float, float]:
    """Return k^2 = cos^2(delta / 2) and phi_1."""
    modulus = np.cos(0.5 * complement) ** 2
    return modulus, np.arcsin(min(1.0, np.sqrt(0.5 / modulus)))


def _arc_length(complement: float) -> float:
    """Return sqrt(P l^2 / EI) for the complement delta of the tip angle."""
    modulus, amplitude = _modulus_and_amplitude(complement)
    return ellipkm1(np.sin(0.5 * complement) ** 2) - ellipkinc(amplitude, modulus)
