"""Undisturbed ground: layers, water table, K0, and the geostatic stress that follows from them.

Stresses are those in excess of the hydrostatic pore pressure: soil below the water table weighs its
unit weight less that of water, and the stress of a drained soil is its effective stress.  A
hydrostatic pressure in water and soil balances its own weight, so it need not be modelled; it is
reported only (``hydrostatic_pressure``).  Without a water table nothing is subtracted, and the
stresses of undrained clay are total ones, as ever.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Annotated, Literal, NamedTuple

import numpy as np
from annotated_types import Ge, Gt

from install_mpm import soil_strength
from install_mpm.constitutive.parameters import SoilParameters
from install_mpm.conventions import WATER_UNIT_WEIGHT, Unit

K0 = Annotated[float, Gt(0)] | Literal["jaky"]
"""Horizontal over vertical stress, or the rule that gives it by the strength of the soil."""

WaterTable = Annotated[float | None, Unit("m"), Ge(0)]


@dataclass(frozen=True)
class Ground:
    """Uniform ground with a level surface at z = 0."""

    unit_weight: Annotated[float, Unit("N/m^3"), Ge(0)]
    k0: K0
    """Horizontal over vertical stress (effective below a water table), or "jaky": 1 - sin(phi),
    times OCR^sin(phi) for a law with an overconsolidation ratio."""
    soil: SoilParameters
    water_table: WaterTable = None
    """Depth of the water table; below it the stresses are effective ones and the ground weighs
    ``unit_weight`` less that of water.  Without it all stresses are total ones."""

    def __post_init__(self) -> None:
        strata(self)

    @property
    def layers(self) -> tuple[Layer, ...]:
        """The one layer of the ground."""
        return (Layer("ground", 0.0, self.unit_weight, self.k0, self.soil),)


@dataclass(frozen=True)
class Layer:
    """A level layer of the ground; it ends where the next one begins."""

    name: str
    top: Annotated[float, Unit("m"), Ge(0)]
    """Depth at which the layer begins; 0 m for the first."""
    unit_weight: Annotated[float, Unit("N/m^3"), Ge(0)]
    k0: K0
    """Horizontal over vertical stress (effective below a water table), or "jaky": 1 - sin(phi),
    times OCR^sin(phi) for a law with an overconsolidation ratio."""
    soil: SoilParameters


@dataclass(frozen=True)
class LayeredGround:
    """Layers from the surface at z = 0 downward, each with its own soil."""

    layers: tuple[Layer, ...]
    water_table: WaterTable = None
    """Depth of the water table; below it the stresses are effective ones and a layer weighs its
    ``unit_weight`` less that of water.  Without it all stresses are total ones."""

    def __post_init__(self) -> None:
        strata(self)


GroundProfile = Ground | LayeredGround
"""The ground of a case: one soil, or layers."""


class Stratum(NamedTuple):
    """What a row of the soil table is: a layer, or its part above or below the water table."""

    layer: Layer
    top: float
    """Depth in m."""
    bottom: float
    """Depth in m, infinite for the last."""
    unit_weight: float
    """In N/m^3, less that of water below the water table."""
    k0: float
    stress_at_top: float
    """Vertical stress in Pa at ``top``, tension positive."""


class GroundError(ValueError):
    """Ground that cannot be; the message says what to change."""


@cache
def strata(ground: GroundProfile) -> tuple[Stratum, ...]:
    """Return the strata from the top; the material of a point is the number of its stratum.

    Raises
    ------
    GroundError
        If the layers do not follow each other from the surface downward, weigh less than water
        below the water table, or have a K0 rule that their soil does not know.
    """
    _check_order(ground.layers)
    ends = [*(layer.top for layer in ground.layers[1:]), np.inf]
    water = np.inf if ground.water_table is None else ground.water_table
    found: list[Stratum] = []
    stress = 0.0
    for layer, end in zip(ground.layers, ends, strict=True):
        k0 = _k0_of(layer)
        cuts = [layer.top, water, end] if layer.top < water < end else [layer.top, end]
        for top, bottom in pairwise(cuts):
            unit_weight = layer.unit_weight - (WATER_UNIT_WEIGHT if top >= water else 0.0)
            if unit_weight < 0.0:
                raise GroundError(
                    f"layer {layer.name!r} below the water table weighs less than water; "
                    f"make its unit_weight at least {WATER_UNIT_WEIGHT / 1e3:g} kN/m^3"
                )
            found.append(Stratum(layer, top, bottom, unit_weight, k0, stress))
            stress -= unit_weight * (bottom - top) if bottom < np.inf else 0.0
    return tuple(found)


def _check_order(layers: tuple[Layer, ...]) -> None:
    if not layers:
        raise GroundError("the ground has no layer; add a [[ground.layers]] table")
    if layers[0].top != 0.0:
        raise GroundError(
            f"layer {layers[0].name!r} is the first and begins at {layers[0].top:g} m; "
            "its top must be the surface, 0 m"
        )
    names: set[str] = set()
    for upper, lower in pairwise(layers):
        names.add(upper.name)
        if lower.top <= upper.top:
            raise GroundError(
                f"layer {lower.name!r} begins at {lower.top:g} m, not below {upper.name!r} at "
                f"{upper.top:g} m; give the layers from the surface downward"
            )
        if lower.name in names:
            raise GroundError(f"two layers are named {lower.name!r}; give each a name of its own")


def _k0_of(layer: Layer) -> float:
    if layer.k0 != "jaky":
        return float(layer.k0)
    friction = soil_strength.friction_angle(layer.soil)
    if friction is None:
        raise GroundError(
            f'k0 of layer {layer.name!r} is "jaky", but its soil ({layer.soil.model}) has no '
            "friction angle; give k0 as a number"
        )
    overconsolidation = getattr(layer.soil, "overconsolidation_ratio", 1.0)
    return float((1.0 - np.sin(friction)) * overconsolidation ** np.sin(friction))


def soils_of(ground: GroundProfile) -> list[SoilParameters]:
    """Return the soil of each row of the soil table."""
    return [stratum.layer.soil for stratum in strata(ground)]


def unit_weights(ground: GroundProfile) -> np.ndarray:
    """Return the unit weight (n_strata,) in N/m^3 of each row of the soil table."""
    return np.array([stratum.unit_weight for stratum in strata(ground)])


def boundary_depths(ground: GroundProfile) -> tuple[float, ...]:
    """Return the depths in m at which one stratum ends and the next begins."""
    return tuple(stratum.top for stratum in strata(ground)[1:])


def material_at(ground: GroundProfile, height: np.ndarray) -> np.ndarray:
    """Return the row (n,) of the soil table of undisturbed ground at ``height`` (n,) in m."""
    tops = np.array([stratum.top for stratum in strata(ground)])
    row: np.ndarray = np.searchsorted(tops, np.maximum(-height, 0.0), side="right") - 1
    return row


def geostatic_stress(
    ground: GroundProfile, height: np.ndarray, vertical: int, material: np.ndarray | None = None
) -> np.ndarray:
    """Return the initial Cauchy stress (n, 3, 3) in Pa at ``height`` (n,) in m.

    Zero above the surface.  The horizontal stress is K0 of ``material`` (n,), by default the one
    that lies there, times the vertical stress.

    ``vertical`` is the index of the vertical axis; d sigma_v / dz = unit weight.
    """
    rows = strata(ground)
    depth = -np.minimum(height, 0.0)
    here = material_at(ground, height)
    top = np.array([row.top for row in rows])
    at_top = np.array([row.stress_at_top for row in rows])
    vertical_stress = at_top[here] - unit_weights(ground)[here] * (depth - top[here])
    k0 = np.array([row.k0 for row in rows])[here if material is None else material]
    stress = np.zeros((len(height), 3, 3))
    for axis in range(3):
        stress[:, axis, axis] = vertical_stress * (1.0 if axis == vertical else k0)
    return stress


def hydrostatic_pressure(ground: GroundProfile, height: np.ndarray) -> np.ndarray:
    """Return the hydrostatic pore pressure (n,) in Pa at ``height`` (n,) in m, zero above water."""
    if ground.water_table is None:
        return np.zeros(len(height))
    pressure: np.ndarray = WATER_UNIT_WEIGHT * np.maximum(-height - ground.water_table, 0.0)
    return pressure


def undrained_shear_strength(ground: GroundProfile, height: np.ndarray) -> np.ndarray:
    """Return the undrained shear strength (n,) in Pa of the ground at ``height``, zero if none."""
    strength = np.zeros(len(height))
    row, depth = material_at(ground, height), np.maximum(-height, 0.0)
    stress = geostatic_stress(ground, height, vertical=1)
    for number, stratum in enumerate(strata(ground)):
        here = row == number
        if here.any():
            strength[here] = soil_strength.undrained_shear_strength(
                stratum.layer.soil, depth[here], stress[here]
            )
    return strength
