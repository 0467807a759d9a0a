import numpy as np
import pytest

from service_fe.krylov import solve_gmres

N = 30


@pytest.fixture
def system():
    rng = np.random.default_rng(3)
    matrix = np.eye(N) + 0.1 * rng.normal(size=(N, N))
    return matrix, rng.normal(size=N)


def unchanged(vector):
    return vector


def test_residual_keeps_the_tolerance_and_no_iteration_too_many(system):
    """The residual after each count of iterations is the least in its Krylov space."""
    matrix, right = system
    found = solve_gmres(lambda x: matrix @ x, unchanged, right, 1e-6, N)
    assert found.is_reached
    assert np.linalg.norm(right - matrix @ found.solution) <= 1e-6 * (1 + 1e-6)
    powers = [right]
    for _ in range(found.iterations - 2):
        powers.append(matrix @ powers[-1])
    space = np.linalg.qr(np.array(powers).T)[0]
    image = matrix @ space
    best = right - image @ np.linalg.lstsq(image, right, rcond=None)[0]
    assert np.linalg.norm(best) > 1e-6


def test_exact_preconditioner_needs_one_iteration(system):
    matrix, right = system
    inverse = np.linalg.inv(matrix)
    found = solve_gmres(lambda x: matrix @ x, lambda x: inverse @ x, right, 1e-10, N)
    assert (found.iterations, found.is_reached) == (1, True)
    np.testing.assert_allclose(found.solution, inverse @ right, rtol=1e-10)


def test_unsymmetric_system_is_solved_to_round_off_in_its_own_dimension(system):
    matrix, right = system
    found = solve_gmres(lambda x: matrix @ x, unchanged, right, 1e-13, N)
    np.testing.assert_allclose(found.solution, np.linalg.solve(matrix, right), rtol=1e-10)


def test_too_few_iterations_are_told(system):
    matrix, right = system
    found = solve_gmres(lambda x: matrix @ x, unchanged, right, 1e-12, 3)
    assert (found.iterations, found.is_reached) == (3, False)
    assert np.linalg.norm(right - matrix @ found.solution) < np.linalg.norm(right)


def test_nothing_is_done_for_a_right_hand_side_below_the_tolerance(system):
    matrix, _ = system
    found = solve_gmres(lambda x: matrix @ x, unchanged, np.zeros(N), 0.0, 3)
    assert (found.iterations, found.is_reached) == (0, True)


def test_singular_matrix_ends_the_iteration():
    found = solve_gmres(lambda x: 0.0 * x, unchanged, np.ones(N), 1e-3, 5)
    assert (found.iterations, found.is_reached) == (1, False)
