"""PA13, PA14 and PD9: interfaces; published values, energy of the loop, limits."""

import numpy as np
import pytest

from workflows.verification.references.annulus_energy import hencky, neo_hookean
from workflows.verification.references.annulus_interface import (
    annulus_interface,
    slipping_annulus,
)
from workflows.verification.references.annulus_torsion import annulus_torsion
from workflows.verification.references.cyclic_interface import dissipation_per_cycle, loop_corners
from workflows.verification.references.shaft import shaft_load

ANNULUS = {
    "inner_radius": 1.0,
    "outer_radius": 4.0,
    "youngs_modulus": 10.0,
    "poissons_ratio": 0.3,
    "shear_stiffness": 1e4,
    "cohesion": 0.5,
    "friction_angle": np.deg2rad(24.0),
}
FINITE = {"inner_radius": 1.0, "outer_radius": 4.0}
SHAFT = {
    "radius": 0.5,
    "length": 10.0,
    "outer_radius": 10.0,
    "shear_modulus": 5e3,
    "shear_stiffness": 1e5,
    "cohesion": 0.0,
    "friction_angle": np.deg2rad(24.0),
    "k0": 0.5,
    "unit_weight": 10.0,
}


def test_annulus_with_interface():
    result = annulus_interface(np.deg2rad([1.0, 10.0, 180.0, -10.0]), **ANNULUS)
    assert result.stiffness == pytest.approx(51.5121, abs=5e-5)
    assert result.strength == pytest.approx(3.14159, abs=5e-6)
    assert np.rad2deg(result.slip_onset) == pytest.approx(3.494, abs=5e-4)
    expected = [np.deg2rad(51.5121), np.pi, np.pi, -np.pi]
    np.testing.assert_allclose(result.torque, expected, rtol=1e-6)
    pressed = annulus_interface(1.0, **ANNULUS, radial_pressure=2.0)
    assert pressed.torque == pytest.approx(2.0 * np.pi * (0.5 + 2.0 * np.tan(np.deg2rad(24.0))))


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_slipping_annulus_carries_its_strength(friction):
    soil = FINITE | {"youngs_modulus": 10e3, "poissons_ratio": 0.3, "energy": hencky}
    result = slipping_annulus(**soil, cohesion=500.0, friction_angle=friction)
    strength = 500.0 + result.pressure * np.tan(friction)
    assert result.torque == pytest.approx(2.0 * np.pi * strength, rel=1e-9)
    assert result.pressure > 0.0
    stiff = slipping_annulus(
        **soil | {"youngs_modulus": 1e6}, cohesion=500.0, friction_angle=friction
    )
    assert stiff.pressure == pytest.approx(0.01 * result.pressure, rel=0.05)  # Poynting: strain^2


def test_pressure_of_the_nearly_incompressible_annulus():
    # neo-Hookean, incompressible: d sigma_rr / dr = G g^2 / r with the shear g = T / (2 pi G r^2)
    soil = FINITE | {"youngs_modulus": 30.0, "poissons_ratio": 0.4999}
    state = annulus_torsion(0.5, energy=neo_hookean, **soil)
    shear_modulus = 30.0 / 2.9998
    shear = state.torque / (2.0 * np.pi * shear_modulus)
    difference = 0.25 * shear_modulus * shear**2 * (1.0 - 4.0**-4)
    assert state.radial_stress[-1] - state.radial_stress[0] == pytest.approx(difference, rel=1e-4)


def test_soil_that_is_lost_before_it_slips():
    soil = FINITE | {"youngs_modulus": 10e3, "poissons_ratio": 0.3, "energy": hencky}
    with pytest.raises(ArithmeticError, match="no stable solution"):
        slipping_annulus(**soil, cohesion=5e4, friction_angle=0.4)


def test_shaft():
    result = shaft_load([1e-9, 1.0, -1.0], **SHAFT)
    assert result.capacity == pytest.approx(349.68, abs=5e-3)
    assert result.stiffness == pytest.approx(101481.0, abs=0.5)
    np.testing.assert_allclose(result.load[1:], [result.capacity, -result.capacity])
    assert result.load[0] == pytest.approx(1e-9 * result.stiffness, rel=1e-4)


@pytest.mark.parametrize("cohesion", [0.0, 5.0])
@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_shaft_load_is_the_integral_of_its_slices(cohesion, friction):
    data = SHAFT | {"cohesion": cohesion, "friction_angle": friction}
    depth = (np.arange(20000) + 0.5) * 10.0 / 20000
    strength = cohesion + 5.0 * depth * np.tan(friction)
    compliance = 1e-5 + 1e-4 * np.log(20.0)
    settlement = np.array([1e-4, 1e-3, 3e-3, 1e-2])
    stress = np.minimum(settlement[:, None] / compliance, strength)
    load = np.pi * stress.mean(axis=1) * 10.0
    np.testing.assert_allclose(shaft_load(settlement, **data).load, load, rtol=1e-6, atol=1e-9)


def test_cyclic_interface():
    data = {"amplitude": 5e-3, "shear_stiffness": 1e4, "shear_strength": 10.0}
    assert dissipation_per_cycle(**data) == pytest.approx(0.16, rel=1e-12)
    u, stress = loop_corners(**data)
    shoelace = 0.5 * abs(np.sum(u * np.roll(stress, -1) - stress * np.roll(u, -1)))
    assert shoelace == pytest.approx(0.16)
    np.testing.assert_allclose(np.diff(stress)[::2] / np.diff(u)[::2], 1e4)
    assert dissipation_per_cycle(**(data | {"amplitude": 9e-4})) == 0.0
