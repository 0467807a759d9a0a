"""Soil laws of effective stress, from stressed states: critical-state soils, pore fluid."""

from types import SimpleNamespace

import numpy as np
import pytest

from install_mpm.constitutive import dispatch, modified_cam_clay
from install_mpm.constitutive.frictional import APEX_STIFFNESS
from install_mpm.constitutive.parameters import (
    CriticalStateSand,
    HenckyElastic,
    ModifiedCamClay,
    MohrCoulomb,
)
from install_mpm.constitutive.pressure_elasticity import bulk_modulus, mean_pressure
from install_mpm.constitutive.state_variables import STATE_VARIABLES

CLAY = ModifiedCamClay(1.2, 0.2, 0.04, 1.0, overconsolidation_ratio=1.5)
HYPERELASTIC = ModifiedCamClay(1.2, 0.2, 0.04, 1.0, shear_modulus=2e6, overconsolidation_ratio=3.0)
DENSE = CriticalStateSand(0.55, 1.25, 0.9, 0.025, 40e6)
LOOSE = CriticalStateSand(0.85, 1.25, 0.9, 0.025, 20e6)
FIRM = CriticalStateSand(0.65, 1.25, 0.9, 0.025, 30e6, stiffness_exponent=0.0)
WATER = 500e6
SOILS = {
    "clay": CLAY,
    "hyperelastic clay": HYPERELASTIC,
    "dense sand": DENSE,
    "loose sand": LOOSE,
    "sand of constant stiffness": FIRM,
    "undrained clay": ModifiedCamClay(1.2, 0.2, 0.04, 1.0, pore_fluid_bulk_modulus=WATER),
    "undrained sand": CriticalStateSand(
        0.75, 1.25, 0.9, 0.025, 30e6, pore_fluid_bulk_modulus=WATER
    ),
    "undrained Mohr-Coulomb": MohrCoulomb(20e6, 0.3, 1e3, 0.6, 0.1, pore_fluid_bulk_modulus=WATER),
    "undrained elastic": HenckyElastic(4e6, 0.3, pore_fluid_bulk_modulus=WATER),
}
SIZES = {"small": 1e-3, "moderate": 2e-2, "large": 0.5}
"""Norm of the strain increment."""
VOLUMETRIC = np.outer([1, 1, 1, 0, 0, 0], [1, 1, 1, 0, 0, 0]) / 3.0
DEVIATORIC = np.eye(6) - VOLUMETRIC
"""Projections of six-vectors."""
N_STATES = 10_000
FEW = 500
every_soil = pytest.mark.parametrize("name", SOILS)
every_size = pytest.mark.parametrize("size", SIZES)
every_undrained = pytest.mark.parametrize("name", [n for n in SOILS if n.startswith("undrained")])


def vectors(tensors):
    scale = np.array([1.0, 1.0, 1.0, *[np.sqrt(2.0)] * 3])
    return np.ascontiguousarray(tensors[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]] * scale)


def strain_of(soil, stress, state):
    strain = np.empty((len(stress), 6))
    material = np.zeros(len(stress), dtype=np.int64)
    dispatch.elastic_strain_from_stress_all(
        dispatch.pack([soil]), material, stress, np.ascontiguousarray(state), strain
    )
    return strain


def evaluate(soil, trial, state):
    n = len(trial)
    result = SimpleNamespace(
        stress=np.empty((n, 6)),
        elastic_strain=np.empty((n, 6)),
        state=np.empty_like(state),
        tangent=np.empty((n, 6, 6)),
        status=np.full(n, -1),
    )
    dispatch.update_all(
        dispatch.pack([soil]), np.zeros(n, dtype=np.int64), np.ascontiguousarray(trial), state,
        result.stress, result.elastic_strain, result.state, result.tangent, result.status,
    )  # fmt: skip
    assert not result.status.any()
    return result


def yield_function(soil, stress, state):
    value = np.empty(len(stress))
    material = np.zeros(len(stress), dtype=np.int64)
    dispatch.yield_function_all(dispatch.pack([soil]), material, stress, state, value)
    return value


def size_of(stress):
    """Largest component (n, 1) in Pa, and 1 Pa at the apex of a cone."""
    return np.maximum(np.abs(stress).max(axis=1, keepdims=True), 1.0)


