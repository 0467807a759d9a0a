"""Newton's method on problems with known solutions, its failures, and the order of convergence."""

import numpy as np
import pytest

from install_mpm.linear_solvers import SingularMatrixError
from install_mpm.newton import ROUND_OFF, Evaluation, convergence_order, solve_newton

TOLERANCE = 1e-10


def solve_dense(tangent, right_hand_side):
    matrix = tangent.reshape(len(right_hand_side), -1)
    try:
        return np.linalg.solve(matrix, right_hand_side)
    except np.linalg.LinAlgError as error:
        raise SingularMatrixError("singular") from error


class Problem:
    """Residual and tangent given as functions; remembers where it was evaluated."""

    def __init__(self, residual, tangent, *, is_admissible=lambda x: True, reference=1.0):
        self.residual, self.tangent = residual, tangent
        self.is_admissible, self.reference = is_admissible, reference
        self.trials = []

    def __call__(self, x):
        self.trials.append(x.copy())
        admissible = bool(self.is_admissible(x))
        return Evaluation(
            np.atleast_1d(self.residual(x)), self.tangent(x).ravel(), self.reference, admissible
        )


def solve(problem, start, tolerance=TOLERANCE, max_iterations=20, largest=np.inf):
    return solve_newton(
        problem, solve_dense, np.atleast_1d(start).astype(float), tolerance, max_iterations, largest
    )


def square_root():
    return Problem(lambda x: x**2 - 2.0, lambda x: 2.0 * x)


def circle_and_line():
    def residual(x):
        return np.array([x[0] ** 2 + x[1] ** 2 - 4.0, x[0] - x[1]])

    return Problem(residual, lambda x: np.array([[2.0 * x[0], 2.0 * x[1]], [1.0, -1.0]]))


def arctangent():
    """Newton diverges from |x| > 1.39 unless the step is shortened."""
    return Problem(np.arctan, lambda x: 1.0 / (1.0 + x**2))


def test_resultants_have_to_balance_as_well():
    """The iteration goes on until they do, and ends without convergence if they never do."""
    problem = square_root()
    offsets = iter([1.0] * 6 + [0.0] * 20)

    def evaluate(x):
        return problem(x)._replace(mismatch=next(offsets))

    result = solve(evaluate, 2.0)
    assert result.is_converged
    assert result.mismatch == 0.0
    assert len(problem.trials) > 6
    assert not solve(lambda x: problem(x)._replace(mismatch=1e-9), 2.0).is_converged


def test_scalar_problem_converges_quadratically():
    result = solve(square_root(), 2.0, tolerance=1e-11)
    assert result.is_converged
    assert result.solution[0] == pytest.approx(np.sqrt(2.0), rel=1e-11)
    assert convergence_order(result.residuals) == pytest.approx(2.0, abs=0.1)


def test_vector_problem_converges_quadratically():
    result = solve(circle_and_line(), [3.0, 0.5])
    assert result.is_converged
    np.testing.assert_allclose(result.solution, np.sqrt(2.0), rtol=1e-9)
    assert convergence_order(result.residuals) > 1.8


def test_linear_problem_takes_one_correction():
    matrix = np.array([[4.0, 1.0], [2.0, 3.0]])
    problem = Problem(lambda x: matrix @ x - [1.0, 2.0], lambda x: matrix)
    result = solve(problem, [0.0, 0.0])
    assert result.is_converged
    assert len(result.residuals) == 2
    np.testing.assert_allclose(result.solution, np.linalg.solve(matrix, [1.0, 2.0]))


def test_step_is_halved_while_the_residual_grows():
    problem = arctangent()
    result = solve(problem, 3.0)
    assert result.is_converged
    assert abs(result.solution[0]) < 1e-9
    assert (np.diff(result.residuals) <= 0.0).all()
    full_step = problem.trials[1][0] - 3.0
    assert problem.trials[2][0] - 3.0 == pytest.approx(full_step / 2.0)


