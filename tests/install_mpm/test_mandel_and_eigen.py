"""Six-vectors and the eigenvalue solver under every soil law."""

import numpy as np
import pytest

from install_mpm.constitutive import mandel
from install_mpm.constitutive.eigen import symmetric_eigen


@pytest.fixture
def symmetric(rng):
    tensor = rng.normal(size=(3, 3))
    return tensor + tensor.T


def vector_of(tensor):
    vector = np.empty(6)
    mandel.to_mandel(tensor, vector)
    return vector


def test_tensor_and_vector_are_the_same_thing(symmetric, vectors_of):
    vector, tensor = vector_of(symmetric), np.empty((3, 3))
    np.testing.assert_allclose(vector, vectors_of(symmetric[None])[0], rtol=1e-15)
    mandel.from_mandel(vector, tensor)
    np.testing.assert_allclose(tensor, symmetric, rtol=1e-15)


def test_dot_product_is_the_double_contraction(symmetric, rng):
    other = rng.normal(size=(3, 3))
    other = other + other.T
    expected = np.tensordot(symmetric, other)
    assert vector_of(symmetric) @ vector_of(other) == pytest.approx(expected, rel=1e-14)


def test_trace_and_norm(symmetric):
    vector = vector_of(symmetric)
    assert mandel.trace(vector) == pytest.approx(np.trace(symmetric), rel=1e-14)
    assert mandel.norm(vector) == pytest.approx(np.linalg.norm(symmetric), rel=1e-14)


def with_eigenvalues(*values):
    def make(rotation):
        return rotation @ np.diag(values) @ rotation.T

    return make


def with_off_diagonals(size):
    def make(rotation):
        return np.array([[1.0, size, -size], [size, 1.0, size], [-size, size, 2.0]])

    return make


TENSORS = {
    "general": with_eigenvalues(3.0, -1.0, 0.5),
    "two equal": with_eigenvalues(2.0, 2.0, -1.0),
    "nearly equal": with_eigenvalues(1.0, 1.0 + 1e-13, 1.0 - 1e-13),
    "three equal": with_eigenvalues(1.5, 1.5, 1.5),
    "indefinite and large": with_eigenvalues(1e12, -1e12, 1.0),
    "of rank one": with_eigenvalues(0.0, 0.0, 1.0),
    "zero": lambda rotation: np.zeros((3, 3)),
    "diagonal": lambda rotation: np.diag([3.0, 1.0, 2.0]),
    "zero diagonal": lambda rotation: np.ones((3, 3)) - np.eye(3),
    "plane strain": lambda rotation: np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.7]]),
    **{f"off-diagonals {size:.0e}": with_off_diagonals(size) for size in (1e-8, 1e-15, 1e-200)},
}


@pytest.mark.parametrize("case", TENSORS)
def test_eigenvalues_and_vectors(case, make_rotation):
    tensor = TENSORS[case](make_rotation())
    tensor = (tensor + tensor.T) / 2.0
    scale = np.abs(tensor).max() or 1.0
    values, vectors = np.empty(3), np.empty((3, 3))
    symmetric_eigen(tensor.copy(), values, vectors)
    expected = np.linalg.eigvalsh(tensor)
    np.testing.assert_allclose(np.sort(values), expected, rtol=0.0, atol=4e-15 * scale)
    np.testing.assert_allclose(vectors.T @ vectors, np.eye(3), atol=4e-15)
    np.testing.assert_allclose(vectors @ np.diag(values) @ vectors.T, tensor, atol=4e-15 * scale)


def test_eigenvalues_of_many_random_tensors(rng):
    for tensor in rng.normal(size=(500, 3, 3)) * 10.0 ** rng.uniform(-8, 8, size=(500, 1, 1)):
        tensor = tensor + tensor.T
        values, vectors = np.empty(3), np.empty((3, 3))
        symmetric_eigen(tensor.copy(), values, vectors)
        error = vectors @ np.diag(values) @ vectors.T - tensor
        assert np.abs(error).max() < 1e-14 * np.abs(tensor).max()
