"""PD10: thick Tresca cylinder under internal pressure, from first yield to collapse, to 1 %."""

import numpy as np
import pytest

from install_mpm.newton import convergence_order
from workflows.verification.thick_cylinder import PROBLEM

pytestmark = pytest.mark.dolfinx


def unmet(outcome):
    return [check.quantity for check in outcome.checks if not check.is_met]


@pytest.fixture(scope="module")
def outcome():
    return PROBLEM.run()


def test_pressures_are_those_of_the_exact_solution(outcome):
    assert unmet(outcome) == []
    references = [check.reference for check in outcome.checks]
    assert references[:3] == pytest.approx([28.80e3, 66.79e3, 85.12e3], rel=1e-4)
    assert references[4] == pytest.approx(96.566e3, rel=1e-5)


def test_plastic_radius_is_far_more_accurate_than_asked_for(outcome):
    assert len(outcome.series[0].x) > 10
    assert outcome.checks[3].computed < 1e-3


def test_newton_ends_quadratically(outcome):
    orders = [convergence_order(np.array(history)) for history in outcome.residual_histories]
    assert np.nanmedian(orders) >= 1.8


def test_another_cylinder():
    assert unmet(PROBLEM.run(a=0.5, b=1.5, su=70e3, E_over_su=300.0, nu=0.45)) == []
