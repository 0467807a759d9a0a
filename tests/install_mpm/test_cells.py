"""Reference cells in the plane, their integration rules, the points that seed them, and facets."""

from math import factorial

import numpy as np
import pytest

from install_mpm.cell_fill import cell_geometry
from install_mpm.cells import (
    CellType,
    reference_cell,
    reference_gradients,
    shape_functions,
    sub_region_points,
)
from install_mpm.conventions import Kinematics
from install_mpm.interface import facet_rule
from install_mpm.kernels.carry import nearest_integration_point

TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
NODES = {
    CellType.TRI3: TRIANGLE,
    CellType.TRI6: np.concatenate([TRIANGLE, (TRIANGLE + np.roll(TRIANGLE, -1, axis=0)) / 2.0]),
    CellType.QUAD4: SQUARE,
}
FIELDS = {"constant": lambda x, y: 0.0 * x + 3.0, "linear": lambda x, y: 1.0 - 2.0 * x + 3.0 * y}
EXTRA_FIELDS = {
    CellType.TRI6: lambda x, y: 2.0 * x * x - x * y + 0.5 * y * y,
    CellType.QUAD4: lambda x, y: x * y,
}
DEGREE = {CellType.TRI3: 1, CellType.TRI6: 2, CellType.QUAD4: 3}

every_cell = pytest.mark.parametrize("cell_type", list(NODES), ids=lambda cell: cell.name)
triangles = pytest.mark.parametrize("cell_type", [CellType.TRI3, CellType.TRI6])


def values_at(cell_type, xi):
    values = np.empty(len(NODES[cell_type]))
    shape_functions(int(cell_type), xi, values)
    return values


def gradients_at(cell_type, xi):
    gradients = np.empty((len(NODES[cell_type]), 2))
    reference_gradients(int(cell_type), xi, gradients)
    return gradients


@pytest.fixture
def places(rng):
    """Function that returns random places in a reference cell."""

    def make(cell_type, n=20):
        if cell_type == CellType.QUAD4:
            return rng.uniform(-1.0, 1.0, size=(n, 2))
        return rng.dirichlet([1.0, 1.0, 1.0], size=n)[:, 1:].copy()

    return make


@every_cell
def test_description_matches_the_shape_functions(cell_type):
    cell = reference_cell(cell_type)
    assert (cell.cell_type, cell.n_nodes, cell.dim) == (cell_type, len(NODES[cell_type]), 2)
    assert cell.n_vertices == (4 if cell_type == CellType.QUAD4 else 3)


@every_cell
def test_shape_functions_are_one_at_their_node(cell_type):
    values = np.array([values_at(cell_type, node) for node in NODES[cell_type]])
    np.testing.assert_allclose(values, np.eye(len(values)), atol=1e-15)


@every_cell
def test_partition_of_unity(cell_type, places):
    for xi in places(cell_type):
        assert values_at(cell_type, xi).sum() == pytest.approx(1.0, abs=1e-15)
        np.testing.assert_allclose(gradients_at(cell_type, xi).sum(axis=0), 0.0, atol=2e-15)


@every_cell
def test_polynomials_are_reproduced(cell_type, places):
    fields = list(FIELDS.values())
    if cell_type in EXTRA_FIELDS:
        fields.append(EXTRA_FIELDS[cell_type])
    for field in fields:
        nodal = field(*NODES[cell_type].T)
        for xi in places(cell_type):
            assert values_at(cell_type, xi) @ nodal == pytest.approx(field(*xi), abs=1e-14)


@every_cell
def test_gradients_are_the_derivatives(cell_type, places):
    step = 1e-6
    for xi in places(cell_type):
        gradients = gradients_at(cell_type, xi)
        for i, direction in enumerate(np.eye(2)):
            forward = values_at(cell_type, xi + step * direction)
            backward = values_at(cell_type, xi - step * direction)
            np.testing.assert_allclose(
                gradients[:, i], (forward - backward) / (2.0 * step), atol=1e-9
            )


def mean_of_monomial(cell_type, a, b):
    """Mean of x^a y^b over the reference cell."""
    if cell_type == CellType.QUAD4:
        return np.prod([0.0 if n % 2 else 1.0 / (n + 1.0) for n in (a, b)])
    return 2.0 * factorial(a) * factorial(b) / factorial(a + b + 2)


