"""The mesh: neighbours, quality, generation by gmsh, and the law by which it follows the pile."""

from collections import Counter

import numpy as np
import pytest

from install_mpm.background_mesh import (
    cell_quality,
    facets_opposite_vertices,
    make_background_mesh,
    size_at_nodes,
    smallest_altitude,
)
from install_mpm.mesh_generation import generate_background_mesh
from install_mpm.mesh_motion import translate
from install_mpm.options import BackgroundMeshOptions


@pytest.fixture(scope="module")
def mesh(pile, box, mesh_options):
    return generate_background_mesh(pile, box, mesh_options)


def areas(mesh, nodes=None):
    corners = (mesh.nodes if nodes is None else nodes)[mesh.cell_nodes[:, :3]]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]) / 2.0


def are_mid_sides_straight(mesh):
    for local in range(3):
        ends = mesh.nodes[mesh.cell_nodes[:, [local, (local + 1) % 3]]]
        if np.abs(mesh.nodes[mesh.cell_nodes[:, 3 + local]] - ends.mean(axis=1)).max() > 1e-15:
            return False
    return True


def boundary_edges(mesh):
    """Sorted vertex pairs of the edges that belong to one cell only."""
    ends = np.sort(facets_opposite_vertices(mesh.cell_nodes[:, :3]).reshape(-1, 2), axis=1)
    count = Counter(map(tuple, ends.tolist()))
    return {edge for edge, n in count.items() if n == 1}


@pytest.mark.parametrize("n_nodes", [3, 6])
def test_neighbours_share_the_facet_opposite_the_vertex(make_grid, n_nodes):
    mesh = make_grid(4, 3, n_nodes=n_nodes)
    facets = facets_opposite_vertices(mesh.cell_nodes[:, :3])
    n_outside = 0
    for c, v in np.ndindex(mesh.cell_neighbours.shape):
        assert mesh.cell_nodes[c, v] not in facets[c, v]
        holders = [
            other
            for other, cell in enumerate(mesh.cell_nodes[:, :3])
            if other != c and set(facets[c, v]) <= set(cell)
        ]
        assert holders == [n for n in [mesh.cell_neighbours[c, v]] if n >= 0]
        n_outside += not holders
    assert n_outside == 2 * (4 + 3)


