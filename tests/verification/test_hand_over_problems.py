"""PF1, PF2, PF4-PF6: transfer of fields, ground at rest, strength, conservation, round trip."""

import pytest

from workflows.verification.hand_over_checks import pf2, pf4, pf5
from workflows.verification.round_trip import pf6
from workflows.verification.transfer_fields import pf1

pytestmark = [pytest.mark.dolfinx, pytest.mark.gmsh]


def assert_all_met(outcome):
    assert [check.quantity for check in outcome.checks if not check.is_met] == []


@pytest.mark.parametrize(
    "values", [{}, {"a": 0.5, "sigma": 3e3, "seed": 2}], ids=["default", "other"]
)
def test_fields_from_material_points(values):
    assert_all_met(pf1(**values))


def test_ground_at_rest():
    assert_all_met(pf2())


@pytest.mark.slow
@pytest.mark.parametrize("problem", [pf4, pf5, pf6])
def test_hand_over_of_a_jacked_pile_and_round_trip(problem):
    assert_all_met(problem())
