"""Interfaces on surfaces that a rotation of the pile maps onto themselves: exact tangent."""

import numpy as np
import pytest

from install_mpm.constitutive import coulomb_interface
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.interface import (
    InterfaceElements,
    InterfacePoints,
    add_turning_of_traction,
    facet_rule,
    soil_displacement,
    step_axes,
)
from install_mpm.kernels.interface_force import evaluate_interface
from install_mpm.pile import PileMotion, rigid_displacement

ANGLE, RADIUS, STIFFNESS = 0.2, 0.7, 1e5
LAWS = {
    "sticks": CoulombInterface(STIFFNESS, STIFFNESS, 1e9),
    "slips": CoulombInterface(STIFFNESS, STIFFNESS, 50.0),
    "rubs": CoulombInterface(STIFFNESS, STIFFNESS, 50.0, friction_angle=0.4),
}
"""The third has contact pressure, on which its strength depends."""


def surface(dim, law, rng):
    """Two facets of random places about the axis, one point in three on a surface that turns."""
    n_facet_nodes, n_elements, n_points = (3, 2, 3) if dim == 2 else (6, 2, 3)
    shape_values, weights = facet_rule(n_facet_nodes, n_points)
    n = n_elements * n_points
    direction = rng.uniform(0.0, 2.0 * np.pi, n)
    position, normal = rng.normal(size=(n, dim)), rng.normal(size=(n, dim))
    position[:, 0], position[:, 1] = RADIUS * np.cos(direction), RADIUS * np.sin(direction)
    if dim == 2:
        normal = -position.copy()
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    is_swept = np.arange(n) % 3 > 0
    nodes = np.arange(n_elements * n_facet_nodes).reshape(n_elements, -1)
    elements = InterfaceElements(
        nodes, np.zeros(n_elements, dtype=np.int64), shape_values, weights, is_swept
    )
    traction = 20.0 * rng.normal(size=(n, dim))
    traction[:, -1] = -500.0 - 200.0 * rng.uniform(size=n)
    points = InterfacePoints(
        position, normal, rng.uniform(0.5, 2.0, n), traction,
        coulomb_interface.pack(law, np.zeros(n)), np.zeros(n, dtype=np.int64), np.ones(n),
    )  # fmt: skip
    return elements, points


def evaluate(elements, points, displacement):
    """Return force (n_elements, n_nodes, dim) and its stiffness, as a step puts them together."""
    dim = displacement.shape[1]
    down = np.zeros(dim)
    down[-1] = -1e-3 if dim == 3 else 0.0
    pile = rigid_displacement(PileMotion(down, ANGLE), points.position)
    soil = soil_displacement(elements, displacement)
    axes = step_axes(points, elements.is_swept, ANGLE, pile, soil)
    shape = (*elements.nodes.shape, dim)
    force, stiffness = np.empty(shape), np.empty((*shape, *shape[1:]))
    traction = np.empty_like(points.traction)
    evaluate_interface(
        elements.nodes, elements.shape_values, points.area, points.parameters, points.traction,
        axes, pile, displacement, force, stiffness, traction,
    )  # fmt: skip
    on_pile = -points.area[:, None] * np.einsum("pij,pi->pj", axes.traction, traction)
    add_turning_of_traction(stiffness, elements, on_pile, points.position + soil)
    return force, stiffness


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("share", [0.0, 0.6, 1.1])
def test_stiffness_is_the_derivative_of_the_force(dim, law, share, rng):
    elements, points = surface(dim, LAWS[law], rng)
    # soil that has gone a share of the way, and away from the exact surface
    sides = np.tile(np.array([0.03, 0.05, 0.001])[:dim], (elements.nodes.size, 1))
    displacement = share * sides + 1e-3 * rng.normal(size=sides.shape)
    change = rng.normal(size=displacement.shape)
    _, stiffness = evaluate(elements, points, displacement)
    size = 1e-7
    ends = [evaluate(elements, points, displacement + sign * size * change)[0] for sign in (1, -1)]
    derivative = (ends[0] - ends[1]) / (2.0 * size)
    computed = np.einsum("eaibj,ebj->eai", stiffness, change[elements.nodes])
    assert np.abs(derivative).max() > 0.0
    np.testing.assert_allclose(computed, derivative, atol=1e-6 * np.abs(derivative).max())
