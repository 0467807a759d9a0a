"""PA14: shaft of a pile in axisymmetry, elastic soil and a Coulomb interface, no end bearing.

Each horizontal slice is sheared by itself: the settlement is w = tau [1 / k_s + (a / G) ln(b / a)]
with the soil fixed at radius b.  At depth z the interface slips at c + K_0 gamma z tan(delta).

Source: model of concentric cylinders, Fleming et al. (2009), Piling engineering, 3rd edition.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True)
class ShaftLoad:
    """Load carried by the shaft, positive for a pile that is pushed down."""

    load: np.ndarray
    """At the settlements, in N."""
    stiffness: float
    """Before slip, in N/m."""
    capacity: float
    """While all of the shaft slips, in N."""


def shaft_load(
    settlement: ArrayLike,
    *,
    radius: float,
    length: float,
    outer_radius: float,
    shear_modulus: float,
    shear_stiffness: float,
    cohesion: float,
    friction_angle: float,
    k0: float,
    unit_weight: float,
) -> ShaftLoad:
    """Return the load at ``settlement``, any shape, in m.

    The capacity is Q = 2 pi a [c L + K_0 gamma L^2 tan(delta) / 2]; before that, slip reaches
    down to the depth where c + K_0 gamma z tan(delta) equals the elastic shear stress.

    Parameters
    ----------
    radius, length, outer_radius
        a, L and b in m.
    shear_modulus, cohesion, shear_stiffness
        G and c in Pa, k_s of the interface in Pa/m.
    friction_angle, unit_weight
        delta in rad, gamma in N/m^3.
    """
    perimeter = 2.0 * np.pi * radius
    compliance = 1.0 / shear_stiffness + radius / shear_modulus * np.log(outer_radius / radius)
    gradient = k0 * unit_weight * np.tan(friction_angle)
    settlement = np.asarray(settlement, dtype=float)
    elastic = np.abs(settlement) / compliance
    with np.errstate(divide="ignore", invalid="ignore"):
        slip_depth = np.where(elastic > cohesion, (elastic - cohesion) / gradient, 0.0)
    slip_depth = np.minimum(slip_depth, length)
    slipping = cohesion * slip_depth + 0.5 * gradient * slip_depth**2
    load = np.sign(settlement) * perimeter * (slipping + elastic * (length - slip_depth))
    capacity = perimeter * (cohesion * length + 0.5 * gradient * length**2)
    return ShaftLoad(load, perimeter * length / compliance, capacity)