@every_cell
def test_integration_rule_is_exact(cell_type):
    cell = reference_cell(cell_type)
    x, y = cell.integration_coordinates.T
    degree = DEGREE[cell_type]
    for a in range(degree + 1):
        for b in range(degree + 1 - (0 if cell_type == CellType.QUAD4 else a)):
            expected = mean_of_monomial(cell_type, a, b)
            mean = cell.reference_volumes @ (x**a * y**b) / cell.reference_volumes.sum()
            assert mean == pytest.approx(expected, abs=1e-15)


@every_cell
@pytest.mark.parametrize("per_direction", [1, 2, 3, 4])
def test_seeds_fill_the_cell_exactly(cell_type, per_direction):
    cell = reference_cell(cell_type)
    coordinates, shares = sub_region_points(cell, per_direction)
    assert len(shares) == cell.n_vertices * per_direction**2
    assert shares.sum() == pytest.approx(1.0, abs=1e-15)
    by_region = shares.reshape(cell.n_vertices, -1).sum(axis=1)
    np.testing.assert_allclose(by_region, 1.0 / cell.n_vertices, rtol=1e-14)
    np.testing.assert_allclose(
        shares @ coordinates, NODES[cell_type][: cell.n_vertices].mean(axis=0), atol=1e-15
    )


@every_cell
def test_seeds_integrate_quadratic_fields(cell_type):
    coordinates, shares = sub_region_points(reference_cell(cell_type), 2)
    x, y = coordinates.T
    for a, b in ((2, 0), (1, 1), (0, 2)):
        expected = mean_of_monomial(cell_type, a, b)
        assert shares @ (x**a * y**b) == pytest.approx(expected, abs=1e-15)


def test_seeds_lie_in_their_own_sub_region():
    cell = reference_cell(CellType.TRI6)
    coordinates, _ = sub_region_points(cell, 3)
    nearest = [nearest_integration_point(xi, cell.integration_coordinates) for xi in coordinates]
    np.testing.assert_array_equal(nearest, np.repeat([0, 1, 2], 9))


def test_sub_region_of_a_triangle_is_that_of_the_largest_barycentric_coordinate(places):
    cell = reference_cell(CellType.TRI6)
    for xi in places(CellType.TRI6, 200):
        barycentric = [1.0 - xi.sum(), *xi]
        nearest = nearest_integration_point(xi, cell.integration_coordinates)
        assert nearest == np.argmax(barycentric)


@triangles
def test_cells_of_a_mesh_have_exact_volumes_and_gradients(cell_type, make_grid, places):
    """On a distorted mesh, against the shoelace formula and the inverse of the affine map."""
    cell = reference_cell(cell_type)
    mesh = make_grid(3, 4, width=2.0, depth=3.0, n_nodes=cell.n_nodes, distortion=0.3)
    geometry = cell_geometry(mesh, cell, Kinematics.PLANE_STRAIN)
    assert geometry.volume.sum() == pytest.approx(6.0, rel=1e-14)
    for c, vertices in enumerate(mesh.nodes[mesh.cell_nodes[:, :3]]):
        (x0, y0), (x1, y1), (x2, y2) = vertices
        area = ((x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)) / 2.0
        assert geometry.volume[c] == pytest.approx(area, rel=1e-13)
        affine = np.column_stack([vertices[1] - vertices[0], vertices[2] - vertices[0]])
        for q, xi in enumerate(cell.integration_coordinates):
            expected = gradients_at(cell_type, xi) @ np.linalg.inv(affine)
            np.testing.assert_allclose(
                geometry.shape_gradients[c, q], expected, atol=1e-12 / np.sqrt(area)
            )
            height = vertices[0, 1] + (affine @ xi)[1]
            assert geometry.integration_height[c, q] == pytest.approx(height, abs=1e-14)


@pytest.mark.parametrize("n_nodes", [2, 3])
@pytest.mark.parametrize("n_points", [1, 2, 3])
def test_facet_rule(n_nodes, n_points):
    """Partition of unity, place of the points, and polynomials up to degree 2 n - 1."""
    values, weights = facet_rule(n_nodes, n_points)
    assert values.shape == (n_points, n_nodes)
    np.testing.assert_allclose(values.sum(axis=1), 1.0, atol=1e-15)
    assert weights.sum() == pytest.approx(1.0, abs=1e-15)
    places = values @ np.array([0.0, 1.0, 0.5])[:n_nodes]
    for degree in range(2 * n_points):
        assert weights @ places**degree == pytest.approx(1.0 / (degree + 1), abs=1e-15)


def test_quadratic_facet_interpolates_quadratic_fields():
    values, _ = facet_rule(3, 3)
    places = values @ [0.0, 1.0, 0.5]
    np.testing.assert_allclose(values @ [0.0, 1.0, 0.25], places**2, atol=1e-15)
