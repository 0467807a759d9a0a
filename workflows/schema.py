"""Tables of a case file <-> frozen dataclasses, steered by the annotations of the dataclasses.

The packages' option dataclasses are the only definition of a key: its name, type, unit, range and
default.  pydantic checks each value; this module walks the tables, converts quantities and chooses
among alternatives (soils, programmes) by their tag, a ``Literal`` field.
"""

from __future__ import annotations

import types
from collections.abc import Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
from difflib import get_close_matches
from enum import Enum
from functools import cache
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

from install_mpm.conventions import Unit
from workflows.errors import CaseError
from workflows.quantities import format_quantity, parse_quantity

Table = dict[str, Any]

RANGE_ERRORS = (
    "greater_than", "greater_than_equal", "less_than", "less_than_equal", "literal_error"
)  # fmt: skip


def build(record: Any, table: object, key: str = "") -> Any:
    """Return the dataclass ``record`` (or the alternative of a union) made from a TOML ``table``.

    Raises
    ------
    CaseError
        With the dotted key, what is wrong and the remedy, at the first thing that is wrong.
    """
    if not isinstance(table, Mapping):
        raise CaseError(f"{key} is {table!r}, but a table is needed; write [{key}] above its keys")
    chosen = choose(record, table, key)
    hints = hints_of(chosen)
    _check_keys(chosen, table, key)
    values = {
        name: _value(hints[name], table[name], f"{key}.{name}" if key else name) for name in table
    }
    try:
        return chosen(**values)
    except ValueError as error:  # a contradiction between values, told by the dataclass itself
        raise CaseError(f"{key}: {error}" if key else str(error)) from error


def choose(record: Any, table: Mapping[str, Any], key: str) -> type:
    """Return the dataclass that ``table`` describes: ``record``, or the one that has its tag."""
    alternatives = alternatives_of(record)
    if len(alternatives) == 1:
        return alternatives[0]
    if not any(map(is_tag, hints_of(alternatives[0]).values())):
        return _one_or_many(alternatives, table)
    tag = tag_of(alternatives[0])
    known = {tag_value(alternative): alternative for alternative in alternatives}
    if tag not in table:
        names = ", ".join(f'"{name}"' for name in known)
        raise CaseError(f"{key}.{tag} is missing; set it to one of {names}")
    if table[tag] not in known:
        raise CaseError(f"{key}.{tag} is {table[tag]!r}; {suggestion(str(table[tag]), known)}")
    return known[table[tag]]


def _one_or_many(alternatives: tuple[Any, ...], table: Mapping[str, Any]) -> type:
    """Return the alternative with a list that the ``table`` has, else the one without lists.

    A thing may be written as one, or as a list of its parts; the list is the tag.
    """
    lists = {
        name: alternative
        for alternative in alternatives
        for name, hint in hints_of(alternative).items()
        if item_type(hint) is not None
    }
    meant = [lists[name] for name in table if name in lists]
    chosen: type = [*meant, *(a for a in alternatives if a not in lists.values())][0]
    return chosen


def _check_keys(record: type, table: Mapping[str, Any], key: str) -> None:
    prefix = f"{key}." if key else ""
    names = {field.name: field for field in fields(record)}
    for name in table:
        if name not in names:
            raise CaseError(f"{prefix}{name} is not a known key; {suggestion(name, names)}")
    for name, field in names.items():
        if name not in table and is_required(field):
            hint = hints_of(record)[name]
            raise CaseError(f"{prefix}{name} is missing; add it, e.g. {_example(name, hint, key)}")


def _example(name: str, hint: Any, key: str) -> str:
    unit = unit_of(hint)
    if unit is not None:
        return f'{name} = "1.5 {unit.symbol}"'
    if item_type(hint) is not None:
        return f"a [[{key}.{name}]] table"
    if is_dataclass(alternatives_of(hint)[0]):
        return f"a [{f'{key}.' if key else ''}{name}] table"
    return f'{name} = "text"' if hint is str else f"{name} = 1"


def suggestion(name: str, known: Mapping[str, object]) -> str:
    """Return what to write in place of ``name``: the nearest of the ``known``, or all of them."""
    nearest = get_close_matches(name, known, n=1, cutoff=0.6)
    if nearest:
        return f'did you mean "{nearest[0]}"?'
    return "use one of " + ", ".join(known)


def _value(hint: Any, value: object, key: str) -> Any:
    unit, item = unit_of(hint), item_type(hint)
    if unit is not None:
        try:
            value = parse_quantity(value, unit)
        except CaseError as error:
            raise CaseError(f"{key}: {error}") from error
    elif item is not None:
        if not isinstance(value, list):
            raise CaseError(f"{key} is {value!r}, but a list is needed; write [[{key}]] tables")
        return tuple(build(item, entry, f"{key}[{n}]") for n, entry in enumerate(value, 1))
    elif is_dataclass(alternatives_of(hint)[0]):
        return build(hint, value, key)
    elif is_enumeration(hint):
        return _member(hint, value, key)
    return _checked(hint, value, key, unit)


