"""PA13: an interface on the inner rim of an annulus sticks, then slips under a flat torque.

Claimed: both branches within 0.5 % of the annulus of finite strain with friction on its rim, while
normals and mesh turn with the pile; without friction flat to 1e-6 over a quarter turn; three Newton
iterations are enough from the onset of slip on.
"""

import pytest

from workflows.verification.annulus_interface import annulus_interface

pytestmark = [pytest.mark.gmsh, pytest.mark.slow]


@pytest.mark.parametrize("parameters", [{}, {"b": 2.5, "nu": 0.1, "c": 250.0}])
def test_annulus_interface(parameters):
    outcome = annulus_interface(**parameters)
    assert all(check.is_met for check in outcome.checks), outcome.checks
