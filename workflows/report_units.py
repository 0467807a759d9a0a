"""Display units: the only place where SI values become kPa, kN/m and mm."""

from __future__ import annotations

import math
from enum import Enum
from typing import Any

from install_mpm.conventions import Kinematics

DISPLAY = {
    "m": (1.0, "m"),
    "N/m^3": (1e-3, "kN/m³"),
    "Pa": (1e-3, "kPa"),
    "Pa/m": (1e-3, "kPa/m"),
    "rad": (180.0 / math.pi, "°"),
}
"""Factor and name of the display unit of each SI unit."""

EXTENSIVE = {
    Kinematics.PLANE_STRAIN: {
        "m^3": (1.0, "m³/m"),
        "kg": (1e-3, "t/m"),
        "N": (1e-3, "kN/m"),
        "N/m": (1e-6, "kN/m per mm"),
    },
    Kinematics.AXISYMMETRIC: {
        "m^3": (1.0, "m³"),
        "kg": (1e-3, "t"),
        "N": (1e-3, "kN"),
        "N/m": (1e-6, "kN/mm"),
    },
    Kinematics.THREE_D: {
        "m^3": (1.0, "m³"),
        "kg": (1e-3, "t"),
        "N": (1e-3, "kN"),
        "N m": (1e-3, "kN m"),
        "J": (1e-3, "kJ"),
    },
}
"""The same for what is counted per metre run of a wall, or for the whole of a pile."""

FORCE_UNIT = {kinematics: units["N"][1] for kinematics, units in EXTENSIVE.items()} | {
    Kinematics.THREE_D: "kN"
}
"""Display unit of a force."""

PER_LENGTH = {
    Kinematics.PLANE_STRAIN: "Whole pile, per metre run.",
    Kinematics.AXISYMMETRIC: "Whole round pile.",
    Kinematics.THREE_D: "Whole pile.",
}
"""What forces are for, in words."""

ROUND_OFF = 1e-9
"""A quantity with a unit is shown as zero below this, in display units."""

SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def shown(
    value: float | None,
    unit: str = "",
    digits: int = 4,
    kinematics: Kinematics = Kinematics.PLANE_STRAIN,
) -> str:
    """Return ``value`` in SI ``unit`` as text with its display unit; a dash if there is none."""
    if value is None:
        return "–"
    factor, name = (DISPLAY | EXTENSIVE[kinematics]).get(unit, (1.0, unit))
    scaled = factor * value
    if unit and abs(scaled) < ROUND_OFF:
        scaled = 0.0
    return f"{significant(scaled, digits)} {name}".rstrip()


def significant(value: float, digits: int = 4) -> str:
    """Return a number with some significant digits, as a power of ten only if it is tiny."""
    if value == 0.0:
        return "0"
    if abs(value) < 1e-3:
        mantissa, exponent = f"{value:.1e}".split("e")
        return f"{mantissa} × 10{str(int(exponent)).translate(SUPERSCRIPT)}".replace("-", "−")
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(value))))
    return f"{value:.{decimals}f}".replace("-", "−")


def value_and_range(value: float | None, deviation: float | None) -> str:
    """Return a ratio as text, with its range if it has one; a dash if there is none."""
    if value is None:
        return "–"
    return significant(value, 3) if deviation is None else f"{value:.3f} ± {deviation:.3f}"


def plain(value: Any, unit: str = "") -> str:
    """Return an option of a case as text: numbers without trailing zeros, words as they are."""
    if isinstance(value, Enum):
        value = value.name.lower()
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value).replace("_", " ")
    factor, name = DISPLAY.get(unit, (1.0, unit))
    scaled = factor * value
    text = significant(scaled) if 0.0 < abs(scaled) < 1e-3 else f"{scaled:.6g}".replace("-", "−")
    return f"{text} {name}".rstrip()