def _member(kind: type[Enum], value: object, key: str) -> Enum:
    """Return the member of an enumeration that ``value`` names."""
    members = {member.name.lower(): member for member in kind}
    if not isinstance(value, str) or value not in members:
        raise CaseError(f"{key} is {value!r}, but it must be {range_of(kind)}")
    return members[value]


def _checked(hint: Any, value: object, key: str, unit: Unit | None) -> Any:
    """Return ``value`` after pydantic's checks of type and range."""
    from pydantic import ValidationError

    try:
        return _adapter(hint).validate_python(value)
    except ValidationError as error:
        shown = format_quantity(value, unit) if unit and isinstance(value, float) else repr(value)
        problem = error.errors()[-1 if isinstance(value, str) else 0]  # a union's texts come last
        if problem["type"] in RANGE_ERRORS:
            in_unit = f" {unit.symbol}" if unit else ""
            raise CaseError(
                f"{key} is {shown}, but it must be {range_of(hint)}{in_unit}"
            ) from error
        raise CaseError(f"{key} is {shown}; {problem['msg'].replace('Input', 'it')}") from error


@cache
def _adapter(hint: Any) -> Any:
    from pydantic import ConfigDict, TypeAdapter

    return TypeAdapter(hint, config=ConfigDict(strict=True, allow_inf_nan=False))


# --- what an annotation says ----------------------------------------------------------------------


@cache
def hints_of(record: type) -> dict[str, Any]:
    """Return the annotations of a dataclass by field name, in the order of its fields."""
    hints = get_type_hints(record, include_extras=True)
    return {field.name: hints[field.name] for field in fields(record)}


def is_required(field: Field[Any]) -> bool:
    """Return whether a field has no default."""
    return field.default is MISSING and field.default_factory is MISSING


def _metadata(hint: Any) -> tuple[Any, ...]:
    return getattr(hint, "__metadata__", ())


def unit_of(hint: Any) -> Unit | None:
    """Return the unit of a dimensional key, None for a number or text without one."""
    return next((item for item in _metadata(hint) if isinstance(item, Unit)), None)


def range_of(hint: Any) -> str:
    """Return the allowed range in words, e.g. "> 0 and <= 1", or the allowed values."""
    if get_origin(hint) in (Union, types.UnionType):
        return " or ".join(filter(None, map(range_of, get_args(hint))))
    signs = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}
    limits = [
        f"{sign} {getattr(item, name):g}"
        for item in _metadata(hint)
        for name, sign in signs.items()
        if hasattr(item, name)
    ]
    bare = get_args(hint)[0] if get_origin(hint) is Annotated else hint
    if get_origin(bare) is Literal:
        return "one of " + ", ".join(f'"{value}"' for value in get_args(bare))
    if is_enumeration(bare):
        return "one of " + ", ".join(f'"{member.name.lower()}"' for member in bare)
    return " and ".join(limits)


def item_type(hint: Any) -> Any:
    """Return the type of the entries of a ``tuple[Entry, ...]``, None for anything else."""
    bare = get_args(hint)[0] if get_origin(hint) is Annotated else hint
    arguments = get_args(bare)
    if get_origin(bare) is tuple and len(arguments) == 2 and arguments[1] is Ellipsis:
        return arguments[0]
    return None


def alternatives_of(hint: Any) -> tuple[Any, ...]:
    """Return the members of a union but None, or the one type that ``hint`` is."""
    bare = get_args(hint)[0] if get_origin(hint) is Annotated else hint
    if get_origin(bare) not in (Union, types.UnionType):
        return (bare,)
    return tuple(member for member in get_args(bare) if member is not types.NoneType)


def is_enumeration(hint: Any) -> bool:
    """Return whether a key takes the name of a member of an enumeration."""
    return isinstance(hint, type) and issubclass(hint, Enum)


def is_tag(hint: Any) -> bool:
    """Return whether a field has one fixed value, which tells the alternatives of a union apart."""
    return get_origin(hint) is Literal and len(get_args(hint)) == 1


def tag_of(record: type) -> str:
    """Return the name of the field that tells the alternatives of a union apart."""
    return next(name for name, hint in hints_of(record).items() if is_tag(hint))


def tag_value(record: type) -> str:
    """Return the value of the tag of an alternative."""
    (value,) = get_args(hints_of(record)[tag_of(record)])
    return str(value)


# --- back to tables -------------------------------------------------------------------------------


def table_of(record: Any) -> Table:
    """Return the TOML table of a dataclass instance, defaults filled in and quantities in SI."""
    record_type: Any = type(record)
    hints = hints_of(record_type)
    return {
        name: _plain(getattr(record, name), hint)
        for name, hint in hints.items()
        if getattr(record, name) is not None
    }


def _plain(value: Any, hint: Any) -> Any:
    if is_dataclass(value):
        return table_of(value)
    if isinstance(value, Enum):
        return value.name.lower()
    if isinstance(value, tuple):
        return [_plain(entry, item_type(hint)) for entry in value]
    unit = unit_of(hint)
    return format_quantity(value, unit) if unit else value
