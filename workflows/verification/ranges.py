"""Which values of a parameter have a meaning: told from its unit, its symbol and its default.

Symbols are those of the references: nu is a Poisson's ratio, E, G and su are a modulus or strength,
phi, psi and delta are angles of friction, alpha is a share.  What a rule does not know is free.
"""

from __future__ import annotations

import math
import re
from typing import Any, NamedTuple

from workflows.errors import CaseError

POSITIVE_UNITS = ("m", "Pa/m", "kg/m^3", "m/s^2", "N")
MODULUS = re.compile(r"(E|G|su)(_ground)?|Ep|tau_y")
ANGLE = re.compile(r"phi|psi|delta")
SHARE = re.compile(r"alpha(_\d+)?")
SIGNED = re.compile(r"(sigma|tau)_(?!y$)\w+")


class Range(NamedTuple):
    """Limits of a value in SI and whether they belong to it; infinite if there is none."""

    low: float = -math.inf
    high: float = math.inf
    has_low: bool = False
    has_high: bool = False

    def holds(self, value: float) -> bool:
        """Return whether ``value`` lies in the range."""
        is_above = value > self.low or (self.has_low and value == self.low)
        return is_above and (value < self.high or (self.has_high and value == self.high))

    def in_words(self, unit: str) -> str:
        """Return the range as text."""
        words = []
        if math.isfinite(self.low):
            words.append(f"{'at least' if self.has_low else 'above'} {self.low:g}{unit}")
        if math.isfinite(self.high):
            words.append(f"{'at most' if self.has_high else 'below'} {self.high:g}{unit}")
        return " and ".join(words)


ABOVE_ZERO, FROM_ZERO, ANY = Range(0.0), Range(0.0, has_low=True), Range()
POISSONS_RATIO = Range(-1.0, 0.5)
COUNT = Range(1.0, has_low=True)
FRICTION = Range(0.0, math.pi / 2.0, has_low=True)
UNIT_SHARE = Range(0.0, 1.0, has_low=True, has_high=True)


def range_of_values(name: str, unit: str, default: Any) -> Range:
    """Return the range of the parameter ``name`` with ``unit`` ("" for none) and ``default``."""
    if isinstance(default, bool) or not isinstance(default, int | float):
        return ANY
    if isinstance(default, int):
        return COUNT
    if name == "nu":
        return POISSONS_RATIO
    if ANGLE.fullmatch(name) and unit == "rad":
        return FRICTION
    if SHARE.fullmatch(name):
        return UNIT_SHARE
    if default < 0.0 or SIGNED.fullmatch(name):
        return ANY
    if not unit or unit in POSITIVE_UNITS or MODULUS.fullmatch(name):
        return ABOVE_ZERO
    return FROM_ZERO


def check_value(name: str, unit: str, default: Any, value: Any) -> None:
    """Check that ``value`` has a meaning for a parameter.

    Raises
    ------
    CaseError
        With the range, if it has none.
    """
    allowed, shown = range_of_values(name, unit, default), f" {unit}" if unit else ""
    if allowed is not ANY and not allowed.holds(value):
        raise CaseError(f"{value:g}{shown} has no meaning; it has to be {allowed.in_words(shown)}")
