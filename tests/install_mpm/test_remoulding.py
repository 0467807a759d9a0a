"""Undrained clay that loses strength as it is sheared: von Mises and Tresca."""

from types import SimpleNamespace

import numpy as np
import pytest

from install_mpm.constitutive import dispatch
from install_mpm.constitutive.parameters import Tresca, VonMises

N_STATES = 10_000
STRENGTH, SENSITIVITY, REMOULDING_STRAIN = 20e3, 4.0, 0.5
SHEAR_MODULUS = 4e6 / 2.6
every_law = pytest.mark.parametrize("law", [VonMises, Tresca])
every_size = pytest.mark.parametrize("size", [2e-2, 0.3])


def sensitive(law):
    return law(4e6, 0.3, STRENGTH, sensitivity=SENSITIVITY, remoulding_strain=REMOULDING_STRAIN)


def evaluate(soil, trial, state):
    n = len(trial)
    result = SimpleNamespace(
        stress=np.empty((n, 6)), elastic_strain=np.empty((n, 6)), state=np.empty((n, 2)),
        tangent=np.empty((n, 6, 6)), status=np.zeros(n, dtype=np.int64),
    )  # fmt: skip
    dispatch.update_all(
        dispatch.pack([soil]), np.zeros(n, dtype=np.int64), np.ascontiguousarray(trial), state,
        result.stress, result.elastic_strain, result.state, result.tangent, result.status,
    )  # fmt: skip
    assert not result.status.any()
    return result


def random_states(rng, size):
    """Trial strains (n, 6) of one norm, and clay that has been remoulded more or less."""
    strain = rng.normal(size=(N_STATES, 6))
    strain *= size / np.linalg.norm(strain, axis=1, keepdims=True)
    shear_strain = rng.uniform(0.0, 1.0, N_STATES)
    return strain, np.column_stack([np.full(N_STATES, STRENGTH), shear_strain])


def remoulded(shear_strain):
    lost = (1.0 - 1.0 / SENSITIVITY) * np.exp(-3.0 * shear_strain / REMOULDING_STRAIN)
    return STRENGTH * (1.0 / SENSITIVITY + lost)


@every_law
@every_size
def test_consistent_tangent_with_softening(law, size, rng, tangent_errors):
    soil = sensitive(law)
    trial, state = random_states(rng, size)
    result = evaluate(soil, trial, state)
    errors = tangent_errors(
        lambda moved, rows: evaluate(soil, moved, state[rows]).stress,
        trial, result.tangent, soil.youngs_modulus, 1e-6,
    )  # fmt: skip
    assert errors.max() < 1e-6
    assert (result.state[:, 1] > state[:, 1]).mean() > 0.9


@every_law
@every_size
def test_stress_lies_on_the_softened_surface(law, size, rng):
    soil = sensitive(law)
    trial, state = random_states(rng, size)
    result = evaluate(soil, trial, state)
    value = np.empty(N_STATES)
    dispatch.yield_function_all(
        dispatch.pack([soil]), np.zeros(N_STATES, dtype=np.int64), result.stress, result.state,
        value,
    )  # fmt: skip
    is_plastic = result.state[:, 1] > state[:, 1]
    assert np.abs(value[is_plastic]).max() <= 1e-9 * STRENGTH
    assert value.max() <= 1e-9 * STRENGTH
    np.testing.assert_array_equal(result.state[:, 0], STRENGTH)


@every_law
def test_simple_shear_follows_the_remoulding_law(law):
    """Back and forth: s_u falls with the accumulated plastic shear strain, to 1 / sensitivity."""
    soil, state, strain = sensitive(law), np.array([[STRENGTH, 0.0]]), np.zeros((1, 6))
    for increment in [0.01] * 50 + [-0.01] * 100:
        before = strain.copy()
        strain[0, 3] += increment / np.sqrt(2.0)
        trial = strain.copy()
        result = evaluate(soil, trial, state)
        plastic = abs(trial - result.elastic_strain)[0, 3] * np.sqrt(2.0)
        assert result.state[0, 1] - state[0, 1] == pytest.approx(plastic, abs=1e-15)
        assert (result.stress * (trial - result.elastic_strain)).sum() >= 0.0
        if plastic > 0.0:
            strength = abs(result.stress[0, 3]) / np.sqrt(2.0)
            assert strength == pytest.approx(remoulded(result.state[0, 1]), rel=1e-12)
        strain, state = result.elastic_strain, result.state
        assert np.abs(strain - before).max() < 0.1
    assert strength == pytest.approx(STRENGTH / SENSITIVITY, rel=1e-2)


@every_law
def test_clay_that_is_not_sensitive_keeps_its_strength(law, rng):
    trial, state = random_states(rng, 0.3)
    result = evaluate(law(4e6, 0.3, STRENGTH), trial, state)
    other = state.copy()
    other[:, 1] = 0.0
    np.testing.assert_array_equal(
        result.stress, evaluate(law(4e6, 0.3, STRENGTH), trial, other).stress
    )


@every_law
def test_softening_faster_than_elastic_unloading_is_told(law):
    """Snap-back has no solution in strain; the step is told to fail."""
    soil = law(4e6, 0.3, STRENGTH, sensitivity=10.0, remoulding_strain=1e-3)
    trial, status = np.zeros((1, 6)), np.zeros(1, dtype=np.int64)
    trial[0, 3] = np.sqrt(2.0) * 0.5 * (STRENGTH / SHEAR_MODULUS + 1e-5)
    dispatch.update_all(
        dispatch.pack([soil]), np.zeros(1, dtype=np.int64), trial, np.array([[STRENGTH, 0.0]]),
        np.empty((1, 6)), np.empty((1, 6)), np.empty((1, 2)), np.empty((1, 6, 6)), status,
    )  # fmt: skip
    assert status[0] != 0
