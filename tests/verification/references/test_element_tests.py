"""PE1-PE4, PE6 and PE7: one point of soil; published values, limits, integrated laws."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from workflows.verification.references.cam_clay import (
    CamClay,
    critical_pressure,
    undrained_shear_strength,
    undrained_triaxial,
)
from workflows.verification.references.element_tests import (
    drained_triaxial,
    hencky_simple_shear,
    hencky_simple_shear_peak,
    oedometer,
    simple_shear_ratio,
    undrained_strength,
)

CLAY = CamClay(1.2, 0.2, 0.04, 1.0, 0.3)


@pytest.mark.parametrize(("dilation", "modulus"), [(0.0, 6000.0), (30.0, 8181.8)])
def test_oedometer(dilation, modulus):
    k, plastic = oedometer(
        friction_angle=np.deg2rad(30.0),
        dilation_angle=np.deg2rad(dilation),
        youngs_modulus=10e3,
        poissons_ratio=0.0,
    )
    assert k == pytest.approx(1.0 / 3.0)
    assert plastic == pytest.approx(modulus, abs=0.05)


def test_oedometer_stays_elastic_where_poissons_ratio_carries_the_sides():
    data = {"friction_angle": np.deg2rad(30.0), "dilation_angle": 0.1}
    k, modulus = oedometer(**data, youngs_modulus=10e3, poissons_ratio=0.3)
    assert k == pytest.approx(0.3 / 0.7)
    assert modulus == pytest.approx(10e3 * 0.7 / (1.3 * 0.4))


def test_drained_triaxial():
    soil = {
        "cell_pressure": 100.0,
        "cohesion": 0.0,
        "friction_angle": np.deg2rad(30.0),
        "youngs_modulus": 20e3,
        "poissons_ratio": 0.3,
    }
    result = drained_triaxial([0.005, 0.01, 0.05], **soil, dilation_angle=0.0)
    np.testing.assert_allclose(result.deviator_stress, [100.0, 200.0, 200.0], rtol=1e-12)
    np.testing.assert_allclose(result.volumetric_strain, [-0.002, -0.004, -0.004], rtol=1e-12)
    dilating = drained_triaxial([0.01, 0.05], **soil, dilation_angle=np.deg2rad(10.0))
    sine = np.sin(np.deg2rad(10.0))
    rate = np.diff(dilating.volumetric_strain)[0] / 0.04
    assert rate == pytest.approx(2.0 * sine / (1.0 - sine))


@pytest.mark.parametrize(("degrees", "ratio"), [(24, 0.94106), (30, 1.2), (35, 1.41833)])
def test_undrained_mohr_coulomb(degrees, ratio):
    strength = undrained_strength(
        mean_pressure=50.0, cohesion=0.0, friction_angle=np.deg2rad(degrees)
    )
    assert strength / 50.0 == pytest.approx(ratio, abs=5e-6)
    tresca = undrained_strength(mean_pressure=50.0, cohesion=7.0, friction_angle=0.0)
    assert tresca == pytest.approx(14.0)


@pytest.mark.parametrize(
    ("friction", "dilation", "ratio"), [(30, 0, 0.5), (35, 5, 0.60146), (40, 10, 0.71256)]
)
def test_simple_shear(friction, dilation, ratio):
    friction, dilation = np.deg2rad([friction, dilation])
    computed = simple_shear_ratio(friction_angle=friction, dilation_angle=dilation)
    assert computed == pytest.approx(ratio, abs=5e-6)
    associated = simple_shear_ratio(friction_angle=friction, dilation_angle=friction)
    assert associated == pytest.approx(np.tan(friction))


def test_hencky_simple_shear():
    stress = hencky_simple_shear([0.1, 0.5, 1.0, 2.0], shear_modulus=1.0)
    np.testing.assert_allclose(
        stress, [0.099834, 0.480155, 0.860818, 1.246450], rtol=0, atol=5.1e-7
    )
    shear, peak = hencky_simple_shear_peak(shear_modulus=2.0)
    assert shear == pytest.approx(3.018, abs=5e-4)
    assert peak == pytest.approx(2.0 * 1.32549, abs=1e-5)
    around = hencky_simple_shear(shear + np.array([-0.01, 0.0, 0.01]), shear_modulus=2.0)
    assert around.argmax() == 1


def test_cam_clay_published_digits():
    assert undrained_shear_strength(CLAY, mean_pressure=100.0) == pytest.approx(34.461, abs=5e-4)
    assert critical_pressure(CLAY, mean_pressure=100.0) == pytest.approx(57.435, abs=5e-4)
    deviator = [
        undrained_triaxial(strain, CLAY, mean_pressure=100.0)[0]
        for strain in (0.005, 0.01, 0.02, 0.05)
    ]
    np.testing.assert_allclose(deviator, [31.371, 50.340, 63.727, 68.586], rtol=0, atol=5.1e-4)


@pytest.mark.parametrize("ratio", [1.3, 2.0, 6.0])
def test_cam_clay_equals_its_rate_equations(ratio):
    m, kappa, share, volume = 1.2, 0.04, 0.8, 2.0
    p_over_g = 2.6 / 1.2 * kappa / volume
    yield_ratio = m * np.sqrt(ratio - 1.0)
    elastic = yield_ratio * p_over_g / 3.0

    def rate(_, y):  # plastic strain and stress as functions of the shear strain
        p, q = y
        eta = q / p
        pressure_by_eta = -share * 2.0 * eta / (m**2 + eta**2) * p
        plastic_by_eta = (kappa / volume) * share * 4.0 * eta**2 / (m**4 - eta**4)
        deviator_by_eta = p + eta * pressure_by_eta
        eta_rate = 1.0 / (plastic_by_eta + deviator_by_eta * p_over_g / (3.0 * p))
        return [pressure_by_eta * eta_rate, deviator_by_eta * eta_rate]

    data = {"mean_pressure": 100.0, "overconsolidation_ratio": ratio}
    if ratio != 2.0:
        start = [100.0, 100.0 * yield_ratio]
        path = solve_ivp(rate, (elastic, elastic + 0.02), start, "Radau", rtol=1e-9, atol=1e-9)
        q, p = undrained_triaxial(elastic + 0.02, CLAY, **data)
        np.testing.assert_allclose([p, q], path.y[:, -1], rtol=1e-6)
    q, p = undrained_triaxial(3.0, CLAY, **data)
    assert q == pytest.approx(2.0 * undrained_shear_strength(CLAY, **data))
    assert p == pytest.approx(critical_pressure(CLAY, **data))
    assert undrained_triaxial(0.5 * elastic, CLAY, **data)[0] == pytest.approx(50.0 * yield_ratio)
