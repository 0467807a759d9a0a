"""PA1 and AMPLE-COLUMN: recovered stress within AMPLE's error, orders, weight at the base.

Claimed: with the mesh following, stretching and staying, the field that is handed over has less
error than AMPLE's GIMP; it converges at least with the first order, and so does the raw stress of
the points; the base carries the weight to round-off, and Newton's method is quadratic.
"""

import numpy as np
import pytest

from install_mpm.newton import convergence_order
from workflows.verification.ample_column import ample_column
from workflows.verification.column import column_under_its_weight
from workflows.verification.references.ample import COLUMN, COLUMN_GIMP
from workflows.verification.squeezed_column import SIXTY_POINTS, MeshLaw, squeeze


def median_order(histories):
    return np.nanmedian([convergence_order(np.array(history)) for history in histories])


def all_met(outcome):
    missed = [check for check in outcome.checks if not check.is_met]
    assert missed == []
    return True


def test_sixty_points_have_less_error_than_the_64_of_ample():
    run = squeeze(COLUMN, MeshLaw.NODES, SIXTY_POINTS)
    assert len(run.stress) == 60
    assert run.recovered_error < COLUMN_GIMP[16].stress_error
    assert run.raw_error < 6e-3
    assert run.reaction == pytest.approx(run.weight, rel=1e-10)
    assert median_order(run.histories) > 1.8


def test_fixed_mesh_against_ample():
    outcome = ample_column()
    assert all_met(outcome)
    assert median_order(outcome.residual_histories) > 1.8


def test_fixed_mesh_against_ample_at_another_scale():
    outcome = ample_column(L0=20.0, rho=2000.0, g=9.81)
    assert all_met(outcome)
    assert outcome.checks[0].error == pytest.approx(ample_column().checks[0].error, abs=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("changed", [{}, {"nu": 0.3, "E": 20e3, "L0": 40.0, "rho": 100.0}])
def test_all_checks_are_met(changed):
    outcome = column_under_its_weight(**changed)
    assert all_met(outcome)
    assert median_order(outcome.residual_histories) > 1.8
