"""PB2: smooth and rough circular footing through the installation step, axisymmetric.

Claimed: as with finite elements, a plateau from above, with an error that falls with the cell size
at the footing's edge, and below 3 % on the finest mesh.
"""

import numpy as np
import pytest

from install_mpm.newton import convergence_order
from workflows.verification import circular_footing
from workflows.verification.circular_footing_mpm import PROBLEM, ROUND_OFF

pytestmark = [pytest.mark.dolfinx, pytest.mark.gmsh, pytest.mark.slow]


def assert_quadratic(outcome):
    orders = [
        convergence_order(np.array(history), ROUND_OFF) for history in outcome.residual_histories
    ]
    assert np.nanmedian(orders) >= 1.8


def test_plateaus_are_those_of_the_exact_solution():
    outcome = PROBLEM.run()
    assert [check.quantity for check in outcome.checks if not check.is_met] == []
    for study in outcome.series[1::2]:
        assert (np.diff(study.computed) < 0.0).all()
    assert_quadratic(outcome)


def test_other_footing_on_two_coarse_meshes(monkeypatch):
    """Another radius, strength and stiffness give the same factors; the trend shows already."""
    monkeypatch.setattr(circular_footing, "SIZES", (0.05, 0.025))
    outcome = PROBLEM.run(R=0.3, su=50e3, E_over_su=1e4, nu=0.48)
    for errors in (outcome.series[1].computed, outcome.series[3].computed):
        assert errors[1] < 0.7 * errors[0]
        assert errors[1] < 0.03
    assert_quadratic(outcome)
