"""What every soil law in ``dispatch`` must satisfy, and the plastic laws in particular."""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import expm

from install_mpm.constitutive import dispatch, tresca
from install_mpm.constitutive.dispatch import Model
from install_mpm.constitutive.parameters import (
    DruckerPrager,
    HenckyElastic,
    MohrCoulomb,
    NeoHookean,
    Tresca,
    VonMises,
)
from install_mpm.constitutive.state_variables import STATE_VARIABLES

SOILS = {
    Model.HENCKY_ELASTIC: HenckyElastic(4e6, 0.3),
    Model.VON_MISES: VonMises(4e6, 0.3, 20e3, 2e3),
    Model.NEO_HOOKEAN: NeoHookean(4e6, 0.3),
    Model.TRESCA: Tresca(4e6, 0.3, 20e3, 2e3),
    Model.MOHR_COULOMB: MohrCoulomb(4e6, 0.3, 20e3, 0.6, 0.2),
    Model.DRUCKER_PRAGER: DruckerPrager(4e6, 0.3, 20e3, 0.6, 0.2),
}
PRESSURE_DEPENDENT = {Model.MODIFIED_CAM_CLAY, Model.CRITICAL_STATE_SAND}
"""Tested in test_pressure_dependent_laws.py, from stressed states."""
SIZES = {"elastic": 1e-3, "plastic": 5e-2, "large": 1.0}
"""Norm of the trial strain; the strength is reached at a shear strain of about 1e-2."""

N_STATES = 40
every_model = pytest.mark.parametrize("model", list(SOILS), ids=lambda model: model.name)
CLAYS = [Model.VON_MISES, Model.TRESCA]
every_clay = pytest.mark.parametrize("model", CLAYS, ids=lambda model: model.name)
every_size = pytest.mark.parametrize("size", SIZES)


def start_state(soil, depth):
    """State variables at ``depth`` (n,) in unstressed soil."""
    depth = np.asarray(depth)
    return dispatch.initial_state(soil, depth, np.zeros((len(depth), 3, 3)))


def evaluate(model, trial, state=None):
    """Evaluate the law at trial strains (n, 6)."""
    soil = SOILS[model]
    trial = np.ascontiguousarray(trial)
    n = len(trial)
    if state is None:
        state = start_state(soil, np.zeros(n))
    result = SimpleNamespace(
        stress=np.empty((n, 6)),
        elastic_strain=np.empty((n, 6)),
        state=np.empty_like(state),
        tangent=np.empty((n, 6, 6)),
        status=np.full(n, -1),
    )
    material = np.zeros(n, dtype=np.int64)
    dispatch.update_all(
        dispatch.pack([soil]), material, trial, state, result.stress, result.elastic_strain,
        result.state, result.tangent, result.status,
    )  # fmt: skip
    assert (result.status == 0).all()
    return result


def yield_function(model, stress, state):
    value = np.empty(len(stress))
    material = np.zeros(len(stress), dtype=np.int64)
    dispatch.yield_function_all(dispatch.pack([SOILS[model]]), material, stress, state, value)
    return value


def strain_from_stress(model, stress, state):
    strain = np.empty_like(stress)
    material = np.zeros(len(stress), dtype=np.int64)
    dispatch.elastic_strain_from_stress_all(
        dispatch.pack([SOILS[model]]), material, stress, state, strain
    )
    return strain


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def deviator(vectors):
    result = vectors.copy()
    result[..., :3] -= vectors[..., :3].mean(axis=-1, keepdims=True)
    return result


@pytest.fixture
def trial_strains(rng):
    """Function that returns random trial strains (n, 6) of a given norm."""

    def make(size):
        return SIZES[size] * unit(rng.normal(size=(N_STATES, 6)))

    return make


def test_every_model_is_tested_here():
    assert set(SOILS) | PRESSURE_DEPENDENT == set(Model) == set(dispatch.MODEL_OF.values())


@every_model
@every_size
def test_consistent_tangent_is_the_derivative_of_the_stress(model, size, rng, tangent_errors):
    """Over 10,000 random states; a quarter has two equal principal strains, which are edges."""
    trial = SIZES[size] * unit(rng.normal(size=(10_000, 6)))
    trial[::4] = principal_strains(rng, np.tile([0.0, np.pi / 3], 1250), SIZES[size])
    result = evaluate(model, trial)
    scale = np.abs(result.tangent).max()
    errors = tangent_errors(
        lambda moved, rows: evaluate(model, moved).stress,
        trial, result.tangent, scale, 1e-5 * SIZES[size],
    )  # fmt: skip
    assert errors.max() < 1e-6


