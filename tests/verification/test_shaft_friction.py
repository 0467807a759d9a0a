"""PA14: capacity and stiffness of a shaft with friction, each slice sheared by itself."""

import numpy as np

from install_mpm.newton import convergence_order
from workflows.verification.shaft_friction import shaft_friction


def assert_all_met(outcome):
    assert [check.quantity for check in outcome.checks if not check.is_met] == []
    orders = [convergence_order(np.array(h)) for h in outcome.residual_histories]
    assert np.nanmax(orders) >= 1.8


def test_shaft_of_the_reference():
    outcome = shaft_friction()
    assert_all_met(outcome)
    assert round(outcome.checks[0].reference, 2) == 349.68


def test_another_shaft_with_cohesion():
    outcome = shaft_friction(
        a=0.3, b=6.0, L=4.0, G=8e6, nu=0.3, ks=3e7, c=5e3, delta=0.3, K0=0.8, gamma=18e3
    )
    assert_all_met(outcome)


def test_slices_help_each_other_while_some_slip():
    """Between first and full slip the soil carries load from slice to slice: a stiffer curve."""
    curve = shaft_friction().series[0]
    computed, exact = np.array(curve.computed[1:-3]), np.array(curve.reference[1:-3])
    assert (computed > exact).all()
    assert (computed < 1.15 * exact).all()