def ground(soil, rng, n=FEW):
    """Stress, state and strain of ground of random vertical stress, 1 kPa to 1 MPa, and K0."""
    vertical, k0 = 10.0 ** rng.uniform(3.0, 6.0, n), rng.uniform(0.6, 1.2, n)
    stress = np.zeros((n, 3, 3))
    for axis in range(3):
        stress[:, axis, axis] = -vertical * (1.0 if axis == 2 else k0)
    state = dispatch.initial_state(soil, np.zeros(n), stress)
    return vectors(stress), state, strain_of(soil, vectors(stress), state)


def increments(rng, size, n=FEW):
    strain = rng.normal(size=(n, 6))
    return SIZES[size] * strain / np.linalg.norm(strain, axis=1, keepdims=True)


@every_soil
@every_size
def test_consistent_tangent_is_the_derivative_of_the_stress(name, size, rng, tangent_errors):
    """Over 10,000 random states, tips of the ellipse and apex of the cone among them."""
    soil = SOILS[name]
    _, state, strain = ground(soil, rng, N_STATES)
    trial = strain + increments(rng, size, N_STATES)
    result = evaluate(soil, trial, state)
    start = evaluate(soil, strain, state).tangent
    scale = np.maximum(np.abs(result.tangent), np.abs(start)).max(axis=(1, 2))
    errors = tangent_errors(
        lambda moved, rows: evaluate(soil, moved, state[rows]).stress,
        trial, result.tangent, scale, min(3e-4 * SIZES[size], 1e-6),
    )  # fmt: skip
    assert errors.max() < 1e-6


@every_soil
@every_size
def test_stress_is_admissible_after_the_update(name, size, rng):
    soil = SOILS[name]
    _, state, strain = ground(soil, rng, N_STATES)
    result = evaluate(soil, strain + increments(rng, size, N_STATES), state)
    value = yield_function(soil, result.stress, result.state)
    assert (value / size_of(result.stress)[:, 0]).max() <= 1e-9


@every_soil
@every_size
def test_elastic_strain_and_stress_belong_together(name, size, rng):
    """Stress to strain and back changes nothing, and an admissible state stays where it is."""
    soil = SOILS[name]
    stress, state, strain = ground(soil, rng)
    still = evaluate(soil, strain, state)
    assert np.abs((still.stress - stress) / size_of(stress)).max() < 1e-10
    first = evaluate(soil, strain + increments(rng, size), state)
    strain = strain_of(soil, first.stress, first.state)
    assert np.abs(strain - first.elastic_strain).max() < 1e-9 * np.abs(strain).max()
    second = evaluate(soil, first.elastic_strain, first.state)
    assert np.abs((second.stress - first.stress) / size_of(first.stress)).max() < 1e-9


@every_soil
@every_size
def test_response_turns_with_the_strain(name, size, rng, make_rotation, tensors_of):
    soil, rotation = SOILS[name], make_rotation()

    def turned(six):
        return vectors(rotation @ tensors_of(six) @ rotation.T)

    _, state, strain = ground(soil, rng)
    trial = strain + increments(rng, size)
    plain, rotated = evaluate(soil, trial, state), evaluate(soil, turned(trial), state)
    expected = turned(plain.stress)
    scale = np.abs(expected).max(axis=1, keepdims=True)
    # round-off of the strain times the tangent
    scale = scale + 1e-2 * np.abs(plain.tangent).max(axis=(1, 2))[:, None] * np.abs(trial).max()
    assert np.abs((rotated.stress - expected) / scale).max() < 1e-10
    np.testing.assert_allclose(rotated.state, plain.state, rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("name", ["hyperelastic clay", "sand of constant stiffness"])
@every_size
def test_plastic_work_is_not_negative(name, size, rng):
    """Where the shear modulus is constant the plastic strain is what the elastic one has lost."""
    soil = HYPERELASTIC if name == "hyperelastic clay" else FIRM
    _, state, strain = ground(soil, rng)
    for _ in range(5):
        trial = strain + increments(rng, size)
        result = evaluate(soil, trial, state)
        if name != "hyperelastic clay":  # its shear modulus is K times a number, and K is constant
            np.testing.assert_allclose(result.state[:, 2], state[:, 2], rtol=1e-12)
        work = (result.stress * (trial - result.elastic_strain)).sum(axis=1)
        scale = size_of(result.stress)[:, 0] * SIZES[size]
        assert (work / scale).min() > -1e-9
        strain, state = result.elastic_strain, result.state


def elastic_cycle(soil):
    """Work in J/m^3 of one closed cycle of volume and shear in the elastic range, and its size."""
    stress = vectors(-100e3 * np.eye(3)[None])
    state = dispatch.initial_state(soil, np.zeros(1), -100e3 * np.eye(3)[None])
    start = strain = strain_of(soil, stress, state)
    volume = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]) / 3.0
    shear = np.array([0.0, 0.0, 0.0, np.sqrt(2.0), 0.0, 0.0])
    work = size = 0.0
    old = evaluate(soil, strain, state).stress
    for direction in (5e-3 * volume, 2e-3 * shear, -5e-3 * volume, -2e-3 * shear):
        for _ in range(200):
            result = evaluate(soil, strain + direction / 200.0, state)
            part = float((0.5 * (old + result.stress) * direction / 200.0).sum())
            work, size = work + part, size + abs(part)
            strain, state, old = result.elastic_strain, result.state, result.stress
    return work, size, np.abs(strain - start).max()