def test_wrong_tangent_is_told_from_a_kink(rng, tangent_errors):
    """A part in a hundred thousand too stiff, it is wrong at every state and every step."""
    trial = SIZES["plastic"] * unit(rng.normal(size=(N_STATES, 6)))
    result = evaluate(Model.TRESCA, trial)
    scale = np.abs(result.tangent).max()
    errors = tangent_errors(
        lambda moved, rows: evaluate(Model.TRESCA, moved).stress,
        trial, result.tangent + 1e-5 * scale * np.eye(6), scale, 1e-6,
    )  # fmt: skip
    assert errors.min() > 5e-6


@every_model
@every_size
def test_stress_is_admissible_after_the_update(model, size, trial_strains):
    result = evaluate(model, trial_strains(size))
    scale = np.abs(result.stress).max()
    assert yield_function(model, result.stress, result.state).max() <= 1e-9 * scale


@every_model
@every_size
def test_elastic_strain_and_stress_belong_together(model, size, trial_strains):
    """Stress to strain and back changes nothing, and an admissible state stays where it is."""
    first = evaluate(model, trial_strains(size))
    strain = strain_from_stress(model, first.stress, first.state)
    scale = np.abs(strain).max()
    np.testing.assert_allclose(strain, first.elastic_strain, atol=1e-13 * scale)
    second = evaluate(model, strain, first.state)
    np.testing.assert_allclose(second.stress, first.stress, atol=1e-12 * np.abs(first.stress).max())


@every_model
def test_elastic_response_does_not_depend_on_the_path(model, trial_strains):
    target = trial_strains("elastic")
    detour = trial_strains("elastic")
    strain, state = np.zeros_like(target), None
    for increment in (detour, 0.5 * target, -detour, 0.5 * target):
        result = evaluate(model, strain + increment, state)
        strain, state = result.elastic_strain, result.state
    direct = evaluate(model, target)
    np.testing.assert_allclose(
        result.stress, direct.stress, atol=1e-12 * np.abs(direct.stress).max()
    )
    np.testing.assert_allclose(result.state, direct.state, rtol=1e-15)


@every_model
@every_size
def test_response_turns_with_the_strain(
    model, size, trial_strains, make_rotation, tensors_of, vectors_of
):
    trial, rotation = trial_strains(size), make_rotation()

    def turned(vectors):
        return vectors_of(rotation @ tensors_of(vectors) @ rotation.T)

    plain, rotated = evaluate(model, trial), evaluate(model, turned(trial))
    for name in ("stress", "elastic_strain"):
        expected = turned(getattr(plain, name))
        error = np.abs(getattr(rotated, name) - expected).max()
        assert error < 1e-13 * np.abs(expected).max()
    np.testing.assert_allclose(rotated.state, plain.state, rtol=1e-11)
    direction = trial_strains(size)
    expected = turned(np.einsum("nij,nj->ni", plain.tangent, direction))
    response = np.einsum("nij,nj->ni", rotated.tangent, turned(direction))
    assert np.abs(response - expected).max() < 1e-11 * np.abs(expected).max()


@every_model
@every_size
def test_no_energy_is_made(model, size, trial_strains):
    """Neither increments nor the whole of a closed strain cycle have negative plastic work."""
    corners = [trial_strains(size) for _ in range(4)]
    path = [np.zeros_like(corners[0]), *corners, np.zeros_like(corners[0])]
    strain, state = path[0], None
    stress = np.zeros_like(strain)
    work, round_off = np.zeros(N_STATES), 1e-11 * SIZES[size] ** 2 * 4e6
    for start, end in pairwise(path):
        for _ in range(20):
            increment = (end - start) / 20.0
            trial = strain + increment
            result = evaluate(model, trial, state)
            plastic_work = (result.stress * (trial - result.elastic_strain)).sum(axis=1)
            assert plastic_work.min() >= -round_off
            work += ((stress + result.stress) / 2.0 * increment).sum(axis=1)
            strain, state, stress = result.elastic_strain, result.state, result.stress
    # the trapezoidal rule is exact where the stress is linear in the strain, as in all laws but one
    quadrature = 1e-2 * SIZES[size] ** 3 * 4e6 if model == Model.NEO_HOOKEAN else 0.0
    assert work.min() >= -round_off - quadrature


