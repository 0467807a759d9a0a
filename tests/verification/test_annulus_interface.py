"""PA13: an interface on the inner rim of an annulus sticks, then slips under a flat torque.

Claimed: both branches within 0.5 % while normals and mesh turn with the pile.
"""

import pytest

from workflows.verification.annulus_interface import annulus_interface

pytestmark = [pytest.mark.gmsh, pytest.mark.slow]


@pytest.mark.parametrize("parameters", [{}, {"b": 2.5, "nu": 0.1, "c": 250.0}])
def test_annulus_interface(parameters):
    outcome = annulus_interface(**parameters)
    assert all(check.is_met for check in outcome.checks), outcome.checks