def test_a_constant_shear_modulus_keeps_the_energy_of_elastic_cycles():
    """With Poisson's ratio constant instead, the same cycle makes or takes work, as it must."""
    parameters = {"overconsolidation_ratio": 10.0}
    work, size, difference = elastic_cycle(
        ModifiedCamClay(1.2, 0.2, 0.04, 1.0, shear_modulus=2e6, **parameters)
    )
    assert abs(work) < 1e-6 * size
    assert difference < 1e-15
    work, size, _ = elastic_cycle(ModifiedCamClay(1.2, 0.2, 0.04, 1.0, **parameters))
    assert abs(work) > 1e-4 * size


@every_soil
def test_state_variables_have_names_units_and_start_values(name):
    soil, stress = SOILS[name], -np.array([50e3, 100e3])[:, None, None] * np.eye(3)
    names = dispatch.state_variable_names(soil)
    state = dispatch.initial_state(soil, np.zeros(2), stress)
    assert state.shape == (2, len(names))
    assert set(names) <= set(STATE_VARIABLES)
    if "preconsolidation_pressure" in names:
        size = state[:, names.index("preconsolidation_pressure")]
        np.testing.assert_allclose(size, [50e3, 100e3] * np.array(soil.overconsolidation_ratio))
    if isinstance(soil, CriticalStateSand):
        strain = strain_of(soil, vectors(stress), state)
        volume = state[:, names.index("plastic_log_volume")]
        if not name.startswith("undrained"):
            volume = volume + strain[:, :3].sum(axis=1)
            np.testing.assert_allclose(np.exp(volume) - 1.0, soil.void_ratio, rtol=1e-12)
    if name.startswith("undrained"):
        assert not state[:, 0].any()


@every_soil
def test_results_do_not_depend_on_the_number_of_threads(name, rng, threads):
    soil = SOILS[name]
    _, state, strain = ground(soil, rng)
    trial = strain + increments(rng, "moderate")
    results = []
    for n in (1, 2):
        threads(n)
        results.append(vars(evaluate(soil, trial, state)))
    for key, value in results[0].items():
        np.testing.assert_array_equal(value, results[1][key])


@pytest.mark.parametrize("name", ["clay", "dense sand"])
def test_a_strain_that_is_not_finite_is_told(name):
    soil = SOILS[name]
    state = dispatch.initial_state(soil, np.zeros(1), -50e3 * np.eye(3)[None])
    status = np.zeros(1, dtype=np.int64)
    dispatch.update_all(
        dispatch.pack([soil]), np.zeros(1, dtype=np.int64), np.full((1, 6), np.nan), state,
        np.empty((1, 6)), np.empty((1, 6)), state.copy(), np.empty((1, 6, 6)), status,
    )  # fmt: skip
    assert status[0] == modified_cam_clay.NOT_FINITE


def test_opened_sand_keeps_a_trace_of_its_elastic_tangent():
    """No stress, but a matrix of full rank: far less stiff than the sand that flows beside it."""
    soil, pressure = DENSE, 50e3
    tensor = -pressure * np.eye(3)[None]
    state = dispatch.initial_state(soil, np.zeros(1), tensor)
    trial = np.array([[0.1, 0.05, 0.0, 0.02, 0.0, 0.01]])
    opened = evaluate(soil, trial, state)
    assert not opened.stress.any()
    assert opened.state[0, 1] == pytest.approx(0.15)
    row = dispatch.pack([soil]).parameters[0]
    elastic = 3.0 * bulk_modulus(0.0, row) * VOLUMETRIC + 2.0 * state[0, 2] * DEVIATORIC
    np.testing.assert_allclose(opened.tangent[0], APEX_STIFFNESS * elastic, rtol=1e-12, atol=1e-20)