def test_neo_hookean_stress_in_terms_of_the_left_cauchy_green_tensor(trial_strains, tensors_of):
    """The stress tau = G (b - 1) + lambda ln J 1 with b = exp(2 eps)."""
    soil, trial = SOILS[Model.NEO_HOOKEAN], trial_strains("large")
    shear = soil.youngs_modulus / (2.0 * (1.0 + soil.poissons_ratio))
    lame = 2.0 * shear * soil.poissons_ratio / (1.0 - 2.0 * soil.poissons_ratio)
    strain = tensors_of(trial)
    left_cauchy_green = np.array([expm(2.0 * tensor) for tensor in strain])
    trace = np.trace(strain, axis1=1, axis2=2)[:, None, None]
    expected = shear * (left_cauchy_green - np.eye(3)) + lame * trace * np.eye(3)
    stress = tensors_of(evaluate(Model.NEO_HOOKEAN, trial).stress)
    np.testing.assert_allclose(stress, expected, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("model", [Model.HENCKY_ELASTIC, *CLAYS])
def test_elastic_law_is_isotropic_hooke(model, trial_strains, tensors_of):
    soil, trial = SOILS[model], trial_strains("elastic")
    shear = soil.youngs_modulus / (2.0 * (1.0 + soil.poissons_ratio))
    lame = 2.0 * shear * soil.poissons_ratio / (1.0 - 2.0 * soil.poissons_ratio)
    strain = tensors_of(trial)
    trace = np.trace(strain, axis1=1, axis2=2)
    expected = lame * trace[:, None, None] * np.eye(3) + 2.0 * shear * strain
    stress = tensors_of(evaluate(model, trial).stress)
    np.testing.assert_allclose(stress, expected, atol=1e-13 * np.abs(expected).max())


@every_model
def test_state_variables_have_names_and_start_values(model):
    soil, depth = SOILS[model], np.array([0.0, 3.0])
    state = start_state(soil, depth)
    names = dispatch.state_variable_names(soil)
    assert state.shape == (2, len(names))
    assert set(names) <= set(STATE_VARIABLES)
    if model in CLAYS:
        np.testing.assert_allclose(state, [[20e3, 0.0], [26e3, 0.0]])


@every_model
def test_results_do_not_depend_on_the_number_of_threads(model, trial_strains, threads):
    trial = np.concatenate([trial_strains(size) for size in SIZES])
    results = []
    for n in (1, 2):
        threads(n)
        results.append(vars(evaluate(model, trial)))
    for name, value in results[0].items():
        np.testing.assert_array_equal(value, results[1][name])


def test_laws_are_told_apart_in_one_call(trial_strains):
    """Two soils in one table: every point gets the law of its row."""
    trial = trial_strains("plastic")
    material = np.arange(N_STATES) % 2
    soils = [SOILS[Model.VON_MISES], SOILS[Model.HENCKY_ELASTIC]]
    state = np.tile([20e3, 0.0], (N_STATES, 1))
    arrays = [np.empty((N_STATES, *shape)) for shape in ((6,), (6,), (2,), (6, 6))]
    dispatch.update_all(
        dispatch.pack(soils), material, trial, state, *arrays, np.empty(N_STATES, dtype=np.int64)
    )
    expected = [evaluate(model, trial).stress for model in (Model.VON_MISES, Model.HENCKY_ELASTIC)]
    np.testing.assert_array_equal(arrays[0], np.where(material[:, None] == 0, *expected))


def test_von_mises_returns_radially_to_its_strength(trial_strains):
    trial = trial_strains("plastic")
    result, elastic = evaluate(Model.VON_MISES, trial), evaluate(Model.HENCKY_ELASTIC, trial)
    norm = np.linalg.norm(deviator(elastic.stress), axis=1, keepdims=True)
    is_plastic = norm > np.sqrt(2.0) * 20e3
    assert is_plastic.mean() > 0.9
    shrink = np.where(is_plastic, np.sqrt(2.0) * 20e3 / norm, 1.0)
    expected = elastic.stress + (shrink - 1.0) * deviator(elastic.stress)
    np.testing.assert_allclose(result.stress, expected, rtol=1e-12, atol=1e-6)


@every_clay
def test_strength_in_simple_shear_is_the_undrained_one(model):
    trial = np.zeros((1, 6))
    trial[0, 3] = np.sqrt(2.0) * 0.1
    stress = evaluate(model, trial).stress[0]
    assert stress[3] / np.sqrt(2.0) == pytest.approx(20e3, rel=1e-12)


@every_clay
def test_plastic_shear_strain_is_accumulated(model):
    """In simple shear back and forth it adds up to the plastic engineering shear strain."""
    state, strain = None, np.zeros((1, 6))
    total = 0.0
    for shear in (0.03, -0.06, 0.06):
        trial = strain.copy()
        trial[0, 3] += np.sqrt(2.0) * shear / 2.0
        result = evaluate(model, trial, state)
        total += abs(trial[0, 3] - result.elastic_strain[0, 3]) * np.sqrt(2.0)
        strain, state = result.elastic_strain, result.state
    assert total > 0.08
    assert state[0, 1] == pytest.approx(total, rel=1e-12)
    assert state[0, 0] == 20e3


@every_clay
def test_clay_does_not_see_the_pressure(model, trial_strains):
    trial = trial_strains("plastic")
    pressed = trial - 0.3 * (np.arange(6) < 3)
    stresses = [deviator(evaluate(model, strain).stress) for strain in (trial, pressed)]
    np.testing.assert_allclose(stresses[0], stresses[1], atol=1e-6)


def principal_strains(rng, lode_angles, size=5e-2):
    """Deviatoric trial strains (n, 6) with Lode angles in (0, pi / 3) and random directions."""
    angle = np.asarray(lode_angles)[:, None] + 2.0 * np.pi / 3.0 * np.array([0.0, -1.0, 1.0])
    principal = size * np.sqrt(2.0 / 3.0) * np.cos(angle)
    turned = [np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in angle]
    tensors = np.array([q @ np.diag(e) @ q.T for q, e in zip(turned, principal, strict=True)])
    scale = np.array([1.0, 1.0, 1.0, *[np.sqrt(2.0)] * 3])
    return tensors[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]] * scale


