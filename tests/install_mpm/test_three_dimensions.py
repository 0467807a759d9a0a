"""Cells in space: tangent against differences, patch tests, rigid motion, and plane strain."""

import numpy as np
import pytest

from install_mpm.background_mesh import (
    FACETS_OPPOSITE,
    cell_quality,
    facet_edge_nodes,
    facets_opposite_vertices,
    make_background_mesh,
    smallest_altitude,
)
from install_mpm.cell_fill import cell_geometry
from install_mpm.cells import (
    TET_EDGES,
    CellType,
    reference_cell,
    reference_gradients,
    shape_functions,
    sub_region_points,
)
from install_mpm.constitutive import dispatch
from install_mpm.constitutive.parameters import HenckyElastic, VonMises
from install_mpm.conventions import Kinematics, rotation_matrix
from install_mpm.integration_points import IntegrationPoints, empty_trial
from install_mpm.interface_axes import frames_around_axis
from install_mpm.kernels.carry import nearest_integration_point
from install_mpm.kernels.cell_records import CellOptions
from install_mpm.kernels.equilibrium import evaluate_cells
from install_mpm.kernels.locate import PROJECTED, locate_points

MODULUS = 1e3
SOILS = {"elastic": HenckyElastic(MODULUS, 0.3), "plastic": VonMises(MODULUS, 0.3, 2.0)}
KUHN = ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0))


def box_mesh(shape, size, distortion=0.0, seed=1):
    """Boxes cut into 6 tetrahedra each, with mid-side nodes; inner vertices moved at random."""
    counts = np.array(shape) + 1
    grid = np.stack(np.meshgrid(*[np.arange(n) for n in counts], indexing="ij"), -1).reshape(-1, 3)
    index = {tuple(g): i for i, g in enumerate(grid)}
    tets = []
    for corner in np.ndindex(*shape):
        for axes in KUHN:
            path = [np.array(corner)]
            for axis in axes:
                path.append(path[-1] + np.eye(3, dtype=int)[axis])
            tet = [index[tuple(p)] for p in path]
            edges = grid[tet[1:]] - grid[tet[0]]
            tets.append(tet if np.linalg.det(edges) > 0 else [tet[0], tet[2], tet[1], tet[3]])
    nodes = grid / np.array(shape) * np.array(size)
    rng = np.random.default_rng(seed)
    inner = ((grid > 0) & (grid < counts - 1)).all(axis=1)
    nodes[inner] += distortion * rng.uniform(-1, 1, (inner.sum(), 3)) * np.array(size) / shape
    return quadratic(nodes, np.array(tets))


def quadratic(nodes, tets):
    """The mesh with a node in the middle of every edge."""
    ends = np.sort(tets[:, TET_EDGES], axis=2).reshape(-1, 2)
    edges, inverse = np.unique(ends, axis=0, return_inverse=True)
    middle = nodes[edges].mean(axis=1)
    cells = np.hstack([tets, len(nodes) + inverse.reshape(-1, 6)])
    return make_background_mesh(np.vstack([nodes, middle]), cells)


def integration_points(mesh, rng, soil):
    """Integration points with a random start."""
    cell = reference_cell(CellType.TET10)
    geometry = cell_geometry(mesh, cell, Kinematics.THREE_D)
    n_cells, n = len(mesh.cell_nodes), 4 * len(mesh.cell_nodes)
    strain = rng.normal(size=(n, 3, 3)) * 0.01
    return IntegrationPoints(
        cell_start=np.arange(n_cells + 1) * 4,
        reference_coordinates=np.tile(cell.integration_coordinates, (n_cells, 1)),
        shape_values=geometry.shape_values.reshape(n, 10),
        shape_gradients=geometry.shape_gradients.reshape(n, 10, 3),
        hoop_gradients=geometry.hoop_gradients.reshape(n, 10),
        volume=geometry.integration_volume.ravel() * rng.uniform(0.5, 1.0, n),
        density=np.ones(n),
        volume_ratio=rng.uniform(0.9, 1.1, n),
        elastic_log_strain=(strain + strain.transpose(0, 2, 1)) / 2.0,
        state_variables=dispatch.initial_state(soil, np.zeros(n), np.zeros((n, 3, 3))),
        material=np.zeros(n, dtype=np.int64),
    )


def evaluate(mesh, points, soil, displacement, options):
    """Force and stiffness of all cells."""
    n_cells = len(mesh.cell_nodes)
    force, stiffness = np.zeros((n_cells, 10, 3)), np.zeros((n_cells, 10, 3, 10, 3))
    trial = empty_trial(points)
    evaluate_cells(
        mesh.cell_nodes, np.ones(n_cells, dtype=bool), points, displacement,
        dispatch.pack([soil]), options, force, stiffness, trial,
    )  # fmt: skip
    assert not trial.status.any()
    return force, stiffness


