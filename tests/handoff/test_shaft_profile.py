"""Tractions along the shaft of both models, level by level."""

import numpy as np
import pytest

from handoff.fe_state_file import FEInterfacePoints
from handoff.shaft_profile import profile_differences, shaft_profiles
from install_mpm.interface import InterfacePoints

SHAFT, TIP = 2, 0


def rings(heights, n_around, part=SHAFT):
    """Points around the axis at each of the ``heights``, and the part they belong to."""
    angle = np.arange(n_around) * 2.0 * np.pi / n_around
    position = np.array([[np.cos(a), np.sin(a), z] for z in heights for a in angle])
    return position, np.full(len(position), part)


def traction_at(position):
    """Linear over the depth; around the axis it varies, with a mean of zero."""
    x, _, z = position.T
    return np.column_stack([2.0 * z, 1.0 + 0.0 * z, 5.0 * z + 100.0 * x])


def installed(heights, n_around, covered=1.0):
    position, part = rings(heights, n_around)
    n = len(part)
    return InterfacePoints(
        position, position * [1, 1, 0], np.full(n, 0.5), traction_at(position),
        np.zeros((n, 7)), part, np.broadcast_to(covered, n),
    )  # fmt: skip


def handed_over(heights, n_around):
    shaft, part = rings(heights, n_around)
    tip, tip_part = rings((-9.0,), 7, TIP)
    position = np.vstack([shaft, tip])
    places = FEInterfacePoints(
        position, position * [1, 1, 0], np.full(len(position), 0.3), np.append(part, tip_part)
    )
    return places, traction_at(position)


def test_linear_tractions_come_out_in_both_models():
    """Means around the shaft, whatever the points; the tip is no part of it.

    At the ends a level has points on one side only, a third of the spacing away in the mean.
    """
    heights = -np.linspace(0.05, 3.95, 40)
    places, traction = handed_over(np.linspace(-4.0, 0.0, 81), 12)
    profiles = shaft_profiles(installed(heights, 8), places, traction, SHAFT, 0.5)
    np.testing.assert_allclose(profiles.height, [-4.0, -3.0, -2.0, -1.0, 0.0])
    centre = profiles.height + np.array([1.0, 0.0, 0.0, 0.0, -1.0]) / 3.0
    expected = traction_at(centre[:, None] * [0, 0, 1])
    np.testing.assert_allclose(profiles.material_points[1:-1], expected[1:-1], atol=1e-9)
    np.testing.assert_allclose(profiles.finite_elements[1:-1], expected[1:-1], atol=1e-9)
    np.testing.assert_allclose(profiles.finite_elements, expected, atol=0.1)
    pressure, shear = profile_differences(profiles)
    assert pressure < 0.02
    assert shear < 0.02


def test_a_level_that_soil_hardly_covers_is_left_out():
    heights = -np.linspace(0.05, 3.95, 40)
    covered = np.repeat(np.where(heights > -1.0, 0.01, 1.0), 8)
    places, traction = handed_over(np.linspace(-4.0, 0.0, 81), 12)
    profiles = shaft_profiles(installed(heights, 8, covered), places, traction, SHAFT, 0.5)
    np.testing.assert_allclose(profiles.height, [-4.0, -3.0, -2.0, -1.0])


def test_rings_of_points_at_other_heights_make_no_difference():
    """A few rings, as on a coarse mesh: whether one lies above or below a middle is no matter."""
    places, traction = handed_over(np.linspace(-4.0, 0.0, 81), 12)
    rings_at = -np.arange(0.2, 4.0, 0.4)
    lower, upper = (
        shaft_profiles(installed(rings_at + shift, 64), places, traction, SHAFT, 0.5)
        for shift in (-0.03, 0.03)
    )
    np.testing.assert_allclose(lower.material_points[1:-1], upper.material_points[1:-1], atol=0.25)


def test_difference_is_relative_to_the_installation():
    heights = -np.linspace(0.05, 3.95, 40)
    places, traction = handed_over(heights, 8)
    more = traction * [1.5, 1.5, 1.2]
    profiles = shaft_profiles(installed(heights, 8), places, more, SHAFT, 0.5)
    assert profile_differences(profiles) == (pytest.approx(0.2), pytest.approx(0.5))
