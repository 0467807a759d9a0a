"""PB9: a jacked pile that is unloaded and pushed on carries what it carried before."""

import numpy as np
import pytest

from install_mpm.newton import convergence_order
from workflows.verification.body import ProblemNotSolvedError
from workflows.verification.reload import reload

pytestmark = pytest.mark.gmsh


def assert_all_met(outcome):
    assert [check.quantity for check in outcome.checks if not check.is_met] == []
    orders = [convergence_order(np.array(h)) for h in outcome.residual_histories]
    assert np.nanmax(orders) >= 1.8


@pytest.fixture(scope="module")
def rough():
    return reload(size=0.4, penetration=0.12, cycle_step=0.01, alpha=1.0)


def test_rough_pile_on_a_coarse_mesh(rough):
    assert_all_met(rough)


def test_head_load_comes_down_to_zero_and_back(rough):
    curve = rough.series[0]
    depth, load = np.array(curve.x), np.array(curve.computed)
    lowest = int(np.argmin(load[5:])) + 5
    assert load[lowest] <= 0.0 < load[lowest - 1]
    assert depth[lowest] < depth[lowest - 1]
    assert depth[-1] == pytest.approx(depth[lowest] + 0.1)


def test_pile_that_does_not_come_free_is_an_error():
    with pytest.raises(ProblemNotSolvedError, match="does not come down to zero"):
        reload(size=0.5, penetration=0.06, cycle_step=1e-5)


@pytest.mark.slow
def test_pile_of_the_reference():
    assert_all_met(reload())
