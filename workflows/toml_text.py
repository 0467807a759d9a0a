"""TOML text of nested tables: the canonical text of a case, and the commented template."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any

Comments = Callable[[str], tuple[list[str], str]]
"""Dotted key -> lines of comment above the key, and the comment behind it."""


def no_comments(_key: str) -> tuple[list[str], str]:
    """Return no comment for any key."""
    return [], ""


def format_toml(document: Mapping[str, Any], comments: Comments = no_comments) -> str:
    """Return nested tables as TOML text: plain keys first, then tables, in their own order."""
    lines = _table_lines(document, "", comments)
    while lines and not lines[0]:
        lines.pop(0)
    return "\n".join(lines) + "\n"


def _table_lines(table: Mapping[str, Any], path: str, comments: Comments) -> list[str]:
    prefix = f"{path}." if path else ""
    lines: list[str] = []
    for key, value in table.items():
        if not _is_table(value):
            above, behind = comments(prefix + key)
            line = f"{key} = {_text(value)}"
            lines += [f"# {text}" for text in above]
            lines.append(f"{line:<40}  # {behind}" if behind else line)
    for key, value in table.items():
        if _is_table(value):
            lines += _header_lines(value, prefix + key, comments)
    return lines


def _header_lines(value: Any, path: str, comments: Comments) -> list[str]:
    above = [f"# {text}" for text in comments(path)[0]]
    if isinstance(value, Mapping):
        return ["", *above, f"[{path}]", *_table_lines(value, path, comments)]
    lines: list[str] = []
    for entry in value:
        lines += ["", *above, f"[[{path}]]", *_table_lines(entry, path, comments)]
        above = []
    return lines


def _is_table(value: Any) -> bool:
    return isinstance(value, Mapping) or (
        isinstance(value, list) and bool(value) and isinstance(value[0], Mapping)
    )


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_text(item) for item in value) + "]"
    if isinstance(value, float):
        return repr(value)
    return str(value)
