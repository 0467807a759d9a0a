"""Finite strain: trial strain and spatial tangent against matrix functions and differences."""

import numpy as np
import pytest
from scipy.linalg import expm, logm

from install_mpm.constitutive import dispatch, hencky
from install_mpm.constitutive.parameters import HenckyElastic, VonMises

LAWS = {"elastic": HenckyElastic(1e3, 0.3), "plastic": VonMises(1e3, 0.3, 5.0)}


def trial_strain(increment, strain):
    """Trial strain as a tensor, squared stretches and their directions."""
    trial, stretches, directions = np.empty(6), np.empty(3), np.empty((3, 3))
    hencky.trial_log_strain(increment, strain, trial, stretches, directions)
    return trial, stretches, directions


def kirchhoff_stress(soil, increment, strain):
    """Kirchhoff stress (6,), consistent tangent and eigenpairs of the trial."""
    trial, stretches, directions = trial_strain(increment, strain)
    materials = dispatch.pack([soil])
    state = dispatch.initial_state(soil, np.zeros(1), np.zeros((1, 3, 3)))
    shape = [(1, 6), (1, 6), state.shape, (1, 6, 6)]
    stress, elastic_strain, new_state, tangent = (np.empty(extent) for extent in shape)
    status, material = np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64)
    dispatch.update_all(
        materials, material, trial[None], state, stress, elastic_strain, new_state, tangent, status
    )
    return stress[0], tangent[0], stretches, directions


def symmetric(rng, size):
    tensor = rng.normal(size=(3, 3))
    return size * (tensor + tensor.T) / 2.0


@pytest.fixture
def increments(rng, make_rotation):
    """Deformation gradients of one step, from tiny to a large rotation with large stretches."""
    stretched = np.diag([1.6, 0.8, 1.1])
    return {
        "tiny": np.eye(3) + 1e-9 * rng.normal(size=(3, 3)),
        "moderate": np.eye(3) + 0.1 * rng.normal(size=(3, 3)),
        "large": make_rotation() @ stretched @ make_rotation(),
        "rotation": make_rotation(),
        "equal stretches": 1.2 * np.eye(3),
        "two equal stretches": make_rotation() @ np.diag([1.3, 0.9, 0.9]),
        "plane": np.array([[1.1, 0.4, 0.0], [-0.2, 0.9, 0.0], [0.0, 0.0, 1.0]]),
    }


CASES = ["tiny", "moderate", "large", "rotation", "equal stretches", "two equal stretches", "plane"]


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("size", [0.0, 1e-3, 0.3])
def test_trial_strain_is_half_the_logarithm_of_the_pushed_tensor(
    case, size, increments, rng, vectors_of
):
    increment, strain = increments[case], symmetric(rng, size)
    expected = 0.5 * logm(increment @ expm(2.0 * strain) @ increment.T).real
    trial, stretches, directions = trial_strain(increment, strain)
    np.testing.assert_allclose(trial, vectors_of(expected[None])[0], atol=2e-14)
    recovered = directions @ np.diag(stretches) @ directions.T
    np.testing.assert_allclose(recovered, expm(2.0 * expected), atol=1e-13)


def test_rotation_turns_the_strain_without_changing_it(rng, make_rotation, vectors_of):
    rotation, strain = make_rotation(), symmetric(rng, 0.2)
    trial, _, _ = trial_strain(rotation, strain)
    expected = rotation @ strain @ rotation.T
    np.testing.assert_allclose(trial, vectors_of(expected[None])[0], atol=1e-15)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("dim", [2, 3])
def test_spatial_tangent_is_the_derivative_of_the_stress(
    law, case, dim, increments, rng, tensors_of
):
    increment = increments[case]
    strain = np.zeros((3, 3)) if "equal" in case else symmetric(rng, 0.05)
    _, tangent, stretches, directions = kirchhoff_stress(LAWS[law], increment, strain)
    spatial = np.zeros((3, 3, 3, 3))
    hencky.spatial_tangent(tangent, stretches, directions, dim, spatial)
    step, scale = 1e-5, np.abs(spatial).max()
    for k, m in np.ndindex(dim, dim):
        rate = np.zeros((3, 3))
        rate[k, m] = 1.0
        ends = [
            kirchhoff_stress(LAWS[law], (np.eye(3) + sign * step * rate) @ increment, strain)[0]
            for sign in (1.0, -1.0)
        ]
        derivative = tensors_of([(ends[0] - ends[1]) / (2.0 * step)])[0]
        np.testing.assert_allclose(spatial[:, :, k, m], derivative, atol=1e-6 * scale)


@pytest.mark.parametrize("distance", [0.0, 1e-12, 0.99e-8, 1.01e-8, 1e-7, 1e-5])
def test_tangent_is_smooth_where_stretches_meet(distance, tensors_of):
    """The limit of the divided difference takes over at a relative distance of 1e-8."""
    increment = np.diag([1.1, 1.1 * (1.0 + distance / 2.0), 0.8])
    tangents = []
    for gradient in (increment, np.diag([1.1, 1.1, 0.8])):
        _, tangent, stretches, directions = kirchhoff_stress(
            LAWS["elastic"], gradient, np.zeros((3, 3))
        )
        spatial = np.zeros((3, 3, 3, 3))
        hencky.spatial_tangent(tangent, stretches, directions, 3, spatial)
        tangents.append(spatial)
    scale = np.abs(tangents[1]).max()
    assert np.abs(tangents[0] - tangents[1]).max() < (1e-8 + distance) * scale


def test_small_strain_is_the_limit_of_the_logarithmic_one(rng):
    """The difference is of second order in the displacement gradient."""
    direction = rng.normal(size=(3, 3))
    errors = []
    for size in (1e-2, 1e-3):
        gradient, small = size * direction, np.empty(6)
        hencky.small_trial_strain(gradient, np.zeros((3, 3)), small)
        trial, _, _ = trial_strain(np.eye(3) + gradient, np.zeros((3, 3)))
        errors.append(np.abs(trial - small).max())
    assert np.log10(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


def test_small_trial_strain_adds_the_symmetric_gradient(rng, vectors_of):
    gradient, strain, small = rng.normal(size=(3, 3)), symmetric(rng, 1.0), np.empty(6)
    hencky.small_trial_strain(gradient, strain, small)
    expected = vectors_of((strain + (gradient + gradient.T) / 2.0)[None])[0]
    np.testing.assert_allclose(small, expected, atol=1e-15)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("dim", [2, 3])
def test_small_tangent_is_that_of_the_law_and_the_limit_of_the_spatial_one(
    law, dim, rng, tensors_of, vectors_of
):
    gradient = rng.normal(size=(3, 3))
    gradient[dim:] = gradient[:, dim:] = 0.0
    no_strain = np.zeros((3, 3))
    _, tangent, stretches, directions = kirchhoff_stress(LAWS[law], np.eye(3), no_strain)
    small, spatial = np.zeros((3, 3, 3, 3)), np.zeros((3, 3, 3, 3))
    hencky.small_tangent(tangent, dim, small)
    hencky.spatial_tangent(tangent, stretches, directions, dim, spatial)
    expected = tensors_of([tangent @ vectors_of([(gradient + gradient.T) / 2.0])[0]])[0]
    np.testing.assert_allclose(np.tensordot(small, gradient), expected, rtol=1e-13, atol=1e-9)
    np.testing.assert_allclose(spatial, small, atol=1e-12 * np.abs(small).max())


def test_determinant(rng):
    tensor = rng.normal(size=(3, 3))
    assert hencky.determinant(tensor) == pytest.approx(np.linalg.det(tensor), rel=1e-13)
