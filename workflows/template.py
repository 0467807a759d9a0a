"""A commented case file made from the option dataclasses: keys with unit, range, default."""

from __future__ import annotations

import ast
import inspect
import textwrap
from dataclasses import fields, is_dataclass
from typing import Any

from workflows.case import Case
from workflows.schema import (
    alternatives_of,
    choose,
    hints_of,
    is_enumeration,
    is_required,
    is_tag,
    item_type,
    range_of,
    table_of,
    tag_of,
    tag_value,
    unit_of,
)
from workflows.schema import build as build_record
from workflows.toml_text import format_toml

WIDTH = 100

HEADING = """\
# A case of screwpile. Every key is listed; those with a default may be left out.
# A quantity is a text with its unit, any unit of the right dimension: "20 kPa", "0.5 m", "24 deg".
# Half model x >= 0 (or r >= 0), z up, ground surface z = 0; displacements positive downward.

"""

EXAMPLE: dict[str, Any] = {
    "title": "Pile jacked into clay",
    "ground": {
        "unit_weight": "18 kN/m^3",
        "k0": 1.0,
        "soil": {
            "model": "von_mises",
            "youngs_modulus": "4 MPa",
            "poissons_ratio": 0.49,
            "undrained_shear_strength": "20 kPa",
            "undrained_shear_strength_gradient": "0 kPa/m",
        },
    },
    "pile": {"half_width": "0.5 m", "embedment": "4 m", "unit_weight": "18 kN/m^3"},
    "interface": {
        "normal_stiffness": "200 MPa/m",
        "shear_stiffness": "20 MPa/m",
        "adhesion_factor": 0.5,
    },
    "box": {"width": "8 m", "depth": "12 m", "headroom": "0.75 m"},
    "background_mesh": {"size_at_pile": "0.125 m", "size_far": "1 m"},
    "installation": {"penetration": "1 m", "step": "20 mm"},
    "numerics": {},
    "handoff": {"size_at_pile": "0.1 m", "size_far": "1 m"},
    "service": {
        "programmes": [
            {"kind": "release", "name": "release"},
            {"kind": "displace", "name": "compression", "displacement": "0.1 m", "step": "4 mm"},
        ]
    },
    "comparison": {},
}
"""What the template shows for keys without a default."""


def template_text() -> str:
    """Return a commented case file that is valid as it stands."""
    build_record(Case, EXAMPLE)
    document, comments = commented_table(Case, EXAMPLE, "")
    return HEADING + format_toml(document, lambda key: comments.get(key, ([], "")))


def commented_table(
    record: type, example: dict[str, Any], path: str
) -> tuple[dict[str, Any], dict[str, tuple[list[str], str]]]:
    """Return ``example`` with the defaults of ``record``, and comments by dotted key."""
    comments: dict[str, tuple[list[str], str]] = {}
    return _with_defaults(record, example, path, comments), comments


def _with_defaults(
    record: type, example: dict[str, Any], path: str, comments: dict[str, tuple[list[str], str]]
) -> dict[str, Any]:
    """Return ``example`` with the defaults of ``record``; fills ``comments`` by dotted key."""
    docs = attribute_docs(record)
    hints = hints_of(record)
    defaults = _defaults(record)
    document: dict[str, Any] = {}
    for name in sorted(hints, key=lambda name: _rank(name, hints, example)):
        key, hint = f"{path}.{name}" if path else name, hints[name]
        value = example.get(name, defaults.get(name))
        if value is None:
            continue
        inner = item_type(hint) or hint
        if is_dataclass(alternatives_of(inner)[0]):
            entries = value if isinstance(value, list) else [value]
            filled = [_with_defaults(choose(inner, e, key), e, key, comments) for e in entries]
            document[name] = filled if isinstance(value, list) else filled[0]
            comments[key] = (_section_comment(inner, docs.get(name, "")), "")
        else:
            document[name] = value
            behind = "" if is_tag(hint) else _facts(hint, defaults.get(name), name in defaults)
            comments[key] = (wrapped(docs.get(name, "")), behind)
    return document


def _rank(name: str, hints: dict[str, Any], example: dict[str, Any]) -> int:
    """Return the place of a key: the tag first, then what the example sets, then defaults."""
    return 0 if is_tag(hints[name]) else 1 if name in example else 2


def _defaults(record: type) -> dict[str, Any]:
    """Return the defaults of a dataclass as they would stand in a case file."""
    required = {field.name: 0.0 for field in fields(record) if is_required(field)}
    table = table_of(record(**required)) if len(required) < len(fields(record)) else {}
    return {name: value for name, value in table.items() if name not in required}


def _facts(hint: Any, default: Any, has_default: bool) -> str:
    unit = unit_of(hint)
    facts = [unit.symbol if unit else "", range_of(hint)]
    if has_default and not is_enumeration(hint):
        facts.append(f"default {default}")
    return ", ".join(fact for fact in facts if fact)


def _section_comment(hint: Any, doc: str) -> list[str]:
    """Return the comment above a table: what it is, and its alternatives if there are several."""
    alternatives = alternatives_of(hint)
    if len(alternatives) == 1:
        return wrapped(doc or _first_paragraph(alternatives[0]))
    if not any(map(is_tag, hints_of(alternatives[0]).values())):
        return wrapped(doc or _first_paragraph(alternatives[0])) + _instead(alternatives[1:])
    lines = [*wrapped(doc), f"One of the following, told apart by {tag_of(alternatives[0])}:"]
    for alternative in alternatives:
        keys = ", ".join(
            name + ("" if is_required(field) else " (optional)")
            for name, field in ((field.name, field) for field in fields(alternative))
            if name != tag_of(alternative)
        )
        text = f'"{tag_value(alternative)}": {_first_paragraph(alternative)} Keys: {keys}.'
        text = text.replace("``", "")
        lines += textwrap.wrap(text, WIDTH - 4, initial_indent="  ", subsequent_indent="    ")
    return lines


def _instead(alternatives: tuple[Any, ...]) -> list[str]:
    """Return the lines that tell of the other ways to write a table."""
    return [
        line
        for alternative in alternatives
        for line in wrapped(
            f"Or: {_first_paragraph(alternative)} Keys: {', '.join(hints_of(alternative))}."
        )
    ]


def _first_paragraph(record: type) -> str:
    return (inspect.getdoc(record) or "").split("\n\n")[0]


def wrapped(text: str) -> list[str]:
    """Return ``text`` as lines of comment."""
    return textwrap.wrap(text.replace("``", ""), WIDTH - 2)


def attribute_docs(record: type) -> dict[str, str]:
    """Return the docstrings that stand below the fields of a dataclass, by field name."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(record))).body[0]
    assert isinstance(tree, ast.ClassDef)
    docs = {}
    for field, after in zip(tree.body, tree.body[1:], strict=False):
        if (
            isinstance(field, ast.AnnAssign)
            and isinstance(field.target, ast.Name)
            and isinstance(after, ast.Expr)
            and isinstance(after.value, ast.Constant)
        ):
            docs[field.target.id] = inspect.cleandoc(str(after.value.value))
    return docs
