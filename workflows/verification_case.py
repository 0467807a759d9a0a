"""A case of ``screwpile verify``: a TOML file with a reference problem and its parameters.

    title = "..."
    problem = "FIG6"

    [parameters]
    E = "10 kPa"

Parameters are those of the problem (``screwpile verify --list``); one that has a dimension is a
quantity with its unit, as in every case, and one that is left out has its default.
"""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from workflows.errors import CaseError
from workflows.quantities import parse_quantity
from workflows.verification import registry
from workflows.verification.parameters import Parameter, parameters_of, read_value
from workflows.verification.problem import Problem
from workflows.verification.runner import Run

SUFFIX = ".toml"
KEYS = ("title", "problem", "parameters")


def read_problem_case(path: Path) -> Run:
    """Return the problem that the TOML file ``path`` names, with its values.

    Raises
    ------
    CaseError
        In one sentence: the file, the key, what is wrong and the remedy.
    """
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise CaseError(f"{path}: no such file; give the path of a case file") from error
    except (OSError, UnicodeDecodeError) as error:
        raise CaseError(f"{path}: cannot be read as text ({error}); give a TOML file") from error
    except tomllib.TOMLDecodeError as error:
        raise CaseError(f"{path}: not valid TOML: {error}; correct that line") from error
    try:
        return _run_of(document, path.stem)
    except CaseError as error:
        raise CaseError(f"{path}: {error}") from error


def _run_of(document: Mapping[str, Any], name: str) -> Run:
    _check_keys(document, KEYS, "")
    for key in ("title", "problem"):
        if not isinstance(document.get(key), str):
            raise CaseError(f'{key} is missing or no text; add it, e.g. {key} = "FIG6"')
    problem = registry.problem(document["problem"])
    table = document.get("parameters", {})
    if not isinstance(table, Mapping):
        raise CaseError("parameters is no table; write [parameters] above its keys")
    return Run(problem, _values(problem, table), name, document["title"])


def _values(problem: Problem, table: Mapping[str, Any]) -> dict[str, Any]:
    known = parameters_of(problem)
    _check_keys(table, known, "parameters.")
    values = {}
    for name, value in table.items():
        try:
            values[name] = _value(known[name], value)
        except CaseError as error:
            raise CaseError(f"parameters.{name}: {error}") from error
    return values


def _check_keys(table: Mapping[str, Any], known: Iterable[str], prefix: str) -> None:
    names = list(known)
    for name in table:
        if name not in names:
            near = difflib.get_close_matches(name, names, n=1)
            hint = f'did you mean "{near[0]}"?' if near else "use one of " + ", ".join(names)
            raise CaseError(f"{prefix}{name} is not a known key; {hint}")


def _value(parameter: Parameter, value: object) -> Any:
    """Return a TOML value as one of the parameter; quantities have their unit."""
    if parameter.unit is not None:
        return read_value(parameter, repr(parse_quantity(value, parameter.unit)))
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if parameter.kind in (int, float) and not is_number:
        raise CaseError(f"{value!r} is not a number")
    if parameter.kind is bool and not isinstance(value, bool):
        raise CaseError(f"{value!r} is neither true nor false")
    if parameter.kind not in (int, float, bool) and not isinstance(value, str):
        raise CaseError(f"{value!r} is no text")
    return read_value(parameter, str(value).lower() if isinstance(value, bool) else str(value))
