"""History of an installation: one row per load step."""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple, TypeVar

import numpy as np

from install_mpm.record import Field, fields_of


def _per_step(unit: str, doc: str, dtype: str = "float64", *, may_be_nan: bool = False) -> Field:
    return Field(("load_step",), unit, doc, dtype, may_be_nan)


class History(NamedTuple):
    """What happened in each accepted load step; forces are for the whole pile."""

    penetration: Annotated[np.ndarray, _per_step("m", "pile penetration at the end of the step")]
    crowd_force: Annotated[
        np.ndarray,
        _per_step("N", "force that the rig applies downward: soil reaction less pile weight"),
    ]
    base_force: Annotated[np.ndarray, _per_step("N", "upward soil reaction on the pile base")]
    shaft_force: Annotated[np.ndarray, _per_step("N", "upward soil reaction on the pile shaft")]
    iterations: Annotated[np.ndarray, _per_step("", "Newton iterations", "int64")]
    residual: Annotated[np.ndarray, _per_step("", "relative out-of-balance force at acceptance")]
    convergence_order: Annotated[
        np.ndarray,
        _per_step("", "order of the last Newton iterations; NaN if too few", may_be_nan=True),
    ]
    cuts: Annotated[
        np.ndarray, _per_step("", "times the step was halved before it converged", "int64")
    ]
    empty_cells: Annotated[
        np.ndarray, _per_step("", "cells below the fill threshold beside filled ones", "int64")
    ]
    partly_filled_cells: Annotated[
        np.ndarray, _per_step("", "cells with points that are not interior", "int64")
    ]
    empty_integration_points: Annotated[
        np.ndarray, _per_step("", "integration points without a material point", "int64")
    ]
    injected_points: Annotated[
        np.ndarray, _per_step("", "material points made by splitting", "int64")
    ]
    merged_points: Annotated[
        np.ndarray, _per_step("", "material points that were merged into others", "int64")
    ]
    projected_points: Annotated[
        np.ndarray, _per_step("", "material points brought back from outside the mesh", "int64")
    ]
    smallest_cell_quality: Annotated[
        np.ndarray, _per_step("", "worst ratio 2 r_in / r_out of a cell, 1 is equilateral")
    ]
    remesh_stress_change: Annotated[
        np.ndarray,
        Field(("load_step",), "", "relative change of stress by a new mesh; NaN without one",
              may_be_nan=True, default=np.nan),
    ]  # fmt: skip
    remesh_force_change: Annotated[
        np.ndarray,
        Field(("load_step",), "N", "change of the crowd force by a new mesh; NaN without one",
              may_be_nan=True, default=np.nan),
    ]  # fmt: skip
    residual_history: Annotated[
        np.ndarray,
        Field(("load_step", "iteration"), "", "relative residuals, NaN-padded", may_be_nan=True),
    ]


Row = TypeVar("Row", bound=tuple[Any, ...])


def append(history: Row, row: dict[str, object]) -> Row:
    """Return the history with one more step; ``row`` maps every field to its value."""

    def joined(name: str) -> np.ndarray:
        old = getattr(history, name)
        new = np.asarray(row[name], dtype=old.dtype)[None]
        if old.ndim == 2:
            width = max(old.shape[1], new.shape[1])
            old, new = (_padded(values, width) for values in (old, new))
        return np.concatenate([old, new])

    return type(history)(*(joined(name) for name in fields_of(type(history))))


def _padded(values: np.ndarray, width: int) -> np.ndarray:
    """Return 2D ``values`` with NaN columns added up to ``width``."""
    return np.pad(values, ((0, 0), (0, width - values.shape[1])), constant_values=np.nan)


def empty_history(record: type[Row]) -> Row:
    """Return a history of a kind without steps."""
    return record(
        *(
            np.zeros((0,) * len(field.shape), dtype=field.dtype)
            for field in fields_of(record).values()
        )
    )
