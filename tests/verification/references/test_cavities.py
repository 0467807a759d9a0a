"""PA16 and PA18: cavity expansion; published pressures, integrated equilibrium, limits."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from workflows.verification.references.cylindrical_cavity import cylinder_pressure, sphere_pressure
from workflows.verification.references.mohr_coulomb_cavity import (
    MohrCoulombSoil,
    cavity_pressure,
)

TRESCA = {"shear_modulus": 100.0, "undrained_shear_strength": 1.0}


def test_published_cylinder_pressures():
    pressure = cylinder_pressure([1.01, 1.05, 1.1, 1.2, 1.5, 2.0, 5.0], **TRESCA)
    published = [1.6807, 3.2322, 3.8564, 4.4220, 5.0199, 5.3200, 5.5668]
    np.testing.assert_allclose(pressure, published, rtol=0, atol=5e-5)
    # published 5.6076, a truncated 5.60767
    assert cylinder_pressure(np.inf, **TRESCA) == pytest.approx(5.6076, abs=1e-4)


@pytest.mark.parametrize(("n", "pressure"), [(2, cylinder_pressure), (3, sphere_pressure)])
@pytest.mark.parametrize("expansion", [1.002, 1.3])
def test_pressure_is_the_integral_of_equilibrium(n, pressure, expansion):
    shift = expansion**n - 1.0
    outer = (50.0**n + shift) ** (1.0 / n)

    def slope(r):  # -d(sigma_r) / dr, compression positive
        stretch = np.log(r / (r**n - shift) ** (1.0 / n))
        elastic = 2.0 * TRESCA["shear_modulus"] * n * stretch  # 2 G (e_theta - e_r)
        return (n - 1) * min(elastic, 2.0) / r

    integral = quad(slope, expansion, outer, epsrel=1e-10, limit=200)[0]
    assert pressure(expansion, **TRESCA, outer_ratio=50.0) == pytest.approx(integral, rel=1e-7)


def test_limits_of_small_and_infinite_expansion():
    soft = {"shear_modulus": 1e6, "undrained_shear_strength": 1.0}
    classical = 1.0 + np.log(1e6)
    assert cylinder_pressure(np.inf, **soft) == pytest.approx(classical, rel=1e-6)
    assert sphere_pressure(np.inf, **soft) == pytest.approx(4.0 / 3.0 * classical, rel=1e-6)
    assert cylinder_pressure(1.0 + 1e-6, **TRESCA) == pytest.approx(2e-4, rel=1e-5)
    assert sphere_pressure(1.0 + 1e-6, **TRESCA) == pytest.approx(4e-4, rel=1e-5)
    assert cylinder_pressure(1.0, **TRESCA) == 0.0


def test_contraction_is_refused():
    with pytest.raises(ValueError, match="must be at least 1"):
        cylinder_pressure([1.0, 0.9], **TRESCA)
    with pytest.raises(ValueError, match="must be at least 1"):
        cavity_pressure(0.9, soil(30, 0), is_sphere=True)


def soil(friction, dilation, **changes):
    values = {
        "initial_pressure": 1.0,
        "cohesion": 0.0,
        "friction_angle": np.deg2rad(friction),
        "dilation_angle": np.deg2rad(dilation),
        "youngs_modulus": 1000.0,
        "poissons_ratio": 0.3,
    }
    return MohrCoulombSoil(**(values | changes))


@pytest.mark.parametrize(
    ("is_sphere", "friction", "dilation", "limit"),
    [
        (False, 30, 0, 12.334),
        (False, 30, 15, 20.177),
        (False, 30, 30, 31.127),
        (False, 40, 10, 25.482),
        (True, 30, 0, 26.054),
        (True, 30, 15, 59.998),
        (True, 40, 10, 74.087),
    ],
)
def test_published_limit_pressures(is_sphere, friction, dilation, limit):
    pressure = cavity_pressure(np.inf, soil(friction, dilation), is_sphere=is_sphere)
    assert pressure == pytest.approx(limit, abs=5.1e-4)


@pytest.mark.parametrize("is_sphere", [False, True])
def test_equals_the_papers_closed_form(is_sphere):
    # Yu & Houlsby (1991), eqs for a/a_0 and the series Lambda_1, here as the integral it stands for
    ground = soil(25, 8, cohesion=0.3)
    k, nu, young = 1 + is_sphere, 0.3, 1000.0
    alpha, beta = ground.alpha, ground.beta
    strength = ground.y + (alpha - 1.0)
    shear = young / 2.6
    gamma = alpha * (beta + k) / (k * (alpha - 1.0) * beta)
    delta = strength / (2.0 * (k + alpha) * shear)
    exponent = (beta + k) * (1.0 - 2.0 * nu) * strength * (1.0 + (2.0 - k) * nu)
    eta = np.exp(exponent / (young * (alpha - 1.0) * beta))
    xi = (1.0 - nu**2 * (2.0 - k)) * (1.0 + k) * delta / ((1.0 + nu) * (alpha - 1.0) * beta)
    poisson = k * nu * (alpha + beta) / (1.0 - nu * (2.0 - k))
    xi *= alpha * beta + k * (1.0 - 2.0 * nu) + 2.0 * nu - poisson

    def expansion(pressure):
        ratio = (k + alpha) * (ground.y + (alpha - 1.0) * pressure) / (alpha * (1.0 + k) * strength)
        series = quad(lambda u: np.exp(xi * u) * u ** (-gamma - 1.0), 1.0, ratio)[0]
        power = (beta + k) / beta
        denominator = (1.0 - delta) ** power - gamma / eta * series
        return (ratio**-gamma / denominator) ** (1.0 / power)

    for wanted in (1.5, 4.0):
        pressure = cavity_pressure(wanted, ground, is_sphere=is_sphere)
        assert expansion(pressure) == pytest.approx(wanted, rel=1e-6)


@pytest.mark.parametrize("is_sphere", [False, True])
def test_without_friction_it_is_the_tresca_cavity(is_sphere):
    clay = soil(0, 0, cohesion=1.0, youngs_modulus=300.0, poissons_ratio=0.49999)
    tresca = (sphere_pressure if is_sphere else cylinder_pressure)(np.inf, **TRESCA)
    pressure = cavity_pressure(np.inf, clay, is_sphere=is_sphere)
    assert pressure - 1.0 == pytest.approx(tresca, rel=1e-3)
    nearly = soil(0.01, 0, cohesion=1.0, youngs_modulus=300.0, poissons_ratio=0.49999)
    assert cavity_pressure(np.inf, nearly, is_sphere=is_sphere) == pytest.approx(pressure, rel=1e-3)


def test_elastic_cavity_and_first_yield():
    sand = soil(30, 0)
    shear = 1000.0 / 2.6
    assert cavity_pressure(1.0001, sand, is_sphere=False) == pytest.approx(
        1.0 + 2.0 * shear * 1e-4, rel=1e-4
    )
    first_yield = brentq(
        lambda a: cavity_pressure(a, sand, is_sphere=False) - 1.5 + 1e-12, 1.0, 1.01
    )
    around = [cavity_pressure(first_yield * f, sand, is_sphere=False) for f in (1 - 1e-7, 1 + 1e-7)]
    assert around[1] - around[0] == pytest.approx(4e-7 * shear, rel=1e-2)
