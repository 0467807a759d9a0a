"""PB7: base resistance of a round pile deep in clay, in the corridor of published fits."""

import numpy as np
import pytest

from install_mpm.newton import convergence_order
from workflows.verification.deep_penetration import deep_penetration

pytestmark = pytest.mark.gmsh


def assert_quadratic(outcome):
    orders = [
        convergence_order(np.array(history), outcome.round_off)
        for history in outcome.residual_histories
    ]
    assert np.nanmax(orders) >= 1.8


@pytest.mark.slow
def test_short_penetration_on_a_coarse_mesh():
    """The resistance is in the corridor after one diameter, but not yet steady."""
    outcome = deep_penetration(
        alpha_1=0.5,
        alpha_2=1.0,
        R=0.5,
        su=30e3,
        embedment=4.0,
        penetration=2.0,
        size=0.5,
        step=0.25,
    )
    assert_quadratic(outcome)
    in_corridor, steady = outcome.checks[::2], outcome.checks[1::2]
    assert all(check.is_met for check in in_corridor)
    assert not any(check.is_met for check in steady)


def test_corridor_follows_the_rigidity_index():
    keywords = {"embedment": 3.0, "penetration": 0.2, "size": 0.5, "step": 0.1}
    soft = deep_penetration(G_over_su=50.0, **keywords).checks[0]
    assert soft.reference * (1.0 + soft.tolerance) == pytest.approx(12.5 - 1.6 * np.log(2), abs=0.1)


@pytest.mark.slow
def test_deep_penetration():
    outcome = deep_penetration()
    assert [check.quantity for check in outcome.checks if not check.is_met] == []
    assert_quadratic(outcome)
