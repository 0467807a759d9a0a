"""Scatter of the pressure of material points in the cells near a pile."""

import numpy as np
import pytest

from install_mpm.stress_quality import cells_near, pressure_scatter


@pytest.fixture(scope="module")
def column(make_column, clay_ground):
    return make_column(clay_ground)


def with_pressure(points, pressure):
    change = points.volume_ratio * pressure
    return points._replace(
        kirchhoff_stress=points.kirchhoff_stress - change[:, None, None] * np.eye(3)
    )


def test_undisturbed_ground_has_none(column, rng):
    points = column.scattered_points(rng)
    everywhere = np.ones(len(column.mesh.cell_nodes), dtype=bool)
    assert pressure_scatter(points, everywhere, column.gradient) < 1e-9 * 18e3
    by_cell = with_pressure(points, 1e3 * points.cell)  # constant in each
    assert pressure_scatter(by_cell, everywhere, column.gradient) < 1e-6


def test_it_is_the_deviation_from_the_mean_of_the_cell(column, rng):
    points = column.points()
    pressure = 700.0 * rng.normal(size=len(points.mass))
    points = with_pressure(points, pressure)
    cells = np.zeros(len(column.mesh.cell_nodes), dtype=bool)
    assert pressure_scatter(points, cells, column.gradient) == 0.0
    cells[[0, 3]] = True
    squares = volume = 0.0
    for c in (0, 3):
        own = points.cell == c
        mean = np.average(pressure[own], weights=points.volume[own])
        squares += points.volume[own] @ (pressure[own] - mean) ** 2
        volume += points.volume[own].sum()
    expected = pytest.approx(np.sqrt(squares / volume), rel=1e-6)
    assert pressure_scatter(points, cells, column.gradient) == expected


def test_cells_near_a_place(column):
    mesh = column.mesh
    middle = mesh.nodes[mesh.cell_nodes[:, :3]].mean(axis=1)
    place = np.array([[0.2, -0.5]])
    distance = np.linalg.norm(middle - place, axis=1)
    near = cells_near(mesh, place, 0.6)
    np.testing.assert_array_equal(near, distance < 0.6)
    assert 0 < near.sum() < len(near)
