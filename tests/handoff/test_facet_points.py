"""Points on the facets of a pile in space: they stand for means of the displacement."""

import numpy as np
import pytest

from handoff.facet_points import facet_points
from handoff.fe_mesh import FEMesh
from install_mpm.interface import facet_rule

TRIANGLE = np.array([[0.2, -0.1, 0.3], [1.4, 0.2, -0.2], [0.5, 1.1, 0.4]])


@pytest.fixture
def facets():
    """A facet of part 2, with its mid-sides 01, 12, 20, and one off the pile."""
    nodes = np.vstack([TRIANGLE, (TRIANGLE + np.roll(TRIANGLE, -1, axis=0)) / 2.0])
    order = np.arange(6)
    mesh = FEMesh(nodes, np.zeros((0, 10), dtype=np.int64), np.array([order, order[::-1]]),
                  np.array([2, -1]))  # fmt: skip
    return facet_points(mesh)


def test_points_are_those_of_the_installation(facets):
    values, weights = facet_rule(6, 3)
    np.testing.assert_allclose(facets.positions, values @ facets.coordinates, atol=1e-15)
    np.testing.assert_array_equal(facets.weights, weights)
    np.testing.assert_array_equal(facets.parts, [2, 2, 2])
    assert len(facets.selected(np.array([False])).positions) == 0


def test_means_are_those_weighted_by_the_linear_functions_of_the_points(facets):
    """Against a product rule of Gauss points on the triangle."""
    points, weights = np.polynomial.legendre.leggauss(6)
    s, t = (points[:, None] + 1.0) / 2.0, (points[None, :] + 1.0) / 2.0
    second, third = s * (1.0 - t), s * t
    measure = np.outer(weights, weights) / 4.0 * s * 2.0  # of a facet of unit size
    l = np.stack([1.0 - s + 0.0 * t, second, third])
    ends = l * (2.0 * l - 1.0)
    middles = 4.0 * l * np.roll(l, -1, axis=0)
    functions = np.concatenate([ends, middles])
    of_points = 2.0 * l - 1.0 / 3.0
    means = np.einsum("qij,aij,ij->qa", of_points, functions, measure)
    means /= np.einsum("qij,ij->q", of_points, measure)[:, None]
    near = np.argmax(facet_rule(6, 3)[0][:, :3], axis=1)
    np.testing.assert_allclose(facets.shape_values, means[near], atol=1e-14)
