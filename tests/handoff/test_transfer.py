"""Moving least squares: reproduction (PF1), order, visibility, sparse and degenerate clouds."""

import numpy as np
import pytest

from handoff.line_of_sight import Obstacle, is_hidden_by_wall
from handoff.state_transfer import nearest_weights
from handoff.transfer import (
    least_squares_weights,
    transfer_least_squares,
    transfer_nearest,
    transferred,
)

PILE = Obstacle(0.5, -2.0)


def quadratic(x):
    return x[:, 0] ** 2 + x[:, 0] * x[:, 1] - 2.0 * x[:, 1] ** 2


@pytest.fixture(scope="module")
def weights(site, build):
    """Weights from random points to the integration points of another mesh."""
    points = build.points(site.mesh(0.09), site.ground)
    targets, _ = build.integration_points(site.mesh(0.11))
    return (
        points.position,
        targets,
        least_squares_weights(points.position, points.volume, targets, 32, PILE),
    )


@pytest.mark.gmsh
def test_constant_tensor_field_is_reproduced(weights):
    positions, _, table = weights
    stress = np.random.default_rng(1).normal(size=(3, 3))
    result = transferred(table, np.broadcast_to(stress, (len(positions), 3, 3)))
    assert np.abs(result - stress).max() < 1e-10 * np.abs(stress).max()


@pytest.mark.gmsh
def test_linear_tensor_field_is_reproduced_also_outside_the_cloud(weights):
    positions, targets, table = weights
    random = np.random.default_rng(2)
    constant, gradient = random.normal(size=(3, 3)), random.normal(size=(2, 3, 3))
    field = [constant + np.tensordot(x, gradient, 1) for x in (positions, targets)]
    assert np.abs(transferred(table, field[0]) - field[1]).max() < 1e-8 * np.abs(field[1]).max()


@pytest.mark.gmsh
def test_quadratic_field_converges_with_order_two(site, build):
    errors = []
    for size in [0.24, 0.12, 0.06]:
        points = build.points(site.mesh(size, coarsening=1.0), site.ground)
        targets, volumes = build.integration_points(site.mesh(1.2 * size, coarsening=1.0))
        result = transfer_least_squares(
            points.position, points.volume, quadratic(points.position), targets, 32, PILE
        )
        errors.append(np.sqrt(volumes @ (result - quadratic(targets)) ** 2))
    orders = np.log(np.divide(errors[:-1], errors[1:])) / np.log(2.0)
    assert orders.min() > 1.8


def test_points_on_a_line_keep_constants_and_bound_the_gradient():
    positions = np.column_stack([np.linspace(0.0, 1.0, 40), np.full(40, 3.0)])
    targets = np.array([[0.5, 3.0], [0.5, 3.2]])
    table = least_squares_weights(positions, np.ones(40), targets, 12)
    assert np.abs(transferred(table, np.ones(40)) - 1.0).max() < 1e-10
    assert np.abs(table.weights).sum(axis=1).max() < 3.0
    assert transferred(table, positions[:, 0])[0] == pytest.approx(0.5, abs=1e-12)


def test_volumes_weigh_the_mean():
    """In the middle between two clusters the larger volumes pull the value of a jump."""
    positions = np.random.default_rng(3).uniform(-1.0, 1.0, size=(400, 2))
    values = (positions[:, 0] > 0.0).astype(float)
    target = np.zeros((1, 2))
    light, heavy = (
        transfer_least_squares(positions, np.where(values > 0.0, heavier, 1.0), values, target, 100)
        for heavier in (1.0, 9.0)
    )
    assert abs(light[0] - 0.5) < 0.1
    assert heavy[0] != pytest.approx(light[0], abs=0.01)


@pytest.mark.parametrize(
    ("start", "end", "hidden"),
    [
        ((0.6, -1.9), (0.4, -2.1), False),  # past the corner, the line through the corner itself
        ((0.6, -1.7), (0.4, -2.1), True),  # beside the shaft to below the base
        ((0.6, -2.3), (0.3, -2.1), False),
        ((0.7, -1.0), (0.6, -1.9), False),
        ((0.1, -2.1), (3.0, -2.05), False),
        ((0.51, -1.0), (0.1, -2.01), True),
        ((0.6, -1.0), (0.495, -1.0), False),  # a point that has just touched the pile counts
        ((0.6, -1.0), (0.4, -1.0), True),  # one inside the pile does not
    ],
)
def test_pile_hides_points_behind_it(start, end, hidden):
    corner = np.array(PILE)
    assert bool(is_hidden_by_wall(np.array(start), np.array(end), corner)) is hidden
    assert bool(is_hidden_by_wall(np.array(end), np.array(start), corner)) is hidden


def test_hidden_points_never_contribute():
    """Beside the corner, targets on shaft and base are made of what they see."""
    random = np.random.default_rng(4)
    cloud = random.uniform((0.0, -2.5), (1.0, -1.5), size=(4000, 2))
    cloud = cloud[(cloud[:, 0] > 0.5) | (cloud[:, 1] < -2.0)]
    targets = np.array([[0.51, -1.8], [0.3, -2.01]])
    table = least_squares_weights(cloud, np.ones(len(cloud)), targets, 400, PILE)
    for target, neighbours, weights in zip(targets, table.neighbours, table.weights, strict=True):
        hidden = [is_hidden_by_wall(target, point, np.array(PILE)) for point in cloud[neighbours]]
        assert not np.any(np.array(hidden) & (weights != 0.0))
        assert np.count_nonzero(weights) > 100
    blind = least_squares_weights(cloud, np.ones(len(cloud)), targets, 400)
    assert any(
        is_hidden_by_wall(target, point, np.array(PILE))
        for target, row in zip(targets, blind.neighbours, strict=True)
        for point in cloud[row]
    )


def test_target_that_sees_no_point_is_marked_by_its_distance():
    positions = np.random.default_rng(5).uniform((0.6, -1.2), (0.7, -1.0), size=(20, 2))
    table = least_squares_weights(positions, np.ones(20), np.array([[0.1, -2.3]]), 8, PILE)
    assert np.isinf(table.distance[0])


def test_nearest_point_is_the_nearest_visible_one():
    positions = np.array([[0.55, -1.9], [0.1, -2.6]] + [[2.0 + i, -3.0] for i in range(12)])
    values = np.arange(len(positions), dtype=float)
    target = np.array([[0.3, -2.05]])
    assert transfer_nearest(positions, values, target)[0] == 0.0
    assert transfer_nearest(positions, values, target, PILE)[0] == 1.0
    weights = least_squares_weights(positions, np.ones(len(positions)), target, 12, PILE)
    assert transferred(nearest_weights(weights), values)[0] == 1.0


def test_too_few_points_are_named():
    with pytest.raises(ValueError, match=r"fewer than handoff\.neighbours"):
        least_squares_weights(np.zeros((5, 2)), np.ones(5), np.zeros((1, 2)), 8)


@pytest.mark.gmsh
def test_weights_do_not_depend_on_the_number_of_threads(site, build):
    import numba

    points = build.points(site.mesh(0.1), site.ground)
    targets, _ = build.integration_points(site.mesh(0.1))
    before, tables = numba.get_num_threads(), []
    try:
        for threads in {1, numba.config.NUMBA_NUM_THREADS}:
            numba.set_num_threads(threads)
            tables.append(least_squares_weights(points.position, points.volume, targets, 32, PILE))
    finally:
        numba.set_num_threads(before)
    for first, second in zip(tables[0], tables[-1], strict=True):
        assert np.array_equal(first, second)
