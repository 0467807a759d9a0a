"""PA1: elastic column that its own weight squeezes to half its height, in three kinds of mesh."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated

import numpy as np

from install_mpm.conventions import Unit
from workflows.verification.problem import (
    Check,
    Outcome,
    Problem,
    Series,
    at_least,
    at_most,
    relative,
)
from workflows.verification.references.ample import ColumnInput
from workflows.verification.squeezed_column import (
    FEWEST_POINTS,
    MeshLaw,
    Resolution,
    Squeezed,
    squeeze,
    stress_curve,
)

AMPLE_ERROR = 3.66e-3
"""Stress error of AMPLE (GIMP) with 16 cells and 64 points."""


def column_under_its_weight(
    *,
    L0: Annotated[float, Unit("m")] = 50.0,
    E: Annotated[float, Unit("Pa")] = 10e3,
    nu: float = 0.0,
    rho: Annotated[float, Unit("kg/m^3")] = 80.0,
    g: Annotated[float, Unit("m/s^2")] = 10.0,
    rows: int = 16,
    steps: int = 40,
) -> Outcome:
    """PA1: stress of the points and of the recovered field, three meshes and three refinements."""
    data = ColumnInput(L0, E, nu, rho, g, steps=steps)
    laws = {law: squeeze(data, law, Resolution(rows)) for law in MeshLaw}
    followed = [
        laws[MeshLaw.NODES],
        *(squeeze(data, MeshLaw.NODES, Resolution(factor * rows)) for factor in (2, 4)),
    ]
    fixed = [squeeze(data, MeshLaw.STAY, Resolution(max(rows // 2, 1))), laws[MeshLaw.STAY]]
    fixed += [squeeze(data, MeshLaw.STAY, Resolution(factor * rows)) for factor in (2, 4)]
    few = squeeze(data, MeshLaw.NODES, FEWEST_POINTS._replace(rows=rows))
    return Outcome(
        checks=(
            *_bounds(laws, few, rows),
            *_rates(followed),
            *_overall_rates(fixed, max(rows // 2, 1), 4 * rows),
            _top_displacement(followed[0]),
            *(
                relative(f"base reaction [N], {law.value}", run.reaction, run.weight, 1e-10)
                for law, run in laws.items()
            ),
        ),
        series=(stress_curve(followed[0]), *_convergence(followed, rows)),
        remarks=(_raw_errors(laws), _fewest_points(few, rows), _single_orders(fixed)),
        residual_histories=laws[MeshLaw.NODES].histories + laws[MeshLaw.STRETCH].histories,
    )


def _bounds(laws: dict[MeshLaw, Squeezed], few: Squeezed, rows: int) -> tuple[Check, ...]:
    """Return the checks against AMPLE's error, in proportion to the size of the cells."""
    bound = AMPLE_ERROR * max(16.0 / rows, 1.0)
    runs = {law.value: run for law, run in laws.items()}
    runs[f"{MeshLaw.NODES.value}, fewest points"] = few
    return tuple(
        at_most(f"error of the recovered stress, {name}", run.recovered_error, bound)
        for name, run in runs.items()
    )


def _raw_errors(laws: dict[MeshLaw, Squeezed]) -> str:
    """Return the errors of the raw stress in words."""
    raw = ", ".join(f"{law.value}: {run.raw_error:.2e}" for law, run in laws.items())
    return f"error of the raw stress of the points, not demanded: {raw}"


def _fewest_points(few: Squeezed, rows: int) -> str:
    """Return why there are more points than AMPLE has, in words."""
    return (
        f"AMPLE has 4 points in each square; {rows} squares of two quadratic triangles take"
        f" {len(few.stress)} at least, with which the error is {few.raw_error:.2e} raw and"
        f" {few.recovered_error:.2e} recovered (60 points in 5 rows: AMPLE-COLUMN)"
    )


def _single_orders(runs: Sequence[Squeezed]) -> str:
    """Return the orders of single refinements of the fixed mesh in words."""
    orders = ", ".join(
        f"{np.log2(coarse.raw_error / fine.raw_error):.2f} raw and"
        f" {np.log2(coarse.recovered_error / fine.recovered_error):.2f} recovered"
        for coarse, fine in pairwise(runs)
    )
    return f"fixed mesh, order from one refinement to the next, not demanded: {orders}"


def _top_displacement(run: Squeezed) -> Check:
    top = np.argmax(run.original_height)
    return relative(
        "displacement of the highest point [m]",
        float(run.displacement[top]),
        float(run.exact.displacement[top]),
        5e-3,
    )


def _rates(runs: Sequence[Squeezed]) -> tuple[Check, ...]:
    """Return the checks of the order of convergence of both stresses; cells are halved."""
    return tuple(
        at_least(
            f"order of convergence of the {name} stress, refinement {number}",
            float(np.log2(coarse / fine)),
            1.0,
        )
        for name, errors in (
            ("raw", [run.raw_error for run in runs]),
            ("recovered", [run.recovered_error for run in runs]),
        )
        for number, (coarse, fine) in enumerate(pairwise(errors), start=1)
    )


def _overall_rates(runs: Sequence[Squeezed], rows: int, finest: int) -> tuple[Check, ...]:
    """Return the checks of the order of both stresses from the coarsest mesh to the finest.

    In a fixed mesh the surface ends at another place within its cell on every mesh, so that the
    order of single refinements scatters.
    """
    refinement = np.log(finest / rows)
    return tuple(
        at_least(
            f"order of convergence of the {name} stress, mesh stays, {rows} to {finest} rows",
            float(np.log(errors[0] / errors[-1]) / refinement),
            1.0,
        )
        for name, errors in (
            ("raw", [run.raw_error for run in runs]),
            ("recovered", [run.recovered_error for run in runs]),
        )
    )


def _convergence(runs: Sequence[Squeezed], rows: int) -> tuple[Series, ...]:
    """Return the errors of both stresses over the number of rows."""
    fineness = tuple(float(rows * 2**number) for number in range(len(runs)))
    return tuple(
        Series(
            f"Convergence of the {name} stress of the column",
            "rows of cells",
            "error over rho g L0",
            fineness,
            errors,
            is_logarithmic=True,
        )
        for name, errors in (
            ("raw", tuple(run.raw_error for run in runs)),
            ("recovered", tuple(run.recovered_error for run in runs)),
        )
    )


PROBLEM = Problem(
    "PA1", "Elastic column under its own weight", column_under_its_weight, is_quick=False
)