def test_step_is_halved_while_the_trial_is_inadmissible():
    problem = Problem(np.log, lambda x: 1.0 / x, is_admissible=lambda x: x[0] > 0.0)
    problem.residual = lambda x: np.log(np.maximum(x, 1e-300))
    result = solve(problem, 5.0)  # the first full step leads to 5 (1 - ln 5) < 0
    assert (np.array(problem.trials) <= 0.0).any()
    assert result.is_converged
    assert result.solution[0] == pytest.approx(1.0)


def held_and_loose():
    """A curved spring beside a dof that next to nothing holds until it has gone a way of 1."""

    def residual(x):
        return np.array([np.arctan(x[0] - 1.0), 1e-6 * x[1] + max(x[1] - 1.0, 0.0) ** 3 - 1e-2])

    def tangent(x):
        return np.diag([1.0 / (1.0 + (x[0] - 1.0) ** 2), 1e-6 + 3.0 * max(x[1] - 1.0, 0.0) ** 2])

    return Problem(residual, tangent)


def test_loose_dof_does_not_take_the_correction_of_the_others_away():
    """Its own would be 10 000; halved for its sake the other one gets next to nothing."""
    limited, free = held_and_loose(), held_and_loose()
    largest = np.array([np.inf, 0.3])
    result = solve(limited, [0.5, 0.0], largest=largest)
    assert result.is_converged
    np.testing.assert_allclose(result.solution, [1.0, 1.0 + 0.01 ** (1 / 3)], rtol=1e-4)
    assert limited.trials[1][0] - 0.5 == pytest.approx(1.25 * np.arctan(0.5))
    assert limited.trials[1][1] == pytest.approx(0.3)
    assert len(solve(free, [0.5, 0.0]).residuals) > 2 * len(result.residuals)


def test_limit_that_is_not_reached_changes_nothing():
    free, limited = (
        solve(circle_and_line(), [3.0, 0.5]),
        solve(circle_and_line(), [3.0, 0.5], largest=9.0),
    )
    np.testing.assert_array_equal(limited.residuals, free.residuals)


def test_inadmissible_start_fails_without_a_correction():
    problem = Problem(lambda x: x, lambda x: np.ones(1), is_admissible=lambda x: False)
    result = solve(problem, 1.0)
    assert not result.is_converged
    assert len(problem.trials) == 1
    assert result.residuals[0] == np.inf


def test_inadmissible_trials_fail():
    problem = Problem(lambda x: x, lambda x: np.ones(1), is_admissible=lambda x: x[0] == 1.0)
    assert not solve(problem, 1.0).is_converged


def test_singular_tangent_fails():
    result = solve(Problem(lambda x: x + 1.0, lambda x: np.zeros(1)), 1.0)
    assert not result.is_converged
    np.testing.assert_allclose(result.residuals, [2.0])


def test_singular_tangent_fails_although_the_start_is_within_the_tolerance():
    """Without a correction nothing shows that the start is a solution."""
    problem = Problem(lambda x: x, lambda x: np.zeros(1))
    assert not solve(problem, TOLERANCE / 2.0).is_converged


def test_iterations_are_limited():
    result = solve(square_root(), 1e6, max_iterations=3)
    assert not result.is_converged
    assert len(result.residuals) == 4


def test_residual_without_root_fails():
    """x^2 + 1 has none: the best trials are taken, and the iteration ends."""
    result = solve(Problem(lambda x: x**2 + 1.0, lambda x: 2.0 * x + 1e-3), 0.7)
    assert not result.is_converged
    assert np.isfinite(result.solution).all()


def test_iteration_that_only_gets_worse_can_end_it():
    """x^2 + 1 with a tangent of the wrong sign: every trial is worse than the start."""
    problem = Problem(lambda x: x**2 + 1.0, lambda x: -2.0 * x)
    impatient = solve_newton(problem, solve_dense, np.array([0.7]), TOLERANCE, 20, gives_up=True)
    assert not impatient.is_converged
    assert len(impatient.residuals) == 2
    assert len(solve(problem, 0.7).residuals) == 21


def test_iteration_that_may_end_is_halved_before_it_does():
    problem = arctangent()
    result = solve_newton(problem, solve_dense, np.array([2.0]), TOLERANCE, 20, gives_up=True)
    assert result.is_converged
    full, halved = problem.trials[1], problem.trials[2]
    assert abs(full) > 2.0 > abs(halved)
    np.testing.assert_allclose(halved - 2.0, 0.5 * (full - 2.0))


