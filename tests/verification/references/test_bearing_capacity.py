"""PB1, PB2, PB3, PB6 and PB7: bearing and penetration factors; published values and limits."""

import numpy as np
import pytest

from workflows.verification.references.bearing_capacity import (
    deep_cylinder_factor,
    strip_factors,
    strip_pressure,
)
from workflows.verification.references.circular_footing import circular_footing_pressure
from workflows.verification.references.penetration import (
    lu_factor,
    penetration_corridor,
    teh_houlsby_factor,
)


def test_strip():
    assert strip_pressure(undrained_shear_strength=1.0) == pytest.approx(5.1416, abs=5e-5)


@pytest.mark.parametrize(
    ("degrees", "n_q", "n_c"), [(20, 6.399, 14.835), (30, 18.401, 30.140), (40, 64.195, 75.313)]
)
def test_strip_on_frictional_soil(degrees, n_q, n_c):
    factors = strip_factors(friction_angle=np.deg2rad(degrees))
    np.testing.assert_allclose(factors, [n_q, n_c], rtol=0, atol=5.1e-4)


def test_strip_factor_tends_to_that_of_clay():
    assert strip_factors(friction_angle=1e-6)[1] == pytest.approx(2.0 + np.pi, rel=1e-5)


@pytest.mark.parametrize(("is_rough", "factor"), [(False, 5.689), (True, 6.048)])
def test_circle(is_rough, factor):
    pressure = circular_footing_pressure(undrained_shear_strength=1.0, is_rough=is_rough)
    assert pressure == pytest.approx(factor, abs=5e-4)
    coarse = circular_footing_pressure(undrained_shear_strength=7.0, is_rough=is_rough, n=10)
    assert coarse / 7.0 == pytest.approx(pressure, rel=2e-4)


@pytest.mark.parametrize(("adhesion", "factor"), [(0.0, 9.142), (0.5, 10.820), (1.0, 11.940)])
def test_deep_cylinder(adhesion, factor):
    assert deep_cylinder_factor(adhesion=adhesion) == pytest.approx(factor, abs=5e-4)


def test_deep_cylinder_limits():
    assert deep_cylinder_factor(adhesion=0.0) == pytest.approx(6.0 + np.pi)
    assert deep_cylinder_factor(adhesion=1.0) == pytest.approx(2.0 * np.pi + 4.0 * np.sqrt(2.0))


def test_adhesion_above_the_strength_is_refused():
    with pytest.raises(ValueError, match="must lie between 0 and 1"):
        deep_cylinder_factor(adhesion=1.2)


def test_penetration():
    data = {"rigidity_index": 100.0}
    assert lu_factor(**data, adhesion=0.0) == pytest.approx(10.77, abs=5e-3)
    assert lu_factor(**data, adhesion=1.0) == pytest.approx(12.07, abs=5e-3)
    smooth = teh_houlsby_factor(**data, face_adhesion=0.0, shaft_adhesion=0.0)
    rough = teh_houlsby_factor(**data, face_adhesion=1.0, shaft_adhesion=1.0)
    assert smooth == pytest.approx(9.73, abs=5e-3)
    assert rough == pytest.approx(11.93, abs=5e-3)
    lower, upper = penetration_corridor(**data, adhesion=0.5)
    assert 9.5 < lower < upper < 12.5
