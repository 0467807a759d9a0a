"""PD5 and PD6: laterally loaded piles, a fit to finite elements and a limit equilibrium."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class LateralHead:
    """Response of the head of a long pile at the ground surface."""

    displacement: float
    """Of a free head in m."""
    rotation: float
    """Of a free head in rad."""
    displacement_fixed: float
    """Under the horizontal force alone if the head cannot rotate, in m."""
    critical_length: float
    """Beyond which the length of the pile has no influence, in m."""


def lateral_head(
    *,
    force: float,
    moment: float = 0.0,
    radius: float,
    pile_modulus: float,
    shear_modulus: float,
    poissons_ratio: float,
    homogeneity: float = 1.0,
) -> LateralHead:
    """Return the head response of a long elastic pile (PD5): a fit, good to 10-15 %.

    With G_c = G (1 + 3 nu / 4), L_c = 2 r_0 (E_p / G_c)^(2/7), f = (E_p / G_c)^(1/7) / (rho G_c):
    u = f [0.27 H / (L_c/2) + 0.3 M / (L_c/2)^2],
    theta = f [0.3 H / (L_c/2)^2 + 0.8 sqrt(rho) M / (L_c/2)^3],
    fixed: u = f [0.27 - 0.11 / sqrt(rho)] H / (L_c/2).

    Source: Randolph (1981), Geotechnique 31, 247-259.

    Parameters
    ----------
    force, moment, radius
        H in N, M in N m and r_0 in m.
    pile_modulus
        Young's modulus of the solid section, or 4 EI / (pi r_0^4), in Pa.
    shear_modulus
        G in Pa, averaged over the critical length.
    homogeneity
        rho, G at a quarter of the critical length over G at half of it; 1 if G is constant.
    """
    modified = shear_modulus * (1.0 + 0.75 * poissons_ratio)
    half = radius * (pile_modulus / modified) ** (2.0 / 7.0)  # L_c / 2
    f = (pile_modulus / modified) ** (1.0 / 7.0) / (homogeneity * modified)
    root = np.sqrt(homogeneity)
    return LateralHead(
        f * (0.27 * force / half + 0.3 * moment / half**2),
        f * (0.3 * force / half**2 + 0.8 * root * moment / half**3),
        f * (0.27 - 0.11 / root) * force / half,
        2.0 * half,
    )


def broms_short_pile(
    *,
    undrained_shear_strength: float,
    diameter: float,
    length: float,
    load_height: float = 0.0,
) -> float:
    """Return the horizontal capacity in N of a short free-headed pile in clay (PD6).

    The clay resists with 9 s_u d below a depth of 1.5 d: over f = H / (9 s_u d) on one side, over
    g = L - 1.5 d - f on both sides in turn, so that moment equilibrium is
    H (e + 1.5 d + f / 2) = 2.25 s_u d g^2.

    Source: Broms (1964), J. Soil Mech. Found. Div. ASCE 90(SM2), 27-63.

    Parameters
    ----------
    undrained_shear_strength
        In Pa.
    diameter, length
        d and embedded length L > 1.5 d in m.
    load_height
        e of the force above the ground in m.

    Raises
    ------
    ValueError
        If the pile is not longer than 1.5 d.
    """
    if length <= 1.5 * diameter:
        raise ValueError(f"length {length} must be more than 1.5 times the diameter {diameter}")
    arm, available = load_height + 1.5 * diameter, length - 1.5 * diameter
    # 4 f (arm + f / 2) = (available - f)^2, a quadratic equation for f
    half = 2.0 * arm + available
    f = np.sqrt(half**2 + available**2) - half
    return 9.0 * undrained_shear_strength * diameter * f


def broms_reaction(
    depth: np.ndarray,
    *,
    undrained_shear_strength: float,
    diameter: float,
    length: float,
    load_height: float = 0.0,
) -> np.ndarray:
    """Return the reaction of the clay in N/m at ``depth`` (n,) in m at the capacity (PD6).

    It is positive against the load and changes its sign at 1.5 d + f + g / 2; see
    ``broms_short_pile``, also for what is raised.
    """
    strongest = 9.0 * undrained_shear_strength * diameter
    f = (
        broms_short_pile(
            undrained_shear_strength=undrained_shear_strength, diameter=diameter, length=length,
            load_height=load_height,
        )
        / strongest
    )  # fmt: skip
    turn = 0.5 * (1.5 * diameter + f + length)
    reaction = np.where(depth < turn, strongest, -strongest)
    return np.where(depth < 1.5 * diameter, 0.0, reaction)
