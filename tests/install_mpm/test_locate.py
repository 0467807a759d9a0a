"""Finding the cell of a point: against trying all cells, around corners, and from outside."""

import numpy as np
import pytest

from install_mpm.background_mesh import FACETS_OPPOSITE
from install_mpm.kernels.locate import FOUND, PROJECTED, locate_points
from install_mpm.mesh_generation import generate_background_mesh


def locate(mesh, position, cell=None):
    """Cells, barycentric coordinates (n, 3), status, and positions after locating."""
    position = np.array(position, dtype=float)
    n = len(position)
    cell = np.zeros(n, dtype=np.int64) if cell is None else np.array(cell)
    coordinates, status = np.full((n, 2), np.nan), np.full(n, -1)
    locate_points(
        mesh.nodes, mesh.cell_nodes, mesh.cell_neighbours, np.array(FACETS_OPPOSITE[3]), position,
        cell, coordinates, status,
    )  # fmt: skip
    barycentric = np.column_stack([1.0 - coordinates.sum(axis=1), coordinates])
    return cell, barycentric, status, position


def holders(mesh, point):
    """All cells that hold a point, by solving for barycentric coordinates."""
    corners = mesh.nodes[mesh.cell_nodes[:, :3]]
    edges = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=2)
    share = np.linalg.solve(edges, (point - corners[:, 0])[..., None])[..., 0]
    smallest = np.minimum(share.min(axis=1), 1.0 - share.sum(axis=1))
    return np.flatnonzero(smallest > -1e-11)


def place_of(mesh, cell, barycentric):
    return np.einsum("pv,pvi->pi", barycentric, mesh.nodes[mesh.cell_nodes[cell, :3]])


def random_places(mesh, rng, n=300):
    cells = rng.integers(len(mesh.cell_nodes), size=n)
    return place_of(mesh, cells, rng.dirichlet([1.0, 1.0, 1.0], size=n))


@pytest.fixture
def mesh(make_grid):
    return make_grid(7, 6, width=2.0, depth=3.0, distortion=0.25)


@pytest.fixture(scope="module")
def pile_mesh(pile, box, mesh_options):
    """A region with a re-entrant corner at the pile tip."""
    return generate_background_mesh(pile, box, mesh_options)


def test_random_points_are_found_from_any_first_guess(mesh, rng):
    places = random_places(mesh, rng)
    guess = rng.integers(len(mesh.cell_nodes), size=len(places))
    cell, barycentric, status, position = locate(mesh, places, guess)
    np.testing.assert_array_equal(status, FOUND)
    np.testing.assert_array_equal(position, places)
    for c, place in zip(cell, places, strict=True):
        assert c in holders(mesh, place)
    np.testing.assert_allclose(place_of(mesh, cell, barycentric), places, atol=1e-14)
    assert barycentric.min() >= -1e-12


def test_points_on_vertices_and_edges_are_found(mesh):
    """Every node lies on vertices or edges, those of the boundary too."""
    cell, _, status, _ = locate(mesh, mesh.nodes)
    np.testing.assert_array_equal(status, FOUND)
    for c, place in zip(cell, mesh.nodes, strict=True):
        assert c in holders(mesh, place)


@pytest.mark.gmsh
def test_walks_around_a_re_entrant_corner(pile_mesh, pile, rng):
    """From below the pile to beside it and back: the straight way leads through the pile."""
    centre = pile_mesh.nodes[pile_mesh.cell_nodes[:, :3]].mean(axis=1)
    below = np.flatnonzero((centre[:, 0] < 0.3) & (centre[:, 1] > -pile.embedment - 0.5))
    beside = np.flatnonzero((centre[:, 0] < 1.0) & (centre[:, 1] > -1.0))
    assert len(below) > 1
    assert len(beside) > 5
    starts, ends = (array.ravel() for array in np.meshgrid(below, beside))
    for first, last in ((starts, ends), (ends, starts)):
        cell, _, status, _ = locate(pile_mesh, centre[last], first)
        np.testing.assert_array_equal(status, FOUND)
        np.testing.assert_array_equal(cell, last)


@pytest.mark.gmsh
def test_random_points_beside_the_pile_are_found(pile_mesh, rng):
    places = random_places(pile_mesh, rng)
    guess = rng.integers(len(pile_mesh.cell_nodes), size=len(places))
    cell, barycentric, status, _ = locate(pile_mesh, places, guess)
    np.testing.assert_array_equal(status, FOUND)
    np.testing.assert_allclose(place_of(pile_mesh, cell, barycentric), places, atol=1e-14)


def test_points_outside_are_put_just_inside_the_nearest_facet(mesh):
    outside = np.array([[-0.1, -1.5], [2.2, -0.4], [0.9, 0.05], [1.1, -3.3], [-0.3, 0.4]])
    nearest = np.clip(outside, [0.0, -3.0], [2.0, 0.0])
    cell, barycentric, status, position = locate(mesh, outside)
    np.testing.assert_array_equal(status, PROJECTED)
    assert barycentric.min() > 0.0
    np.testing.assert_allclose(place_of(mesh, cell, barycentric), position, atol=1e-14)
    size = np.sqrt(2.0 * 6.0 / len(mesh.cell_nodes))
    assert np.linalg.norm(position - nearest, axis=1).max() < 0.03 * size


@pytest.mark.gmsh
def test_points_in_the_pile_are_brought_back_to_its_surface(pile_mesh, pile):
    inside = np.array([[0.45, -1.0], [0.2, -1.95]])
    _, barycentric, status, position = locate(pile_mesh, inside)
    np.testing.assert_array_equal(status, PROJECTED)
    assert barycentric.min() > 0.0
    assert 0.0 < position[0, 0] - pile.half_width < 0.02
    assert position[0, 1] == pytest.approx(-1.0, abs=0.02)
    assert 0.0 < -pile.embedment - position[1, 1] < 0.02


def test_a_projected_point_is_found_again(mesh):
    _, _, _, position = locate(mesh, [[2.3, -1.0]])
    cell, _, status, again = locate(mesh, position)
    assert status[0] == FOUND
    assert cell[0] in holders(mesh, position[0])
    np.testing.assert_array_equal(again, position)
