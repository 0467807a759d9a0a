"""Annotated NamedTuples of arrays and their HDF5 groups.

One definition of shape, type, unit and meaning.

A state record is a ``NamedTuple`` whose fields are ``Annotated[np.ndarray, Field(...)]``.  The
writer, the strict reader and the tables in the documentation are all derived from those
annotations.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeVar, get_type_hints

import h5py
import numpy as np

Record = TypeVar("Record", bound=tuple[Any, ...])


class StateFileError(ValueError):
    """A state file cannot be used; the message names file, group and field, and the remedy."""


@dataclass(frozen=True)
class Field:
    """Describe one array of a record.

    ``shape`` holds integers and names; a name stands for the same extent wherever it occurs in the
    record.
    """

    shape: tuple[int | str, ...]
    unit: str
    doc: str
    dtype: str = "float64"
    may_be_nan: bool = False
    default: float | None = None
    """What a file from before the field was added is read as; None: the field is required."""


def fields_of(record_type: type) -> dict[str, Field]:
    """Return the fields of a record type by name, in order."""
    hints = get_type_hints(record_type, include_extras=True)
    return {
        name: next(item for item in hints[name].__metadata__ if isinstance(item, Field))
        for name in record_type._fields  # type: ignore[attr-defined]
    }


def write_record(group: h5py.Group, record: Any) -> None:
    """Write every array of ``record`` as a dataset with unit and meaning as attributes."""
    for name, field in fields_of(type(record)).items():
        dataset = group.create_dataset(
            name, data=np.asarray(getattr(record, name), dtype=field.dtype, order="C")
        )
        dataset.attrs["unit"] = field.unit
        dataset.attrs["doc"] = field.doc


def read_record(group: h5py.Group, record_type: type[Record]) -> Record:
    """Return the record stored in ``group``.

    Raises
    ------
    StateFileError
        If a dataset is missing, has another shape, type or unit, or holds a number that is not
        finite.
    """
    extents: dict[str, int] = {}
    arrays = {
        name: _read_field(group, name, field, extents)
        for name, field in fields_of(record_type).items()
    }
    return record_type(**arrays)


def _read_field(group: h5py.Group, name: str, field: Field, extents: dict[str, int]) -> np.ndarray:
    place = f"{group.file.filename}: dataset {group.name}/{name}"
    remedy = "write the file again with the stage that makes it"
    if name not in group and field.default is not None:
        shape = [extents.get(extent, 0) for extent in field.shape]  # type: ignore[arg-type]
        return np.full(shape, field.default, dtype=field.dtype)
    if not isinstance(group.get(name), h5py.Dataset):
        raise StateFileError(f"{place} is missing; {remedy}")
    try:
        array = group[name][()]
    except OSError as error:
        raise StateFileError(f"{place} cannot be read ({error}); {remedy}") from error
    array = np.asarray(array)
    if array.dtype != np.dtype(field.dtype):
        raise StateFileError(f"{place} has type {array.dtype}, expected {field.dtype}; {remedy}")
    unit = group[name].attrs.get("unit")
    if unit != field.unit:
        raise StateFileError(f"{place} has unit {unit!r}, expected {field.unit!r}; {remedy}")
    if not _shape_fits(array.shape, field.shape, extents):
        expected = tuple(extents.get(extent, extent) for extent in field.shape)  # type: ignore[arg-type]
        raise StateFileError(f"{place} has shape {array.shape}, expected {expected}; {remedy}")
    if not field.may_be_nan and array.dtype.kind == "f" and not np.isfinite(array).all():
        bad = int(np.count_nonzero(~np.isfinite(array)))
        raise StateFileError(f"{place} holds {bad} values that are not finite; {remedy}")
    return array


def _shape_fits(
    shape: tuple[int, ...], expected: tuple[int | str, ...], extents: dict[str, int]
) -> bool:
    """Compare a shape with the expected one; a named extent is bound at its first occurrence."""
    if len(shape) != len(expected):
        return False
    return all(
        actual == (extents.setdefault(extent, actual) if isinstance(extent, str) else extent)
        for actual, extent in zip(shape, expected, strict=True)
    )


def describe(record_types: Mapping[str, type]) -> str:
    """Return a Markdown table of all groups and fields, for ``docs/state_file.md``."""
    lines = ["| dataset | shape | type | unit | meaning |", "|---|---|---|---|---|"]
    for group, record_type in record_types.items():
        for name, field in fields_of(record_type).items():
            shape = " x ".join(str(extent) for extent in field.shape) or "scalar"
            lines.append(
                f"| `/{group}/{name}` | {shape} | {field.dtype} "
                f"| {field.unit or '-'} | {field.doc} |"
            )
    return "\n".join(lines)
