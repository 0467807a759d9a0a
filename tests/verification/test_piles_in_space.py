"""PD3, PD5 and PD6: piles that are meshed inside or pushed sideways, against their references."""

import numpy as np
import pytest

from workflows.verification import lateral_pile, pile_head, short_pile
from workflows.verification.references.bearing_capacity import deep_cylinder_factor
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


def test_short_pile_on_the_coarse_mesh():
    clay = short_pile.Clay(50e3, 1.0, 10.0, 0.5, 18e3, 500.0, 0.49)
    pushed = short_pile.push(clay, 0.0, short_pile.COARSE)
    excess = pushed.load[-1] / clay.limit(0.0) - 1.0
    assert 0.0 < excess < short_pile.EXCESS
    assert 0.0 < pushed.load[-1] / pushed.load[-2] - 1.0 < short_pile.FLAT
    # against the load near the surface, with it near the toe, and no more than around a cylinder
    assert pushed.reaction[-1] > 0.0 > pushed.reaction[0]
    deep = deep_cylinder_factor(adhesion=0.5) * 50e3
    assert (pushed.reaction[1:] < deep).all()
    assert pushed.reaction @ lengths(pushed.depth) == pytest.approx(pushed.load[-1], rel=1e-6)


def lengths(depth):
    """Lengths in m that belong to equally spaced levels."""
    spacing = np.full(len(depth), depth[0] - depth[1])
    spacing[[0, -1]] *= 0.5
    return spacing


@pytest.mark.slow
def test_short_pile_lies_above_broms_by_less_than_a_quarter():
    assert_all_met(short_pile.pd6())
