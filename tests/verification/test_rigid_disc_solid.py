"""PD1 in space: a rigid disc in all its degrees of freedom, to 2 %."""

import numpy as np
import pytest

from workflows.verification.rigid_disc_solid import PROBLEM
from workflows.verification.round_ground import equal_area, equal_inertia

pytestmark = pytest.mark.dolfinx


def test_polygons_have_area_and_second_moment_of_the_circle():
    for sides in (8, 20):
        angle = 2.0 * np.pi * np.arange(sides) / sides
        x, y = np.cos(angle), np.sin(angle)
        cross = x * np.roll(y, -1) - np.roll(x, -1) * y
        area = 0.5 * cross.sum()
        inertia = (cross * (x**2 + x * np.roll(x, -1) + np.roll(x, -1) ** 2)).sum() / 12.0
        assert area * equal_area(sides) ** 2 == pytest.approx(np.pi, rel=1e-12)
        assert inertia * equal_inertia(sides) ** 4 == pytest.approx(np.pi / 4.0, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    "values", [{}, {"R": 2.5, "G": 40e6, "nu": 0.45}], ids=["default", "other"]
)
def test_stiffness_in_all_degrees_of_freedom(values):
    outcome = PROBLEM.run(**values)
    assert [check.quantity for check in outcome.checks if not check.is_met] == []
    for history in outcome.residual_histories:
        assert len(history) == 2  # linear: one iteration
