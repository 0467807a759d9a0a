"""PD8: a point force inside a half space, to 3 %; PD9: cycles of an interface, to 1e-6."""

import pytest

from workflows.errors import CaseError
from workflows.verification.cyclic_interface import pd9
from workflows.verification.point_force import pd8

pytestmark = [pytest.mark.dolfinx, pytest.mark.gmsh]


def assert_all_met(outcome):
    assert [check.quantity for check in outcome.checks if not check.is_met] == []


@pytest.mark.parametrize("values", [{}, {"c": 2.0, "nu": 0.45, "P": 5e4}], ids=["default", "other"])
def test_settlements_beside_a_point_force(values):
    outcome = pd8(**values)
    assert_all_met(outcome)
    if not values:
        references = [check.reference for check in outcome.checks]
        assert references == pytest.approx([6.4950e-3, 2.9141e-3, 4.5756e-3], rel=1e-4)


@pytest.mark.parametrize(
    "values", [{}, {"ks": 3e6, "tau_y": 7e3, "u_a": 4e-3, "cycles": 3}], ids=["default", "other"]
)
def test_cycles_lose_the_area_of_the_loop(values):
    outcome = pd9(**values)
    assert_all_met(outcome)
    if not values:
        assert outcome.checks[0].reference == pytest.approx(160.0)


def test_an_interface_that_never_slips_is_refused():
    with pytest.raises(CaseError, match="does not slip"):
        pd9(u_a=1e-3, tau_y=20e3)
