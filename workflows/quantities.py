"""Quantity strings such as "20 kPa": read once, converted to SI, written back in SI."""

from __future__ import annotations

import math
import re
from functools import cache
from typing import TYPE_CHECKING

from install_mpm.conventions import Unit
from workflows.errors import CaseError

if TYPE_CHECKING:
    import pint

QUANTITY = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([^\s\d.].*?)\s*")


@cache
def _registry() -> pint.UnitRegistry[float]:
    import pint

    return pint.UnitRegistry()


def parse_quantity(value: object, unit: Unit) -> float:
    """Return a quantity string, e.g. "20 kPa", as a number in ``unit``.

    Raises
    ------
    CaseError
        If it has no unit, an unknown one or one of another dimension, or is not a finite number.
    """
    if isinstance(value, int | float) and not isinstance(value, bool):
        raise CaseError(f'{value} has no unit; write it with one, e.g. "{value} {unit.symbol}"')
    match = QUANTITY.fullmatch(value) if isinstance(value, str) else None
    if match is None:
        raise CaseError(
            f'{value!r} is not a quantity; write a number and its unit, e.g. "1.5 {unit.symbol}"'
        )
    number, symbol = float(match[1]), match[2]
    factor = _factor(symbol, unit)
    if not math.isfinite(number * factor):
        raise CaseError(f"{value!r} is too large; give a finite number")
    # one rounding only: "18 kN/m^3" becomes 18000.0 and "0.1 mm" the float nearest to 0.0001
    return (
        number / (1.0 / factor) if factor < 1.0 and (1.0 / factor).is_integer() else number * factor
    )


@cache
def _factor(symbol: str, unit: Unit) -> float:
    """Return how many ``unit`` one ``symbol`` is."""
    import pint

    registry = _registry()
    try:
        given = registry.Quantity(1.0, symbol)
        if given.units == registry.Unit(unit.symbol):
            return 1.0
        return float(given.to(unit.symbol).magnitude)
    except pint.DimensionalityError as error:
        expected = _dimension(unit.symbol)
        raise CaseError(
            f"{symbol!r} is {_dimension(symbol)}, but {expected} is needed; "
            f"use a unit such as {unit.symbol!r}"
        ) from error
    except Exception as error:  # pint raises errors of many kinds on text that is no unit
        raise CaseError(f"{symbol!r} is not a unit; use one such as {unit.symbol!r}") from error


def _dimension(symbol: str) -> str:
    """Return the dimension of a unit in words if it is a common one, else in pint's notation."""
    registry = _registry()
    dimension = registry.Unit(symbol).dimensionality
    for name, example in COMMON_DIMENSIONS.items():
        if registry.Unit(example).dimensionality == dimension:
            return name
    return f"a quantity of dimension {dimension}"


COMMON_DIMENSIONS = {
    "a length": "m",
    "an area": "m^2",
    "a time": "s",
    "a mass": "kg",
    "a force": "N",
    "a pressure or stress": "Pa",
    "a weight per volume or stress per length": "N/m^3",
    "a force per length": "N/m",
    "a density": "kg/m^3",
    "an angle or a plain number": "rad",
}


def format_number(value: float) -> str:
    """Return the shortest text that reads back as exactly the same number."""
    return repr(value).removesuffix(".0")


def format_quantity(value: float, unit: Unit) -> str:
    """Return the quantity string of ``value`` in ``unit``, which reads back as the same number."""
    return f"{format_number(value)} {unit.symbol}"
