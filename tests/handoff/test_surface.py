"""The surface profile: level when nothing moved, unbiased for a mound, calm beside the shaft."""

import numpy as np
import pytest

from handoff.surface import STEEPEST, height_at, surface_profile

HALF_WIDTH, SPACING = 0.5, 0.1


def moved(points, motion):
    """Return the points displaced vertically by motion(x), fading to zero 2 m down."""
    x, z = points.position.T
    displacement = np.column_stack([np.zeros_like(x), motion(x) * np.clip(1.0 + z / 2.0, 0.0, 1.0)])
    return points._replace(position=points.position + displacement, displacement=displacement)


@pytest.fixture(scope="module")
def points(undisturbed):
    return undisturbed.material_points


@pytest.mark.gmsh
def test_surface_is_exactly_level_where_nothing_moved(points):
    profile = surface_profile(points, HALF_WIDTH, SPACING)
    assert np.array_equal(height_at(profile, np.linspace(0.5, 4.0, 9)), np.zeros(9))


@pytest.mark.gmsh
def test_mound_is_followed_without_bias(points):
    def mound(x):
        return 0.2 * np.exp(-(x - 0.5))

    profile = surface_profile(moved(points, mound), HALF_WIDTH, SPACING)
    x = np.linspace(0.5, 4.0, 200)
    error = height_at(profile, x) - mound(x)
    assert np.abs(error).max() < 0.004
    assert abs(error.mean()) < 0.001


@pytest.mark.gmsh
def test_uniform_heave_is_exact(points):
    displacement = np.tile([0.0, 0.07], (len(points.volume), 1))
    lifted = points._replace(position=points.position + displacement, displacement=displacement)
    profile = surface_profile(lifted, HALF_WIDTH, SPACING)
    assert height_at(profile, np.linspace(0.5, 4.0, 50)) == pytest.approx(0.07, abs=1e-10)


@pytest.mark.gmsh
def test_downdrag_beside_the_shaft_is_flattened(points):
    """A thin skin of soil dragged down half a metre must not tear the mesh."""
    dragged = moved(points, lambda x: 0.1 - 0.6 * np.exp(-((x - 0.5) / 0.05)))
    profile = surface_profile(dragged, HALF_WIDTH, SPACING)
    slopes = np.diff(profile.height) / np.diff(profile.x)
    assert np.abs(slopes).max() <= STEEPEST + 1e-12
    assert height_at(profile, np.array([2.0])) == pytest.approx(0.1, abs=1e-3)


@pytest.mark.gmsh
def test_gap_beside_the_shaft_takes_the_height_of_the_nearest_soil(points):
    displacement = np.column_stack(
        [0.3 * np.exp(-(points.position[:, 0] - 0.5)), np.full(len(points.volume), 0.05)]
    )
    parted = points._replace(position=points.position + displacement, displacement=displacement)
    profile = surface_profile(parted, HALF_WIDTH, SPACING)
    assert profile.x[0] > 0.7
    assert height_at(profile, np.array([0.5])) == pytest.approx(0.05, abs=1e-10)


@pytest.mark.gmsh
def test_outliers_do_not_pull_the_surface(points):
    calm = moved(points, lambda x: 0.1 + 0.0 * x)
    displacement = calm.displacement.copy()
    stray = np.flatnonzero(points.position[:, 1] > -0.05)[::7]
    displacement[stray, 1] += 1.0
    strayed = calm._replace(position=points.position + displacement, displacement=displacement)
    profile = surface_profile(strayed, HALF_WIDTH, SPACING)
    assert height_at(profile, np.linspace(0.6, 3.9, 20)) == pytest.approx(0.1, abs=0.005)


@pytest.mark.gmsh
def test_too_few_points_near_the_surface_are_named(points):
    deep = points.position[:, 1] < -1.0
    few = type(points)(*(field[deep] for field in points))
    few.displacement[:, 1] = 0.01
    with pytest.raises(ValueError, match="started near the surface"):
        surface_profile(few, HALF_WIDTH, SPACING)
