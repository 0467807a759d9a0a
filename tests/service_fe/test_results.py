"""Figures read from curves that are known in closed form."""

import numpy as np
import pytest

from service_fe.results import Curve, characteristics, head_load_at, initial_stiffness

STIFFNESS, CAPACITY = 2e6, 1e5


def curve_of(displacement, head_load):
    n = len(displacement)
    zero, count = np.zeros(n), np.zeros(n, dtype=np.int64)
    return Curve(
        np.asarray(displacement), np.asarray(head_load), count, zero, zero, count, count,
        zero, count, count, count, zero[:, None], zero[:, None], zero[:, None],
    )  # fmt: skip


def elastic_plastic(direction=1.0, end=0.12):
    displacement = np.linspace(0.0, end, 25)
    load = np.minimum(STIFFNESS * displacement, CAPACITY)
    return curve_of(direction * displacement, direction * load)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_elastic_plastic_curve(direction):
    figures = characteristics(elastic_plastic(direction), pile_width=1.0)
    assert figures.initial_stiffness == pytest.approx(STIFFNESS, rel=1e-12)
    assert figures.capacity == pytest.approx(direction * CAPACITY, rel=1e-12)
    assert figures.tangent_capacity == pytest.approx(direction * CAPACITY, rel=1e-12)


def test_hardening_curve_has_its_corner_as_tangent_capacity():
    displacement = np.linspace(0.0, 0.2, 101)
    load = np.minimum(STIFFNESS * displacement, 9e4 + 2e5 * displacement)
    figures = characteristics(curve_of(displacement, load), pile_width=1.0)
    assert figures.capacity == pytest.approx(9e4 + 2e4, rel=1e-12)
    assert figures.tangent_capacity == pytest.approx(STIFFNESS * 9e4 / (STIFFNESS - 2e5), rel=1e-9)


def test_capacity_needs_a_tenth_of_the_width():
    figures = characteristics(elastic_plastic(end=0.06), pile_width=1.0)
    assert figures.capacity is None
    assert figures.tangent_capacity == pytest.approx(CAPACITY, rel=1e-12)


def test_straight_curve_has_no_tangent_capacity():
    displacement = np.linspace(0.0, 0.01, 5)
    figures = characteristics(curve_of(displacement, STIFFNESS * displacement), pile_width=1.0)
    assert figures.tangent_capacity is None
    assert figures.initial_stiffness == pytest.approx(STIFFNESS, rel=1e-12)


def test_initial_stiffness_is_the_secant_to_a_tenth_of_the_capacity():
    displacement = np.linspace(0.0, 0.1, 4001)
    load = CAPACITY * np.sqrt(displacement / 0.1)  # reaches 10 % at 1 % of the displacement
    stiffness = initial_stiffness(curve_of(displacement, load), CAPACITY)
    assert stiffness == pytest.approx(0.1 * CAPACITY / 0.001, rel=1e-3)


def test_stiffness_counts_from_the_load_at_the_start():
    curve = curve_of([0.0, 0.01, 0.02], [5e4, 7e4, 9e4])
    assert initial_stiffness(curve, 9e4) == pytest.approx(2e6)


def test_head_load_is_linear_between_steps():
    curve = curve_of([0.0, -0.01, -0.02], [0.0, -4.0, -6.0])
    assert head_load_at(curve, -0.015) == pytest.approx(-5.0)


@pytest.mark.parametrize("displacement", [0.2, -0.01])
def test_displacement_off_the_curve_is_refused(displacement):
    with pytest.raises(ValueError, match="does not reach"):
        head_load_at(elastic_plastic(), displacement)


def test_curve_without_motion_has_no_stiffness():
    with pytest.raises(ValueError, match="along which the pile moves"):
        initial_stiffness(curve_of([0.0, 0.0], [1.0, 0.0]), 1.0)
