"""Soil that hangs by a vertex: which cells are held around it, and that it cannot turn freely."""

import numpy as np
import pytest

from install_mpm.cell_fill import cell_geometry
from install_mpm.cells import CellType, reference_cell
from install_mpm.constitutive import dispatch
from install_mpm.constitutive.parameters import HenckyElastic
from install_mpm.conventions import Kinematics
from install_mpm.hanging_soil import cells_around_hanging_soil
from install_mpm.integration_points import IntegrationPoints, empty_trial
from install_mpm.kernels.cell_records import CellOptions
from install_mpm.kernels.equilibrium import evaluate_cells

SOIL = HenckyElastic(1e3, 0.3)


@pytest.fixture
def mesh(make_grid):
    """Return a grid of 2 by 2 squares of two triangles."""
    return make_grid(2, 2, width=2.0, depth=2.0)


def square(mesh, column, row):
    """Return the cells (n_cells,) bool of a square of the grid, counted from below."""
    centre = mesh.nodes[mesh.cell_nodes[:, :3]].mean(axis=1) - mesh.nodes.min(axis=0)
    return (np.floor(centre) == [column, row]).all(axis=1)


@pytest.fixture
def hanging(mesh):
    """Return the cells of the lower left square, and a triangle that hangs at its corner."""
    ground, above = square(mesh, 0, 0), np.flatnonzero(square(mesh, 1, 1))
    touches = np.isin(mesh.cell_nodes[above, :3], mesh.cell_nodes[ground, :3]).any(axis=1)
    lump = np.zeros_like(ground)
    lump[above[touches][0]] = True
    return ground, lump


def n_free_motions(mesh, takes_part):
    """Return the dimension of the null space of the soft stiffness of all cells that take part."""
    cell = reference_cell(CellType.TRI6)
    geometry = cell_geometry(mesh, cell, Kinematics.PLANE_STRAIN)
    n_cells, n_points = len(mesh.cell_nodes), 3 * len(mesh.cell_nodes)
    points = IntegrationPoints(
        cell_start=np.arange(n_cells + 1) * 3,
        reference_coordinates=np.tile(cell.integration_coordinates, (n_cells, 1)),
        shape_values=geometry.shape_values.reshape(n_points, 6),
        shape_gradients=geometry.shape_gradients.reshape(n_points, 6, 2),
        hoop_gradients=geometry.hoop_gradients.reshape(n_points, 6),
        volume=np.zeros(n_points),
        density=np.ones(n_points),
        volume_ratio=np.ones(n_points),
        elastic_log_strain=np.zeros((n_points, 3, 3)),
        state_variables=dispatch.initial_state(
            SOIL, np.zeros(n_points), np.zeros((n_points, 3, 3))
        ),
        material=np.zeros(n_points, dtype=np.int64),
    )
    force, stiffness = np.zeros((n_cells, 6, 2)), np.zeros((n_cells, 6, 2, 6, 2))
    options = CellOptions(True, True, False, True, np.zeros(n_cells), np.ones(n_cells))
    evaluate_cells(
        mesh.cell_nodes, takes_part, points, np.zeros_like(mesh.nodes), dispatch.pack([SOIL]),
        options, force, stiffness, empty_trial(points),
    )  # fmt: skip
    dofs = (2 * mesh.cell_nodes[:, :, None] + [0, 1]).reshape(n_cells, 12)
    matrix = np.zeros((2 * len(mesh.nodes), 2 * len(mesh.nodes)))
    for c in range(n_cells):
        matrix[np.ix_(dofs[c], dofs[c])] += stiffness[c].reshape(12, 12)
    used = np.unique(dofs[takes_part])
    return len(used) - np.linalg.matrix_rank(matrix[np.ix_(used, used)], tol=1e-9)


def test_ground_that_hangs_together_needs_nothing(mesh):
    assert not cells_around_hanging_soil(mesh, square(mesh, 0, 0) | square(mesh, 1, 0)).any()


def test_a_body_apart_from_all_others_is_left_alone(make_grid):
    mesh = make_grid(3, 1, width=3.0, depth=1.0)
    assert not cells_around_hanging_soil(mesh, square(mesh, 0, 0) | square(mesh, 2, 0)).any()


def test_empty_cells_around_a_hanging_body_are_found(mesh, hanging):
    ground, lump = hanging
    around = cells_around_hanging_soil(mesh, ground | lump)
    vertices = mesh.cell_nodes[:, :3]
    touches = np.isin(vertices, vertices[lump]).any(axis=1)
    np.testing.assert_array_equal(around, touches & ~lump & ~ground)
    assert around.any()


def test_a_hanging_body_can_turn_and_is_stopped_by_the_cells_around_it(mesh, hanging):
    active = hanging[0] | hanging[1]
    assert n_free_motions(mesh, active) == 4  # those of a rigid body, and the turning
    around = cells_around_hanging_soil(mesh, active)
    assert n_free_motions(mesh, active | around) == 3