def test_mid_sides_are_put_in_the_middle():
    nodes = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0], [9.0, 9.0], [8.0, 8.0], [7.0, 7.0]])
    mesh = make_background_mesh(nodes, np.arange(6)[None])
    np.testing.assert_array_equal(mesh.nodes[3:], [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def test_quality_and_altitude_of_known_triangles():
    height = np.sqrt(3.0)
    nodes = np.array([[0.0, 0.0], [2.0, 0.0], [1.0, height], [1.0, 1e-6], [4.0, 0.0], [0.0, 3.0]])
    cells = np.array([[0, 1, 2], [0, 1, 3], [0, 2, 1], [0, 4, 5]])
    quality = cell_quality(make_background_mesh(nodes, cells))
    # 2 r_in / r_out of the 3-4-5 triangle is 2 * 1 / 2.5
    np.testing.assert_allclose(quality, [1.0, 0.0, -1.0, 0.8], atol=1e-5)
    for n_cells, altitude in ((1, height), (2, 1e-6)):
        mesh = make_background_mesh(nodes, cells[:n_cells])
        assert smallest_altitude(mesh) == pytest.approx(altitude)
    assert smallest_altitude(make_background_mesh(nodes, cells[3:])) == pytest.approx(2.4)


@pytest.mark.gmsh
def test_mesh_covers_ground_and_headroom_but_not_the_pile(mesh, pile, box):
    area = areas(mesh)
    assert (area > 0.0).all()
    total = box.width * (box.depth + box.headroom)
    cut_out = pile.half_width * (pile.embedment + box.headroom)
    assert area.sum() == pytest.approx(total - cut_out, rel=1e-12)
    centre = mesh.nodes[mesh.cell_nodes[:, :3]].mean(axis=1)
    assert not ((centre[:, 0] < pile.half_width) & (centre[:, 1] > -pile.embedment)).any()
    is_soil = centre[:, 1] < 0.0
    expected = box.width * box.depth - pile.half_width * pile.embedment
    assert area[is_soil].sum() == pytest.approx(expected, rel=1e-12)


@pytest.mark.gmsh
def test_mesh_conforms_to_the_surface_and_to_the_pile(mesh, pile, box):
    z = mesh.nodes[mesh.cell_nodes[:, :3], 1]
    assert not ((z < -1e-9).any(axis=1) & (z > 1e-9).any(axis=1)).any()
    ends = np.array([mesh.nodes[list(edge)] for edge in boundary_edges(mesh)])
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)

    def length_on(axis, value, low, high):
        is_on = (np.abs(ends[:, :, axis] - value) < 1e-12).all(axis=1)
        along = ends[:, :, 1 - axis]
        return length[
            is_on & (along > low - 1e-9).all(axis=1) & (along < high + 1e-9).all(axis=1)
        ].sum()

    assert length_on(0, pile.half_width, -pile.embedment, box.headroom) == pytest.approx(2.6)
    assert length_on(1, -pile.embedment, 0.0, pile.half_width) == pytest.approx(0.5)
    assert length_on(0, 0.0, -box.depth, -pile.embedment) == pytest.approx(3.0)
    assert length_on(0, box.width, -box.depth, box.headroom) == pytest.approx(5.6)
    assert length.sum() == pytest.approx(2.0 * (box.width + box.depth + box.headroom))


@pytest.mark.gmsh
def test_mesh_is_the_same_every_time(mesh, pile, box, mesh_options):
    again = generate_background_mesh(pile, box, mesh_options)
    for first, second in zip(mesh, again, strict=True):
        assert first.dtype == second.dtype
        np.testing.assert_array_equal(first, second)


@pytest.mark.gmsh
def test_cells_are_small_at_the_pile_and_large_far_away(mesh, pile, box, mesh_options):
    size = np.sqrt(areas(mesh) * 4.0 / np.sqrt(3.0))
    centre = mesh.nodes[mesh.cell_nodes[:, :3]].mean(axis=1)
    tip = np.linalg.norm(centre - [pile.half_width, -pile.embedment], axis=1)
    near, far = tip < 0.3, (centre[:, 0] > 3.0) & (centre[:, 1] < -3.5)
    assert np.median(size[near]) == pytest.approx(mesh_options.size_at_pile, rel=0.25)
    assert np.median(size[far]) > 2.0 * mesh_options.size_at_pile
    assert cell_quality(mesh).min() > 0.4
    finer = generate_background_mesh(pile, box, BackgroundMeshOptions(0.15, 1.0))
    assert len(finer.cell_nodes) > 1.5 * len(mesh.cell_nodes)


@pytest.mark.gmsh
def test_mesh_numbers_its_nodes_without_gaps(mesh):
    np.testing.assert_array_equal(np.unique(mesh.cell_nodes), np.arange(len(mesh.nodes)))
    assert (mesh.cell_nodes.dtype, mesh.cell_neighbours.dtype) == (np.int64, np.int64)
    assert are_mid_sides_straight(mesh)
    np.testing.assert_allclose(mesh.nodes, mesh.reference_nodes, atol=1e-11)


def equations_1_and_2(height, body, mesh_height, displacement):
    """Heights above the bottom after a step, as printed in the paper."""
    stretched = (body + displacement) / body * height
    compressed = mesh_height - (mesh_height - body - displacement) * (mesh_height - height) / (
        mesh_height - body
    )
    return np.where(height <= body, stretched, compressed)


@pytest.mark.parametrize("n_steps", [1, 5])
@pytest.mark.parametrize("advance", [0.7, -0.2])
def test_translation_is_that_of_the_paper(make_grid, n_steps, advance):
    """Equations (1) and (2), applied once or step by step with L_b <- L_b + u."""
    mesh = make_grid(2, 8, depth=4.0)
    bottom, level, top = -4.0, -1.5, 0.0
    height = mesh.nodes[:, 1] - bottom
    body, displacement = level - bottom, -advance / n_steps
    for _ in range(n_steps):
        height = equations_1_and_2(height, body, top - bottom, displacement)
        body += displacement
    moved = translate(mesh, advance, level, (bottom, top))
    np.testing.assert_allclose(moved.nodes[:, 1] - bottom, height, atol=1e-14)
    np.testing.assert_array_equal(moved.nodes[:, 0], mesh.nodes[:, 0])


@pytest.mark.gmsh
@pytest.mark.parametrize("rigid_zone", [0.0, 0.5])
def test_mesh_stays_on_the_pile(mesh, pile, box, rigid_zone):
    advance, level = 0.8, -pile.embedment
    moved = translate(mesh, advance, level, (-box.depth, box.headroom), rigid_zone)
    reference = mesh.reference_nodes[:, 1]
    vertices = np.unique(mesh.cell_nodes[:, :3])
    is_rigid = np.abs(reference - level) <= rigid_zone + 1e-12
    shift = (moved.nodes - mesh.nodes)[:, 1]
    rigid_vertices = np.intersect1d(vertices, np.flatnonzero(is_rigid))
    assert len(rigid_vertices) > 2
    np.testing.assert_allclose(shift[rigid_vertices], -advance, atol=1e-14)
    for fixed in (-box.depth, box.headroom):
        np.testing.assert_array_equal(shift[reference == fixed], 0.0)
    assert (shift <= 0.0).all()
    assert are_mid_sides_straight(moved)
    assert (areas(moved) > 0.0).all()
    assert areas(moved).sum() == pytest.approx(areas(mesh).sum() - advance * pile.half_width)


@pytest.mark.gmsh
def test_position_of_the_mesh_depends_on_the_advance_only(mesh, pile, box):
    """Not on the steps: a resumed run moves the same mesh."""
    levels = (-pile.embedment, (-box.depth, box.headroom), 0.3)
    there = translate(mesh, 0.5, *levels)
    again = translate(translate(mesh, 0.2, *levels), 0.5, *levels)
    np.testing.assert_array_equal(there.nodes, again.nodes)
    np.testing.assert_array_equal(there.reference_nodes, mesh.reference_nodes)
    np.testing.assert_allclose(translate(there, 0.0, *levels).nodes, mesh.nodes, atol=1e-15)


def test_size_at_nodes_is_that_of_the_smallest_cell(mesh):
    """The determinant of a triangle is twice its area."""
    size = np.sqrt(2.0 * areas(mesh))
    expected = [
        size[(mesh.cell_nodes == node).any(axis=1)].min() for node in range(len(mesh.nodes))
    ]
    np.testing.assert_allclose(size_at_nodes(mesh), expected, rtol=1e-12)
