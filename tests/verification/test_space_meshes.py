"""Structured meshes of tetrahedra, and interface elements on their surfaces."""

import numpy as np
import pytest

from install_mpm.background_mesh import facets_opposite_vertices
from install_mpm.screw_surface import place_points
from workflows.verification.solid_meshes import (
    box_mesh,
    extruded,
    grid,
    linear_mesh,
    quadratic_mesh,
    ring,
    ring_mesh,
)
from workflows.verification.solid_surfaces import inward, surface_elements

LINES = np.array([0.0, 0.3, 1.0])


def volumes(mesh):
    corners = mesh.nodes[mesh.cell_nodes[:, :4]]
    return np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6.0


def boundary_area(mesh):
    cell, facet = np.nonzero(mesh.cell_neighbours < 0)
    corners = mesh.nodes[facets_opposite_vertices(mesh.cell_nodes[:, :4])[cell, facet]]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.linalg.norm(across, axis=1).sum() / 2.0


def polygon(sides):
    """Area and perimeter of a regular polygon in the unit circle."""
    return sides / 2.0 * np.sin(2.0 * np.pi / sides), 2.0 * sides * np.sin(np.pi / sides)


def test_a_box_is_filled_without_gaps():
    mesh = box_mesh(LINES, LINES, 2.0 * LINES)
    assert len(mesh.cell_nodes) == 6 * 8
    assert (volumes(mesh) > 0.0).all()
    assert volumes(mesh).sum() == pytest.approx(2.0)
    assert boundary_area(mesh) == pytest.approx(10.0)


def test_a_linear_mesh_has_the_vertices_alone():
    solid = extruded(grid(LINES, LINES), LINES)
    mesh = linear_mesh(solid)
    assert mesh.cell_nodes.shape == (6 * 8, 4)
    assert len(mesh.nodes) == 27
    assert (volumes(mesh) > 0.0).all()
    assert volumes(mesh).sum() == pytest.approx(1.0)


@pytest.mark.parametrize("inner", [0.0, 0.5])
def test_a_ring_closes_on_itself(inner):
    mesh = ring_mesh(np.array([inner, 0.75, 1.0]), 8, np.array([0.0, 0.2, 0.5]))
    area, perimeter = polygon(8)
    assert (volumes(mesh) > 0.0).all()
    assert volumes(mesh).sum() == pytest.approx(0.5 * (1.0 - inner**2) * area)
    assert boundary_area(mesh) == pytest.approx(
        2.0 * (1.0 - inner**2) * area + 0.5 * (1.0 + inner) * perimeter
    )


def test_a_part_of_a_solid_has_no_idle_nodes():
    solid = extruded(ring(np.array([0.0, 0.5, 1.0]), 6), LINES)
    mesh = quadratic_mesh(solid, solid.centroids[:, 2] > 0.3)
    assert set(mesh.cell_nodes.ravel()) == set(range(len(mesh.nodes)))
    assert volumes(mesh).sum() == pytest.approx(0.7 * polygon(6)[0])


def test_elements_cover_the_surface_that_is_asked_for():
    mesh = ring_mesh(np.array([0.5, 1.0]), 12, LINES)
    elements = surface_elements(mesh, np.hypot(*mesh.nodes[:, :2].T) < 0.5 + 1e-9)
    position, area, facet_normal = place_points(elements, mesh)
    assert area.sum() == pytest.approx(0.5 * polygon(12)[1])
    assert (np.einsum("pi,pi->p", inward(position), facet_normal) > np.cos(np.pi / 12)).all()
    assert elements.is_swept.all()
