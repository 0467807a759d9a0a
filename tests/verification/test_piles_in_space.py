"""PD3 and PD5: piles that are meshed inside, against their references."""

import numpy as np
import pytest

from workflows.verification import lateral_pile, pile_head
from workflows.verification.references.pile_stiffness import head_stiffness

pytestmark = [pytest.mark.dolfinx, pytest.mark.gmsh]


def assert_all_met(outcome):
    assert [check.quantity for check in outcome.checks if not check.is_met] == []


def assert_linear(outcome):
    for history in outcome.residual_histories:
        assert len(history) == 2
        assert history[-1] < 1e-9


def test_head_of_a_pile_in_a_small_box_is_that_of_other_elements():
    site = pile_head.Site(6.0, 0.4, 2e9, 20e6, 0.25, 12.0, 15.0)
    computed, residuals = pile_head.stiffness(site, 0.5 * site.radius)
    assert computed == pytest.approx(head_stiffness(**site._asdict()), rel=0.005)
    assert len(residuals) == 2


@pytest.mark.slow
def test_head_of_the_reference_pile():
    outcome = pile_head.pd3()
    assert_all_met(outcome)
    assert_linear(outcome)
    assert outcome.checks[0].computed == pytest.approx(298.5e6, rel=0.005)
    assert (np.diff(outcome.series[0].computed) < 0.0).all()


@pytest.mark.slow
def test_long_pile_under_a_horizontal_force():
    outcome = lateral_pile.pd5()
    assert_all_met(outcome)
    assert_linear(outcome)
    references = [check.reference for check in outcome.checks]
    assert references == pytest.approx([1.446e-3, 3.456e-4, 0.857e-3], rel=1e-3)