@pytest.mark.parametrize("soil", SOILS.values(), ids=SOILS)
@pytest.mark.parametrize("has_mean", [False, True], ids=["plain", "mean dilatation"])
def test_tangent_is_the_derivative_of_the_force(soil, has_mean, rng):
    mesh = box_mesh((2, 2, 1), (1.0, 1.2, 0.7), distortion=0.1)
    points = integration_points(mesh, rng, soil)
    n_cells = len(mesh.cell_nodes)
    options = CellOptions(
        True, has_mean, False, True, np.full(n_cells, 200.0 * has_mean), np.full(n_cells, 0.3)
    )
    turn = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])  # a large rotation
    displacement = mesh.nodes @ (turn - np.eye(3)).T + rng.normal(size=mesh.nodes.shape) * 0.01
    direction = rng.normal(size=mesh.nodes.shape)
    _, stiffness = evaluate(mesh, points, soil, displacement, options)
    change = 1e-6
    more, _ = evaluate(mesh, points, soil, displacement + change * direction, options)
    less, _ = evaluate(mesh, points, soil, displacement - change * direction, options)
    expected = (more - less) / (2.0 * change)
    found = np.einsum("caibj,cbj->cai", stiffness, direction[mesh.cell_nodes])
    assert np.abs(found - expected).max() < 1e-6 * np.abs(expected).max()


def test_rigid_motion_leaves_stress_and_force_as_they_are(rng):
    soil = SOILS["elastic"]
    mesh = box_mesh((1, 1, 1), (1.0, 1.0, 1.0))
    points = integration_points(mesh, rng, soil)
    n_cells = len(mesh.cell_nodes)
    options = CellOptions(True, True, False, True, np.full(n_cells, 200.0), np.zeros(n_cells))
    at_rest, _ = evaluate(mesh, points, soil, np.zeros_like(mesh.nodes), options)
    axis = np.array([1.0, 2.0, 2.0]) / 3.0
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    turn = np.eye(3) + np.sin(2.0) * cross + (1.0 - np.cos(2.0)) * cross @ cross
    moved, _ = evaluate(mesh, points, soil, mesh.nodes @ (turn - np.eye(3)).T + 3.0, options)
    np.testing.assert_allclose(moved, at_rest @ turn.T, atol=1e-11 * np.abs(at_rest).max())


def test_mesh_of_tetrahedra_knows_its_neighbours_and_facets():
    mesh = box_mesh((2, 3, 2), (1.0, 2.0, 3.0), distortion=0.2)
    boundary = np.argwhere(mesh.cell_neighbours < 0)
    facets = facets_opposite_vertices(mesh.cell_nodes[:, :4])[boundary[:, 0], boundary[:, 1]]
    corners = mesh.nodes[facets]
    outward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2.0
    assert np.linalg.norm(outward, axis=1).sum() == pytest.approx(22.0)
    volume = (corners.mean(axis=1) * outward).sum() / 3.0  # divergence theorem: outward normals
    assert volume == pytest.approx(6.0)
    middles = (corners + np.roll(corners, -1, axis=1)) / 2.0
    np.testing.assert_allclose(mesh.nodes[facet_edge_nodes(mesh, *boundary.T)], middles)


def shapes_at(xi):
    values, gradients = np.empty(10), np.empty((10, 3))
    shape_functions(int(CellType.TET10), xi, values)
    reference_gradients(int(CellType.TET10), xi, gradients)
    return values, gradients


def test_shape_functions_are_one_at_their_node():
    vertices = np.vstack([np.zeros(3), np.eye(3)])
    nodes = np.vstack([vertices, vertices[list(TET_EDGES)].mean(axis=1)])
    np.testing.assert_allclose([shapes_at(node)[0] for node in nodes], np.eye(10), atol=1e-15)


def test_quadratic_fields_and_their_gradients_are_reproduced(rng):
    vertices = np.vstack([np.zeros(3), np.eye(3)])
    nodes = np.vstack([vertices, vertices[list(TET_EDGES)].mean(axis=1)])
    curvature, slope = rng.normal(size=(3, 3)), rng.normal(size=3)
    nodal = np.einsum("ni,ij,nj->n", nodes, curvature, nodes) + nodes @ slope + 2.0
    for xi in rng.dirichlet(np.ones(4), size=20)[:, 1:]:
        values, gradients = shapes_at(xi)
        assert values @ nodal == pytest.approx(xi @ curvature @ xi + slope @ xi + 2.0)
        np.testing.assert_allclose(
            nodal @ gradients, (curvature + curvature.T) @ xi + slope, atol=1e-12
        )


