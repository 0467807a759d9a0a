"""The physical parameters of a reference problem: what they are, and their values from text."""

from __future__ import annotations

import enum
import inspect
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

from install_mpm.conventions import Unit
from workflows.errors import CaseError
from workflows.quantities import parse_quantity
from workflows.verification.problem import Problem
from workflows.verification.ranges import check_value

WORDS = {"true": True, "yes": True, "on": True, "false": False, "no": False, "off": False}


@dataclass(frozen=True)
class Parameter:
    """One keyword of a problem's function."""

    name: str
    kind: Any
    """``float``, ``int``, ``bool``, ``str``, an enumeration or a ``Literal`` of words."""
    unit: Unit | None
    """SI unit; None if the parameter has no dimension."""
    default: Any

    def format(self, value: Any) -> str:
        """Return a value as it is shown, angles in degrees."""
        if isinstance(value, enum.Enum):
            return value.name.lower()
        if isinstance(value, bool):
            return "yes" if value else "no"
        if not isinstance(value, float):
            return str(value)
        if self.unit is None:
            return f"{value:.6g}"
        if self.unit.symbol == "rad":
            return f"{math.degrees(value):.6g} deg"
        return f"{value:.6g} {self.unit.symbol}"


def parameters_of(problem: Problem) -> dict[str, Parameter]:
    """Return the parameters of ``problem`` by name, in the order of its function."""
    hints = get_type_hints(problem.run, include_extras=True)
    return {
        name: _parameter(name, hints[name], keyword.default)
        for name, keyword in inspect.signature(problem.run).parameters.items()
    }


def _parameter(name: str, hint: Any, default: Any) -> Parameter:
    unit = None
    if get_origin(hint) is Annotated:
        unit = next((note for note in get_args(hint)[1:] if isinstance(note, Unit)), None)
        hint = get_args(hint)[0]
    return Parameter(name, hint, unit, default)


def read_assignments(problem: Problem, assignments: Iterable[str]) -> dict[str, Any]:
    """Return values from texts such as ``b=2``, ``G=10 MPa`` or ``phi=24 deg``.

    A number without unit is in SI.

    Raises
    ------
    CaseError
        If a text has no "=", the problem has no such parameter, or the value does not suit it.
    """
    known = parameters_of(problem)
    values = {}
    for assignment in assignments:
        name, equals, text = (part.strip() for part in assignment.partition("="))
        if not equals or not name or not text:
            raise CaseError(f"--set {assignment}: write --set key=value, e.g. --set nu=0.3")
        if name not in known:
            names = ", ".join(f"{one.name} = {one.format(one.default)}" for one in known.values())
            raise CaseError(f"{problem.identifier} has no parameter {name!r}; it has {names}")
        try:
            values[name] = read_value(known[name], text)
        except CaseError as error:
            raise CaseError(f"{problem.identifier}: {name}: {error}") from error
    return values


def read_value(parameter: Parameter, text: str) -> Any:
    """Return ``text`` as a value of the parameter; a number without unit is in SI.

    Raises
    ------
    CaseError
        If it does not suit the parameter.
    """
    value = _typed(parameter, text)
    symbol = parameter.unit.symbol if parameter.unit else ""
    check_value(parameter.name, symbol, parameter.default, value)
    return value


def _typed(parameter: Parameter, text: str) -> Any:
    """Return ``text`` in the type of the parameter."""
    kind = parameter.kind
    if kind is bool:
        return _choose(text, WORDS)
    if get_origin(kind) is Literal:
        return _choose(text, {str(word): word for word in get_args(kind)})
    if isinstance(kind, type) and issubclass(kind, enum.Enum):
        return _choose(text, {member.name.lower(): member for member in kind})
    if kind is int:
        try:
            return int(text)
        except ValueError:
            raise CaseError(f"{text!r} is not a whole number") from None
    return _number(text, parameter.unit) if kind is float else text


def _choose(text: str, choices: dict[str, Any]) -> Any:
    if text.casefold() not in choices:
        raise CaseError(f"{text!r} is none of {', '.join(choices)}")
    return choices[text.casefold()]


def _number(text: str, unit: Unit | None) -> float:
    """Return a finite number, with a unit if the parameter has one."""
    try:
        value = float(text)
    except ValueError:
        if unit is None:
            raise CaseError(f"{text!r} is not a number; this parameter has no unit") from None
        return parse_quantity(text, unit)
    if not math.isfinite(value):
        raise CaseError(f"{text!r} is not finite")
    return value