@pytest.mark.parametrize("lode_angle", [0.0, 0.05, 0.5, np.pi / 3 - 0.05, np.pi / 3])
def test_tresca_returns_to_planes_and_edges(lode_angle, rng, tensors_of):
    """Where two principal strains are (nearly) equal the stress ends on an edge."""
    trial = principal_strains(rng, np.full(N_STATES, lode_angle))
    result = evaluate(Model.TRESCA, trial)
    assert np.abs(yield_function(Model.TRESCA, result.stress, result.state)).max() < 1e-7
    principal = np.sort(np.linalg.eigvalsh(tensors_of(deviator(result.stress))), axis=1)
    edge = {0: [-2.0, -2.0, 4.0], 2: [-4.0, 2.0, 2.0]}.get(round(lode_angle / (np.pi / 6)))
    if edge is None:
        assert np.ptp(principal[:, 1]) < 1e-6 * 20e3
        assert np.abs(principal[:, 1]).max() < 0.3 * 20e3
        return
    np.testing.assert_allclose(principal, np.tile(np.array(edge) * 20e3 / 3.0, (N_STATES, 1)))


@pytest.mark.parametrize("lode_angle", [0.0, np.pi / 3])
def test_tresca_tangent_at_equal_principal_strains(lode_angle, rng):
    """The edges have no corner of their own: equal strains are ordinary points of an edge."""
    trial = principal_strains(rng, np.full(N_STATES, lode_angle))
    result = evaluate(Model.TRESCA, trial)
    direction, step = rng.normal(size=(N_STATES, 6)), 1e-7
    forward, backward = (
        evaluate(Model.TRESCA, trial + sign * step * direction).stress for sign in (1.0, -1.0)
    )
    change = (forward - backward) / (2.0 * step)
    expected = np.einsum("nij,nj->ni", result.tangent, direction)
    assert np.abs(change - expected).max() < 1e-6 * np.abs(expected).max()


def test_tresca_return_is_the_closest_point(rng):
    """No admissible stress is nearer to the trial stress in the norm of elastic energy."""
    trial = principal_strains(rng, rng.uniform(0.0, np.pi / 3, N_STATES))
    result, elastic = evaluate(Model.TRESCA, trial), evaluate(Model.HENCKY_ELASTIC, trial)
    others = [evaluate(Model.TRESCA, principal_strains(rng, rng.uniform(0, 1, N_STATES)))]
    others += [evaluate(Model.TRESCA, trial + 0.02 * rng.normal(size=trial.shape))]
    plastic = trial - result.elastic_strain
    assert np.linalg.norm(plastic, axis=1).min() > 1e-2
    for other in others:
        work = (plastic * (result.stress - other.stress)).sum(axis=1)
        assert work.min() > -1e-12 * np.abs(elastic.stress).max()


def test_tresca_says_when_the_strain_is_not_finite():
    shapes = ((1, 6), (1, 6), (1, 2), (1, 6, 6))
    stress, elastic_strain, state, tangent = (np.empty(shape) for shape in shapes)
    trial, status = np.full((1, 6), np.nan), np.zeros(1, dtype=np.int64)
    soil = SOILS[Model.TRESCA]
    dispatch.update_all(
        dispatch.pack([soil]), np.zeros(1, dtype=np.int64), trial,
        start_state(soil, np.zeros(1)), stress, elastic_strain, state, tangent, status,
    )  # fmt: skip
    assert status[0] == tresca.NOT_FINITE