def test_linear_fields_and_their_gradients_are_reproduced_by_four_nodes(rng):
    cell = reference_cell(CellType.TET4)
    nodes = np.vstack([np.zeros(3), np.eye(3)])
    slope = rng.normal(size=3)
    values, gradients = np.empty(4), np.empty((4, 3))
    for xi in rng.dirichlet(np.ones(4), size=20)[:, 1:]:
        shape_functions(cell.cell_type, xi, values)
        reference_gradients(cell.cell_type, xi, gradients)
        assert values @ (nodes @ slope + 2.0) == pytest.approx(xi @ slope + 2.0)
        np.testing.assert_allclose((nodes @ slope + 2.0) @ gradients, slope, atol=1e-14)
    np.testing.assert_allclose(cell.integration_coordinates, [[0.25, 0.25, 0.25]])
    assert cell.reference_volumes.sum() == pytest.approx(1 / 6)
    assert len(make_background_mesh(nodes, np.array([[0, 1, 2, 3]])).nodes) == 4


@pytest.mark.parametrize("per_direction", [1, 2])
def test_seeds_fill_the_sub_regions(per_direction):
    cell = reference_cell(CellType.TET10)
    coordinates, shares = sub_region_points(cell, per_direction)
    assert shares.sum() == pytest.approx(1.0)
    np.testing.assert_allclose(shares @ coordinates, 0.25)
    near = [nearest_integration_point(xi, cell.integration_coordinates) for xi in coordinates]
    assert near == sorted(near)
    assert np.bincount(near).tolist() == [per_direction**3] * 4


def test_integration_rule_is_exact_for_quadratic_fields():
    cell = reference_cell(CellType.TET10)
    xi, weights = cell.integration_coordinates, cell.reference_volumes
    assert weights.sum() == pytest.approx(1 / 6)
    np.testing.assert_allclose(weights @ xi, 1 / 24)
    second = np.einsum("q,qi,qj->ij", weights, xi, xi)
    np.testing.assert_allclose(second, (np.ones((3, 3)) + np.eye(3)) / 120)


def test_axes_of_interface_points_turn_with_the_pile(rng):
    normals = rng.normal(size=(50, 3))
    normals[:10] = (0.0, 0.0, 1.0)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    places, turn = rng.normal(size=(50, 3)), rotation_matrix(0.7, 3)
    axes = frames_around_axis(normals, places, 0.0)
    np.testing.assert_allclose(
        axes @ axes.transpose(0, 2, 1), np.tile(np.eye(3), (50, 1, 1)), atol=1e-14
    )
    np.testing.assert_allclose(axes[:, 2], normals)
    np.testing.assert_allclose(np.linalg.det(axes), 1.0)
    turned = frames_around_axis(normals @ turn.T, places @ turn.T, 0.0)
    np.testing.assert_allclose(turned, axes @ turn.T, atol=1e-14)
    np.testing.assert_allclose(frames_around_axis(normals, places, 0.7), turned, atol=1e-14)


def test_quality_is_one_for_a_regular_tetrahedron():
    vertices = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    mesh = quadratic(vertices, np.array([[0, 2, 1, 3]]))
    sign = np.sign(np.linalg.det(vertices[[2, 1, 3]] - vertices[0]))
    assert cell_quality(mesh)[0] == pytest.approx(sign)
    assert abs(smallest_altitude(mesh)) == pytest.approx(4.0 / np.sqrt(3.0))


def test_points_in_space_are_located(rng):
    mesh = box_mesh((3, 2, 2), (1.0, 1.0, 1.0), distortion=0.2)
    position = rng.random((500, 3))
    position[0] = (1.3, 0.4, 0.6)
    cell, status = np.zeros(500, dtype=np.int64), np.full(500, -1)
    coordinates = np.full((500, 3), np.nan)
    wanted = position.copy()
    locate_points(
        mesh.nodes, mesh.cell_nodes, mesh.cell_neighbours, np.array(FACETS_OPPOSITE[4]), position,
        cell, coordinates, status,
    )  # fmt: skip
    assert (status == PROJECTED).nonzero()[0].tolist() == [0]
    np.testing.assert_array_equal(position[1:], wanted[1:])
    assert np.linalg.norm(position[0] - (1.0, 0.4, 0.6)) < 0.02
    share = np.column_stack([1.0 - coordinates.sum(axis=1), coordinates])
    assert share.min() > -1e-11
    found = np.einsum("pv,pvi->pi", share, mesh.nodes[mesh.cell_nodes[cell, :4]])
    np.testing.assert_allclose(found, position, atol=1e-14)
