"""PB6 with the finite elements of the service stage, to 3 %."""

import pytest

from workflows.verification.deep_cylinder_fe import deep_cylinder

pytestmark = pytest.mark.dolfinx


def test_coarse_mesh_and_another_clay():
    outcome = deep_cylinder(
        alpha_1=0.2, alpha_2=0.8, alpha_3=1.0, R=0.25, su=40e3, nu=0.45, size=0.2, outer_ratio=5.0,
        displacement=24.0, steps=8,
    )  # fmt: skip
    assert [check.quantity for check in outcome.checks if not check.is_met] == []


@pytest.mark.slow
def test_cylinder_of_the_reference():
    assert [check.quantity for check in deep_cylinder().checks if not check.is_met] == []