def slow():
    """A tangent ten times too stiff: the residual falls by a tenth in each iteration."""
    return Problem(lambda x: x, lambda x: np.full(1, 10.0))


def test_residual_that_does_not_halve_in_time_ends_the_iteration():
    """0.9^6 = 0.53 and 0.9^7 = 0.48: six iterations are too few for it, seven are enough."""
    start = np.array([1.0])
    result = solve_newton(slow(), solve_dense, start, 1e-3, 100, patience=6)
    assert not result.is_converged
    np.testing.assert_allclose(result.residuals, 0.9 ** np.arange(7))
    assert solve_newton(slow(), solve_dense, start, 1e-3, 100, patience=7).is_converged


def test_last_iteration_may_converge():
    needed = len(solve(square_root(), 2.0).residuals) - 1
    assert solve(square_root(), 2.0, max_iterations=needed).is_converged
    assert not solve(square_root(), 2.0, max_iterations=needed - 1).is_converged


def test_start_within_tolerance_is_corrected_once():
    problem = square_root()
    start = np.sqrt(2.0) + 1e-12
    result = solve(problem, start, tolerance=1e-6)
    assert result.is_converged
    assert len(result.residuals) == 2
    assert result.residuals[1] < result.residuals[0]


def test_exact_start_is_not_corrected():
    problem = Problem(lambda x: x, lambda x: np.ones(1))
    result = solve(problem, 0.5 * ROUND_OFF)
    assert result.is_converged
    assert len(problem.trials) == 1


def test_residual_is_measured_against_the_reference():
    problem = square_root()
    problem.reference = 1e6
    result = solve(problem, 2.0, tolerance=1e-7)
    assert result.is_converged
    np.testing.assert_allclose(result.residuals[0], 2.0 / 1e6)
    assert abs(result.solution[0] ** 2 - 2.0) <= 1e-7 * 1e6


def test_state_of_the_last_evaluation_is_that_of_the_solution():
    """The caller keeps what the last evaluation left behind: it must belong to the solution.

    Here no trial improves on a start within the tolerance, and the best is not the last.
    """
    problem = Problem(lambda x: 1e-11 * (2.0 + np.abs(x - 1.0)), lambda x: -2e-11 * np.ones(1))
    problem.residual = lambda x: 1e-11 * (1.0 if x[0] == 0.0 else 2.0 + (x[0] - 0.25) ** 2)
    result = solve(problem, 0.0)
    assert result.is_converged
    np.testing.assert_array_equal(problem.trials[-1], result.solution)


@pytest.mark.parametrize("order", [1.0, 1.5, 2.0, 3.0])
def test_order_of_a_synthetic_history(order):
    residuals = [0.3]
    while residuals[-1] > 1e-9 and len(residuals) < 12:
        residuals.append(residuals[-1] ** order if order > 1.0 else 0.1 * residuals[-1])
    assert convergence_order(np.array(residuals)) == pytest.approx(order, rel=1e-6)


def test_order_needs_three_residuals():
    assert np.isnan(convergence_order(np.array([1.0, 1e-3])))
    assert np.isnan(convergence_order(np.array([1e-3])))


def test_order_uses_the_end_of_the_history():
    assert convergence_order(np.array([1.0, 0.9, 0.8, 1e-2, 1e-4, 1e-8])) == pytest.approx(2.0)


def test_order_of_a_residual_that_grew_is_zero():
    assert convergence_order(np.array([1e-2, 1e-1, 1.0])) == 0.0


def test_residual_cut_off_by_round_off_counts_only_in_favour():
    """1e-4, 1e-8 and 1e-13 instead of 1e-16: the last three show less than the order."""
    assert convergence_order(np.array([1e-1, 1e-2, 1e-4, 1e-8, 1e-13])) == pytest.approx(2.0)
    assert convergence_order(np.array([1e-3, 1e-6, 1e-12])) == pytest.approx(2.0)
    assert convergence_order(np.array([1e-3, 1e-6, 1e-9, 1e-12]), round_off=1e-8) >= 1.0