def test_sand_keeps_account_of_its_volume_while_it_opens_and_closes():
    """The opening is part of the plastic volume; from it the sand closes to where it opened."""
    soil, tensor = FIRM, -50e3 * np.eye(3)[None]
    start = dispatch.initial_state(soil, np.zeros(1), tensor)
    strain, state, total = strain_of(soil, vectors(tensor), start), start, 0.0
    volume_at_start = start[0, 0] + strain[0, :3].sum()
    stretches = np.array([0.02, 0.03, -0.01, -0.02, -0.03, -0.01])
    for stretch in stretches:
        strain = strain + stretch / 3.0 * np.array([[1.0, 1.0, 1.0, 0.0, 0.0, 0.0]])
        result = evaluate(soil, strain, state)
        strain, state, total = result.elastic_strain, result.state, total + stretch
        volume = state[0, 0] + strain[0, :3].sum()
        assert volume - volume_at_start == pytest.approx(total, abs=1e-13)
        assert state[0, 1] == 0.0 or state[0, 0] > start[0, 0]
    row = dispatch.pack([soil]).parameters[0]
    elastic_at_start = volume_at_start - start[0, 0]
    pressure = mean_pressure(elastic_at_start + stretches.sum(), row)
    assert invariants(result.stress[0])[0] == pytest.approx(pressure, rel=1e-12)
    assert state[0, 0] == pytest.approx(start[0, 0], abs=1e-13)


def compressed(soil, pressure, steps, axial, radial):
    """Results of steps of axial and radial strain from isotropic ``pressure``."""
    tensor = -pressure * np.eye(3)[None]
    state = dispatch.initial_state(soil, np.zeros(1), tensor)
    strain = strain_of(soil, vectors(tensor), state)
    results = []
    for _ in range(steps):
        strain = strain + np.array([[radial, radial, axial, 0.0, 0.0, 0.0]])
        result = evaluate(soil, strain, state)
        results.append(result)
        strain, state = result.elastic_strain, result.state
    return results


def invariants(stress):
    return -stress[:3].mean(), stress[0] - stress[2]


def test_clay_follows_its_normal_compression_line():
    """Isotropic compression: ln(volume) falls by lambda* for every factor e of pressure."""
    soil = ModifiedCamClay(1.2, 0.2, 0.04, 1.0)
    results = compressed(soil, 100e3, 50, -0.001, -0.001)
    pressure, shear = invariants(results[-1].stress[0])
    assert pressure == pytest.approx(100e3 * np.exp(0.15 / 0.1), rel=1e-10)
    assert abs(shear) < 1e-6
    assert results[-1].state[0, 0] == pytest.approx(pressure, rel=1e-12)


def test_dense_and_loose_sand_differ_by_void_ratio_alone():
    """Constant volume: one gains effective pressure, one loses it, both to the critical state."""
    final = {}
    for void_ratio in (0.75, 0.85):
        soil = CriticalStateSand(void_ratio, 1.25, 0.9, 0.025, 40e6)
        results = compressed(soil, 100e3, 4000, -1e-4, 0.5e-4)
        pressure, shear = invariants(results[-1].stress[0])
        assert pressure == pytest.approx(1e3 * np.exp((0.9 - void_ratio) / 0.025), rel=1e-3)
        assert shear / pressure == pytest.approx(1.25, rel=1e-4)
        final[void_ratio] = pressure
    assert final[0.75] > 400e3 > 100e3 > 10e3 > final[0.85]


def triaxial(soil, pressure, steps, shortening):
    """q in Pa and volumetric strain after steps of drained compression at constant cell stress."""
    tensor = -pressure * np.eye(3)[None]
    state = dispatch.initial_state(soil, np.zeros(1), tensor)
    strain = strain_of(soil, vectors(tensor), state)
    curve, volume, radial = [], 0.0, 0.0
    for _ in range(steps):
        for _ in range(30):
            trial = strain + np.array([[radial, radial, -shortening / steps, 0.0, 0.0, 0.0]])
            result = evaluate(soil, trial, state)
            excess = result.stress[0, 0] + pressure
            if abs(excess) < 1e-9 * pressure:
                break
            radial -= excess / result.tangent[0, 0, :2].sum()
        assert abs(excess) < 1e-9 * pressure
        volume += 2.0 * radial - shortening / steps
        strain, state = result.elastic_strain, result.state
        curve.append((invariants(result.stress[0])[1], volume))
    return np.array(curve)


