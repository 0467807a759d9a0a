"""Admissibility (PF4): after the return no stress is outside, none inside has changed."""

import numpy as np
import pytest

from handoff.admissible import admissible_state, admissible_traction, yield_values
from handoff.fe_state_file import FEState
from handoff.geostatic import elastic_strain_of, geostatic_state
from install_mpm.constitutive.frictional import LOG_VOLUME, OPENING
from install_mpm.constitutive.parameters import CoulombInterface, MohrCoulomb
from install_mpm.ground import Ground

NOWHERE, NONE = np.zeros((0, 2)), np.zeros(0)
"""Places and shares of the strength of an interface without points."""


@pytest.fixture
def state(site) -> FEState:
    """Geostatic stress with random shear of up to twice the strength."""
    random = np.random.default_rng(0)
    positions = random.uniform((0.0, -5.0), (4.0, 0.0), size=(500, 2))
    calm = geostatic_state(site.ground, positions, np.zeros((0, 2)), np.zeros((0, 2)))
    shear = random.uniform(-40e3, 40e3, size=500)
    stress = calm.cauchy_stress.copy()
    stress[:, 0, 1] += shear
    stress[:, 1, 0] += shear
    return calm._replace(
        cauchy_stress=stress,
        elastic_strain=elastic_strain_of(site.ground, calm.material, stress, calm.state_variables),
    )


def test_no_stress_is_left_outside_the_yield_surface(site, state):
    corrected, corrections = admissible_state(site.ground, site.interface, NOWHERE, NONE, state)
    largest = np.abs(state.cauchy_stress).max()
    assert yield_values(site.ground, state).max() > 0.1 * largest
    assert yield_values(site.ground, corrected).max() <= 1e-6 * largest
    outside = yield_values(site.ground, state) > 0.0
    assert corrections.share == pytest.approx(outside.mean())
    assert 0.0 < corrections.mean < corrections.largest < 0.6


def test_admissible_stresses_and_all_mean_stresses_are_untouched(site, state):
    corrected, _ = admissible_state(site.ground, site.interface, NOWHERE, NONE, state)
    inside = yield_values(site.ground, state) <= 0.0
    assert 100 < inside.sum() < 400
    assert np.abs(corrected.cauchy_stress - state.cauchy_stress)[inside].max() < 1e-9
    assert np.array_equal(corrected.state_variables[inside], state.state_variables[inside])
    traces = [np.trace(s.cauchy_stress, axis1=1, axis2=2) for s in (state, corrected)]
    assert traces[1] == pytest.approx(traces[0], rel=1e-12)


def test_elastic_strain_carries_the_corrected_stress(site, state):
    corrected, _ = admissible_state(site.ground, site.interface, NOWHERE, NONE, state)
    expected = elastic_strain_of(
        site.ground, corrected.material, corrected.cauchy_stress, corrected.state_variables
    )
    assert corrected.elastic_strain == pytest.approx(expected, abs=1e-14)


def test_size_of_a_correction_is_relative_to_the_deviator(site):
    """Pure shear of twice the strength loses half of its deviator."""
    calm = geostatic_state(site.ground, np.array([[2.0, 0.0]]), np.zeros((0, 2)), np.zeros((0, 2)))
    stress = np.zeros((1, 3, 3))
    stress[0, 0, 1] = stress[0, 1, 0] = 40e3
    corrected, corrections = admissible_state(
        site.ground, site.interface, NOWHERE, NONE, calm._replace(cauchy_stress=stress)
    )
    assert corrected.cauchy_stress[0, 0, 1] == pytest.approx(20e3)
    assert corrections == pytest.approx((1.0, 0.5, 0.5))


def test_soil_under_pressure_has_no_opening():
    """Averaged with open soil, it would lose its pressure in the first step."""
    sand = MohrCoulomb(30e6, 0.25, 1e3, 0.6, 0.1, 0.6, 0.75)
    ground = Ground(unit_weight=18e3, k0=0.5, soil=sand)
    calm = geostatic_state(ground, np.array([[2.0, -1.0]] * 3), np.zeros((0, 2)), np.zeros((0, 2)))
    apex = sand.cohesion / np.tan(sand.friction_angle)
    stress = np.array([calm.cauchy_stress[0], apex * np.eye(3), apex * np.diag([2.0, 2.0, 3.0])])
    variables = calm.state_variables.copy()
    variables[:, OPENING] = 0.01
    strain = elastic_strain_of(ground, calm.material, stress, variables)
    mixed = calm._replace(cauchy_stress=stress, elastic_strain=strain, state_variables=variables)
    interface = CoulombInterface(1e9, 1e8)
    corrected, corrections = admissible_state(ground, interface, NOWHERE, NONE, mixed)
    assert corrected.state_variables[0, OPENING] == 0.0
    assert corrected.state_variables[1, OPENING] == 0.01
    assert corrected.state_variables[2, OPENING] > 0.01
    np.testing.assert_allclose(corrected.cauchy_stress[:2], stress[:2], rtol=1e-9)
    volume = corrected.state_variables[:2, LOG_VOLUME]
    assert volume == pytest.approx(variables[:2, LOG_VOLUME] - [0.01, 0.0], abs=1e-14)
    assert corrections.share == pytest.approx(1.0 / 3.0)


def test_tractions_are_reduced_to_the_adhesion(site):
    traction = np.array([[15e3, -50e3], [-15e3, -50e3], [5e3, 20e3]])
    positions = np.column_stack([np.full(3, 0.5), np.zeros(3)])
    share = np.array([1.0, 1.04, 1.0])
    returned = admissible_traction(site.ground, site.interface, positions, share, traction)
    assert returned == pytest.approx(np.array([[10e3, -50e3], [-10.4e3, -50e3], [5e3, 20e3]]))
