"""PA1: column under its own weight; published height, positions and base stretch."""

import numpy as np
import pytest
from scipy.integrate import quad

from workflows.verification.references.column import column, constrained_modulus

AMPLE = {
    "length": 50.0,
    "youngs_modulus": 1e4,
    "poissons_ratio": 0.0,
    "density": 80.0,
    "gravity": 10.0,
}


def test_published_digits():
    state = column([0.0, 25.0, 50.0], **AMPLE)
    assert state.height[2] == pytest.approx(24.0596, abs=5e-5)
    assert state.height[1] == pytest.approx(8.8587, abs=5e-5)
    assert state.stretch[0] == pytest.approx(0.30054, abs=5e-6)
    assert state.vertical_stress[0] == pytest.approx(-40e3)
    assert state.displacement[2] == pytest.approx(-25.940354, abs=5e-7)


@pytest.mark.parametrize(
    ("cells", "displacement"), [(16, -25.917350), (32, -25.934434), (64, -25.938852)]
)
def test_top_points_of_the_independent_code(cells, displacement):
    top_point = column(50.0 - 50.0 / cells / 4.0, **AMPLE)
    assert top_point.displacement == pytest.approx(displacement, abs=5e-7)


def test_stretch_obeys_the_hencky_law_and_adds_up_to_the_height():
    data = AMPLE | {"poissons_ratio": 0.3, "youngs_modulus": 3e4}
    original = np.linspace(0.0, 50.0, 7)
    state = column(original, **data)
    modulus = constrained_modulus(youngs_modulus=3e4, poissons_ratio=0.3)
    hencky = modulus * np.log(state.stretch) / state.stretch
    np.testing.assert_allclose(hencky, state.vertical_stress, rtol=1e-12, atol=1e-9)
    lame = modulus - 3e4 / 1.3
    np.testing.assert_allclose(
        lame * np.log(state.stretch) / state.stretch, state.horizontal_stress, rtol=1e-12, atol=1e-9
    )
    for y, height in zip(original, state.height, strict=True):
        assert height == pytest.approx(quad(lambda z: column(z, **data).stretch, 0.0, y)[0])


def test_stiff_column_has_the_small_strain_settlement():
    state = column(50.0, **(AMPLE | {"youngs_modulus": 1e9}))
    assert state.displacement == pytest.approx(-800.0 * 50.0**2 / 2e9, rel=1e-4)
