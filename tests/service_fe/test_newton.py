"""Newton's method with the energy line search on the function sqrt(1 + x^2)."""

from typing import NamedTuple

import numpy as np
import pytest

from service_fe.newton import StepNotConvergedError, solve_newton


class Point(NamedTuple):
    """A trial of the minimisation of sqrt(1 + |x|^2), whose Newton steps overshoot for |x| > 1."""

    x: np.ndarray

    @property
    def out_of_balance(self):
        return self.x / np.sqrt(1.0 + self.x @ self.x)

    @property
    def relative_residual(self):
        return float(np.linalg.norm(self.out_of_balance))


def direction(trial):
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