def test_drained_sand_peaks_with_its_state_parameter_and_ends_critical():
    """At the peak q / p = M exp(-k psi) and dilation D = (M - q / p) / (1 - N)."""
    for void_ratio in (0.6, 0.7, 0.85):
        soil = CriticalStateSand(void_ratio, 1.25, 0.9, 0.025, 40e6)
        curve = triaxial(soil, 100e3, 3000, 1.2)
        deviator, volume = curve.T
        ratio = deviator / (100e3 + deviator / 3.0)
        critical = 0.9 - 0.025 * np.log(100.0 + deviator[-1] / 3e3)
        assert (1.0 + void_ratio) * np.exp(volume[-1]) - 1.0 == pytest.approx(critical, abs=2e-3)
        assert ratio[-1] == pytest.approx(1.25, rel=5e-3)
        if void_ratio < 0.8:
            peak = int(np.argmax(ratio))
            pressure = 100e3 + deviator[peak] / 3.0
            e = (1.0 + void_ratio) * np.exp(volume[peak]) - 1.0
            state_parameter = e - 0.9 + 0.025 * np.log(pressure / 1e3)
            expected = 1.25 * np.exp(-0.7 * 3.5 / 1.25 * state_parameter)
            assert ratio[peak] == pytest.approx(expected, rel=1e-6)
            assert volume[-1] > 0.0


def test_drained_clay_ends_critical():
    """q = 3 p_0 M / (3 - M) in drained triaxial compression, void ratio on the critical line."""
    soil = ModifiedCamClay(1.2, 0.2, 0.04, 1.0)
    deviator, volume = triaxial(soil, 100e3, 1000, 1.5)[-1]
    expected = 3.0 * 100e3 * 1.2 / (3.0 - 1.2)
    assert deviator == pytest.approx(expected, rel=1e-4)
    pressure = 100e3 + expected / 3.0
    # p_c = 2 p; ln v = -lambda* ln(p_c / p_c0) + kappa* ln(p_c / p)
    assert volume == pytest.approx(-0.1 * np.log(pressure / 50e3) + 0.02 * np.log(2.0), rel=1e-3)


@every_undrained
def test_pore_water_takes_the_volume_change(name, rng):
    """The excess pore pressure is K_w times compression, and the rest is the drained law."""
    soil = SOILS[name]
    drained = type(soil)(**{**vars(soil), "pore_fluid_bulk_modulus": 0.0})
    stress, state, strain = ground(soil, rng, 100)
    _, own_state, own_strain = stress, state[:, 2:], strain_of(drained, stress, state[:, 2:])
    increment = increments(rng, "small", 100)
    wet = evaluate(soil, strain + increment, state)
    dry = evaluate(drained, own_strain + increment, np.ascontiguousarray(own_state))
    pressure = -WATER * increment[:, :3].sum(axis=1)
    np.testing.assert_allclose(wet.state[:, 0], pressure, rtol=1e-10, atol=1e-6)
    effective = wet.stress + wet.state[:, :1] * (np.arange(6) < 3)
    scale = np.abs(stress).max(axis=1, keepdims=True)
    assert np.abs((effective - dry.stress) / scale).max() < 1e-9
    np.testing.assert_allclose(wet.state[:, 2:], dry.state, rtol=1e-9, atol=1e-12)


@every_undrained
def test_pore_pressure_of_a_total_stress_is_found(name, rng):
    """Also where the state says nothing about it, as after a hand-over."""
    soil = SOILS[name]
    _, state, strain = ground(soil, rng, 200)
    result = evaluate(soil, strain + increments(rng, "small", 200), state)
    unknown = result.state.copy()
    unknown[:, 0] = 0.0
    strain = strain_of(soil, result.stress, unknown)
    again = evaluate(soil, strain, unknown)
    scale = np.abs(result.stress).max(axis=1, keepdims=True)
    assert np.abs((again.stress - result.stress) / scale).max() < 1e-6
