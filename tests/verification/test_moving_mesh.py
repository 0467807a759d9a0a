"""PA6: a mesh that moves through soil at rest changes neither stress nor volume nor mass.

Claimed: with carriers the uniform stress is in equilibrium on any mesh to round-off.
"""

import pytest

from workflows.verification.moving_mesh import moving_mesh

pytestmark = pytest.mark.gmsh


@pytest.mark.parametrize("parameters", [{}, {"R": 5.0, "nu": 0.0, "sigma_yy": -200e3}])
def test_moving_mesh(parameters):
    outcome = moving_mesh(**parameters)
    assert all(check.is_met for check in outcome.checks), outcome.checks
