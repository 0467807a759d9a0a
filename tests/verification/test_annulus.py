"""PA7 to PA9: torsion of an annulus with the mesh turning by the paper's eqs (3) and (4).

Claimed: the torque is that of the reference to 0.5, 1 and 1.5 %, for other radii and Poisson's
ratios as well, and Newton's method converges quadratically.
"""

import numpy as np
import pytest

from install_mpm.newton import convergence_order
from workflows.verification.annulus import hencky_torsion, neo_hookean_torsion, small_torsion

pytestmark = pytest.mark.gmsh


def assert_met(outcome):
    assert all(check.is_met for check in outcome.checks), outcome.checks


@pytest.mark.parametrize("parameters", [{}, {"nu": 0.3}, {"a": 2.0, "b": 3.0, "E": 1e6}])
def test_small_torsion(parameters):
    assert_met(small_torsion(**parameters))


@pytest.mark.parametrize("parameters", [{}, {"nu": 0.3, "b": 2.0}])
def test_hencky_torsion(parameters):
    outcome = hencky_torsion(**parameters)
    assert_met(outcome)
    orders = [convergence_order(np.array(history)) for history in outcome.residual_histories]
    assert np.median(orders) > 1.7


@pytest.mark.slow
@pytest.mark.parametrize("parameters", [{}, {"nu": 0.3}])
def test_neo_hookean_torsion(parameters):
    assert_met(neo_hookean_torsion(**parameters))
