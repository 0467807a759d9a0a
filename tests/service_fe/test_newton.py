"""Newton's method with the energy line search on the function sqrt(1 + x^2)."""

from typing import NamedTuple

import numpy as np
import pytest

from service_fe.newton import LOOSEST, StepNotConvergedError, forcing_term, solve_newton


class Point(NamedTuple):
    """A trial of the minimisation of sqrt(1 + |x|^2), whose Newton steps overshoot for |x| > 1."""

    x: np.ndarray

    @property
    def out_of_balance(self):
        return self.x / np.sqrt(1.0 + self.x @ self.x)

    @property
    def relative_residual(self):
        return float(np.linalg.norm(self.out_of_balance))


def direction(trial, forcing=0.0):
    return -trial.x * (1.0 + trial.x @ trial.x)


def along(trial, step, length):
    return Point(trial.x + length * step)


def solve(start, max_iterations=30, needs_first_iteration=False, evaluate=along):
    return solve_newton(
        Point(np.array(start)), direction, evaluate, needs_first_iteration, 1e-12, max_iterations
    )


@pytest.mark.parametrize("start", [[0.9], [5.0], [3.0, -4.0]])
def test_line_search_converges_where_full_steps_diverge(start):
    solution = solve(start)
    assert np.linalg.norm(solution.trial.x) < 1e-11
    assert solution.residuals[-1] <= 1e-12
    assert len(solution.residuals) < 12


def test_nothing_is_done_at_the_solution():
    assert solve([0.0]).residuals == (0.0,)


def test_prescribed_motion_asks_for_one_full_step():
    assert len(solve([0.0], needs_first_iteration=True).residuals) == 2


def test_failure_carries_the_residuals():
    with pytest.raises(StepNotConvergedError, match="no equilibrium after 2 iterations") as error:
        solve([5.0], max_iterations=2)
    assert len(error.value.residuals) == 3


def test_law_that_fails_stops_the_step():
    with pytest.raises(StepNotConvergedError, match="a soil law could not be evaluated"):
        solve([0.5], evaluate=lambda trial, step, length: Point(trial.x * np.nan))


@pytest.mark.parametrize("needs_first_iteration", [False, True])
def test_linear_systems_that_are_solved_as_asked_keep_the_quadratic_end(needs_first_iteration):
    """Each direction is as wrong as it may be; the iteration that lifts does not count."""
    asked = []

    def inexact(trial, forcing):
        asked.append(forcing)
        return (1.0 - forcing) * direction(trial)

    start = Point(np.array([0.5]))
    solution = solve_newton(start, inexact, along, needs_first_iteration, 1e-14, 30)
    n_lifting = int(needs_first_iteration)
    assert asked[: n_lifting + 1] == [LOOSEST] * (n_lifting + 1)
    assert asked[-1] < 1e-6
    before, after, end = np.log(solution.residuals[-4:-1])
    assert (end - after) / (after - before) > 1.7
    assert len(solution.residuals) <= 7 + n_lifting


def test_progress_that_is_slow_asks_for_nothing_exact():
    assert forcing_term((1.0, 0.5)) == forcing_term((1.0, 2.0)) == LOOSEST
    assert forcing_term((1.0, 1e-3)) == pytest.approx(0.9e-6)
