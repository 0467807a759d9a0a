"""AMPLE-COLUMN: the elastic column (PA1) in AMPLE's own mesh, beside AMPLE's figures.

Because 16 rows of four triangles hold more points than AMPLE's 64, a column of 60 points is
squeezed too.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from install_mpm.conventions import Unit
from workflows.verification.problem import Outcome, Problem, at_most, relative
from workflows.verification.references import ample
from workflows.verification.references.ample import ColumnInput
from workflows.verification.squeezed_column import (
    SIXTY_POINTS,
    MeshLaw,
    Resolution,
    squeeze,
    stress_curve,
)


def ample_column(
    *,
    L0: Annotated[float, Unit("m")] = ample.COLUMN.height,
    rho: Annotated[float, Unit("kg/m^3")] = ample.COLUMN.density,
    g: Annotated[float, Unit("m/s^2")] = ample.COLUMN.gravity,
) -> Outcome:
    """AMPLE's column in its own fixed mesh of 16 squares, the upper half of which runs empty.

    AMPLE's figures hold for E = rho g L0 / 4 and nu = 0, and scale with length and stress.
    """
    scale = L0 / ample.COLUMN.height
    data = ColumnInput(L0, 0.25 * rho * g * L0, 0.0, rho, g)
    run = squeeze(data, MeshLaw.STAY, Resolution(16))
    few = squeeze(data, MeshLaw.NODES, SIXTY_POINTS)
    reference = ample.COLUMN_GIMP[16]
    top_point = L0 * (1.0 - 0.25 / 16.0)
    height, row = np.unique(np.round(run.original_height / L0, 9), return_inverse=True)
    of_row = np.bincount(row, run.displacement) / np.bincount(row)  # several points at each height
    displacement = np.interp(top_point / L0, height, of_row)
    reaction = ample.COLUMN_BASE_REACTION * scale**2 * (rho * g) / 800.0
    return Outcome(
        checks=(
            relative(
                "displacement at AMPLE's highest point [m]",
                float(displacement),
                reference.top_displacement * scale,
                1e-2,
            ),
            at_most("error of the recovered stress", run.recovered_error, reference.stress_error),
            at_most(
                "error of the recovered stress, 60 points in 5 rows, mesh follows",
                few.recovered_error,
                reference.stress_error,
            ),
            at_most(
                "error of the raw stress (AMPLE's standard MPM)",
                run.raw_error,
                ample.COLUMN_STANDARD_MPM.stress_error,
            ),
            relative("base reaction [N]", run.reaction, reaction, 1e-10),
        ),
        series=(stress_curve(run),),
        remarks=(
            f"Error of the raw stress {run.raw_error:.2e}; AMPLE {reference.stress_error:.2e}"
            f" (GIMP), {ample.COLUMN_STANDARD_MPM.stress_error:.2e} (standard MPM)",
            f"Newton iterations {sum(len(history) - 1 for history in run.histories)};"
            f" AMPLE {reference.iterations}",
        ),
        residual_histories=run.histories,
    )


PROBLEM = Problem("AMPLE-COLUMN", "AMPLE's column in a fixed mesh", ample_column, is_quick=True)
