"""PA2: cantilever with a tip load; published deflections, differential equation, small loads."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from workflows.verification.references.elastica import cantilever_tip, elastica_tip

AMPLE = {
    "load": 100e3,
    "length": 10.0,
    "depth": 1.0,
    "youngs_modulus": 12e6,
    "poissons_ratio": 0.2,
}


def test_published_digits_of_the_beam():
    plane_stress = cantilever_tip(**AMPLE, is_plane_strain=False)
    assert plane_stress.deflection == pytest.approx(8.1061, abs=5e-5)
    assert plane_stress.shortening == pytest.approx(5.5500, abs=5e-5)
    assert np.rad2deg(plane_stress.angle) == pytest.approx(81.95, abs=5e-3)
    plane_strain = cantilever_tip(**AMPLE)
    assert plane_strain.deflection == pytest.approx(8.0624, abs=5e-5)
    assert plane_strain.shortening == pytest.approx(5.4613, abs=5e-5)


@pytest.mark.parametrize(
    ("load_number", "deflection", "shortening"),
    [(1, 0.30172, 0.05643), (2, 0.49346, 0.16064), (4, 0.66996, 0.32894), (5, 0.71379, 0.38763)],
)
def test_published_digits_of_other_loads(load_number, deflection, shortening):
    tip = elastica_tip(load_number)
    assert tip.deflection == pytest.approx(deflection, abs=5e-6)
    assert tip.shortening == pytest.approx(shortening, abs=5e-6)


@pytest.mark.parametrize(
    ("share", "shortening", "deflection"), [(0.02, 0.0244, 0.6373), (0.08, 0.3546, 2.4063)]
)
def test_first_steps_of_the_beam(share, shortening, deflection):
    tip = cantilever_tip(**(AMPLE | {"load": share * 100e3}))
    assert tip.shortening == pytest.approx(shortening, abs=5e-5)
    assert tip.deflection == pytest.approx(deflection, abs=5e-5)


@pytest.mark.parametrize("load_number", [0.5, 10.0, 60.0])
def test_curve_shot_back_from_the_tip_ends_at_the_support(load_number):
    tip = elastica_tip(load_number)

    def back(_, y):
        return [y[1], -load_number * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])]

    end = solve_ivp(back, (0.0, -1.0), [tip.angle, 0.0, 0.0, 0.0], rtol=1e-11, atol=1e-12).y[:, -1]
    assert end[0] == pytest.approx(0.0, abs=1e-6)
    assert -end[2] == pytest.approx(1.0 - tip.shortening, abs=1e-7)
    assert -end[3] == pytest.approx(tip.deflection, abs=1e-7)


def test_small_load_and_no_load():
    tip = elastica_tip(1e-3)
    assert tip.deflection == pytest.approx(1e-3 / 3.0, rel=1e-5)
    assert tip.angle == pytest.approx(1e-3 / 2.0, rel=1e-5)
    assert elastica_tip(0.0).deflection == 0.0
    with pytest.raises(ValueError, match="must not be negative"):
        elastica_tip(-1.0)
