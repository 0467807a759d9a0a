"""Changes to a case from the command line: ``--set section.key=value``."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from typing import Any

from workflows.errors import CaseError


def apply_overrides(document: dict[str, Any], overrides: Iterable[str]) -> list[str]:
    """Change the parsed ``document`` in place; return the dotted keys that were set.

    An entry of a list is named by its ``name`` or by its number, counted from 1:
    ``service.programmes.uplift.step=5 mm``.

    Raises
    ------
    CaseError
        If an override has no "=", or leads through something that is not a table.
    """
    keys = []
    for override in overrides:
        key, equals, text = override.partition("=")
        key = key.strip()
        if not equals or not all(key.split(".")):
            raise CaseError(f"--set {override}: write --set section.key=value")
        *parents, name = key.split(".")
        table: Any = document
        for parent in parents:
            table = _inner_table(table, parent, override)
        if not isinstance(table, dict):
            raise CaseError(f"--set {override}: {'.'.join(parents)} holds no keys")
        table[name] = parse_value(text)
        keys.append(key)
    return keys


def _inner_table(table: Any, name: str, override: str) -> Any:
    if isinstance(table, dict):
        return table.setdefault(name, {})
    if isinstance(table, list):
        for number, entry in enumerate(table, 1):
            if name in (str(number), entry.get("name") if isinstance(entry, dict) else None):
                return entry
        names = ", ".join(str(entry.get("name")) for entry in table if isinstance(entry, dict))
        raise CaseError(f"--set {override}: there is no entry {name!r}; use one of {names}")
    raise CaseError(f"--set {override}: {name!r} lies inside a value; write section.key=value")


def parse_value(text: str) -> Any:
    """Return ``text`` typed as TOML would; what is no TOML value, e.g. 0.5 m, is a string."""
    try:
        return tomllib.loads(f"value = {text.strip()}")["value"]
    except (tomllib.TOMLDecodeError, KeyError):
        return text.strip()
