"""PA3: stretched block; published forces, the material law in three dimensions, mesh motion."""

import numpy as np
import pytest

from workflows.verification.references.stretched_body import moved_heights, stretched_body

UNIT = {"height": 1.0, "width": 1.0, "youngs_modulus": 10.0}


@pytest.mark.parametrize("is_plane_strain", [True, False])
def test_published_digits(is_plane_strain):
    body = stretched_body(
        [0.25, 0.5, 1.0, -0.25, -0.5],
        **UNIT,
        poissons_ratio=0.0,
        is_plane_strain=is_plane_strain,
    )
    published = [1.78515, 2.70310, 3.46574, -3.83576, -13.86294]
    np.testing.assert_allclose(body.force, published, rtol=0, atol=5e-6)
    np.testing.assert_allclose(body.width, 1.0)


@pytest.mark.parametrize("is_plane_strain", [True, False])
def test_stress_obeys_the_hencky_law_with_free_sides(is_plane_strain):
    data = {"height": 2.0, "width": 0.7, "youngs_modulus": 10.0, "poissons_ratio": 0.3}
    body = stretched_body(0.8, **data, is_plane_strain=is_plane_strain)
    shear, lame = 10.0 / 2.6, 10.0 * 0.3 / (1.3 * 0.4)
    sideways = body.width / 0.7
    log_strain = np.log([sideways, 1.4, 1.0 if is_plane_strain else sideways])
    kirchhoff = 2.0 * shear * log_strain + lame * log_strain.sum()
    cauchy = kirchhoff / np.exp(log_strain.sum())
    assert cauchy[0] == pytest.approx(0.0, abs=1e-12)
    assert cauchy[1] == pytest.approx(body.stress)
    if not is_plane_strain:
        assert cauchy[2] == pytest.approx(0.0, abs=1e-12)
    assert body.area == pytest.approx(2.8 * body.width)


def test_force_is_largest_at_the_stretch_e_and_linear_at_first():
    data = UNIT | {"poissons_ratio": 0.25}
    around_peak = stretched_body(np.e - 1.0 + np.array([-1e-2, 0.0, 1e-2]), **data).force
    assert around_peak.argmax() == 1
    assert stretched_body(1e-6, **data).force == pytest.approx(1e-6 * 10.0 / 0.9375, rel=1e-5)


def test_mesh_follows_the_top_of_the_body():
    heights = np.array([0.0, 0.5, 1.0, 1.5, 2.0])
    moved = moved_heights(heights, body_height=1.0, mesh_height=2.0, displacement=0.5)
    np.testing.assert_allclose(moved, [0.0, 0.75, 1.5, 1.75, 2.0])
    back = moved_heights(moved, body_height=1.5, mesh_height=2.0, displacement=-0.5)
    np.testing.assert_allclose(back, heights)
