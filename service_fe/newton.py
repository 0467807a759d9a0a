"""Newton's method with a line search on the energy, for one load step of an elastoplastic model.

For an associated law the equilibrium of a step is the minimum of a convex function, whose slope
along the search direction d is d . r(x + alpha d): the line search looks for its zero.  That makes
the method converge from far away, where the residual's norm need not fall.  For a non-associated
law it is a heuristic.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, NamedTuple, Protocol, TypeVar

import numpy as np

SLOPE_KEPT = 0.8
"""A full step is taken if the slope at its end is at most this share of the slope at its start."""
SLOPE_WANTED = 0.3
"""The line search ends at this share."""
MAX_LINE_SEARCH = 8
SMALLEST_STEP = 1e-3

LOOSEST = 1e-3
"""Largest residual that a linear system may keep, over its right-hand side."""
FORCING = 0.1
"""Residual that it may keep, over the square of the relative right-hand side."""
TIGHTEST = 0.02
"""Residual of a linear system, over the tolerance of the step, below which there is no use."""


def linear_tolerance(size: float, reference: float, tolerance: float) -> float:
    """Return the residual in N to which the linear system of an iteration is solved.

    ``size`` is the norm of its right-hand side, ``reference`` the force by which Newton's method
    measures its residuals, both in N; ``tolerance`` is what these have to come to.  A residual in
    proportion to the square of the size keeps the convergence quadratic (Eisenstat and Walker
    1996).
    """
    if reference <= 0.0:
        return tolerance * size
    return max(size * min(FORCING * size / reference, LOOSEST), TIGHTEST * tolerance * reference)


class StepNotConvergedError(RuntimeError):
    """A load step was not solved; ``residuals`` holds the relative residual of each iteration."""

    def __init__(self, reason: str, residuals: tuple[float, ...]) -> None:
        history = " ".join(f"{residual:.1e}" for residual in residuals)
        super().__init__(f"{reason}; relative residuals: {history or 'none'}")
        self.residuals = residuals


class Trial(Protocol):
    """A point of the iteration: the model evaluated at trial unknowns."""

    @property
    def out_of_balance(self) -> np.ndarray:
        """Out-of-balance force of all unknowns; zero at prescribed ones."""

    @property
    def relative_residual(self) -> float:
        """Out-of-balance force over the reference force; not finite if the model failed."""


TrialT = TypeVar("TrialT", bound=Trial)


class Solution(NamedTuple, Generic[TrialT]):
    """An accepted trial and the way to it."""

    trial: TrialT
    residuals: tuple[float, ...]
    """Relative residual before each iteration and at the end."""


def solve_newton(
    start: TrialT,
    search_direction: Callable[[TrialT], np.ndarray],
    evaluate: Callable[[TrialT, np.ndarray, float], TrialT],
    needs_first_iteration: bool,
    tolerance: float,
    max_iterations: int,
    agree: Callable[[float], float] = float,
) -> Solution[TrialT]:
    """Return the converged trial.

    Parameters
    ----------
    start
        Trial at the first guess.
    search_direction
        Newton correction of all unknowns at a trial.
    evaluate
        Trial at (trial, direction, step length).
    needs_first_iteration
        True if the start does not satisfy the prescribed motions yet: one full step is taken first.
    tolerance, max_iterations
        Relative residual to reach, and the most iterations.
    agree
        Makes a slope the same on all ranks of MPI, as the relative residuals of trials are.

    Raises
    ------
    StepNotConvergedError
        If the tolerance is not reached.
    """
    trial = start
    residuals = [trial.relative_residual]
    for iteration in range(max_iterations):
        is_lifting = needs_first_iteration and iteration == 0
        if residuals[-1] <= tolerance and not is_lifting:
            return Solution(trial, tuple(residuals))
        direction = search_direction(trial)
        full = evaluate(trial, direction, 1.0)
        trial = full if is_lifting else _line_search(trial, full, direction, evaluate, agree)
        residuals.append(trial.relative_residual)
        if not np.isfinite(residuals[-1]):
            raise StepNotConvergedError("a soil law could not be evaluated", tuple(residuals))
    if residuals[-1] <= tolerance:
        return Solution(trial, tuple(residuals))
    raise StepNotConvergedError(
        f"no equilibrium after {max_iterations} iterations", tuple(residuals)
    )


def _line_search(
    trial: TrialT,
    full: TrialT,
    direction: np.ndarray,
    evaluate: Callable[[TrialT, np.ndarray, float], TrialT],
    agree: Callable[[float], float],
) -> TrialT:
    """Return the trial at the zero of the slope from ``trial`` to ``full`` (Illinois method)."""
    slope_start, slope_full = (
        agree(float(direction @ each.out_of_balance)) for each in (trial, full)
    )
    is_better = full.relative_residual <= 0.5 * trial.relative_residual
    if is_better or slope_start >= 0.0 or slope_full <= SLOPE_KEPT * abs(slope_start):
        return full
    low, slope_low, high, slope_high = 0.0, slope_start, 1.0, slope_full
    best = full
    for _ in range(MAX_LINE_SEARCH):
        length = low - slope_low * (high - low) / (slope_high - slope_low)
        length = max(length, SMALLEST_STEP)
        best = evaluate(trial, direction, length)
        slope = agree(float(direction @ best.out_of_balance))
        if abs(slope) <= SLOPE_WANTED * abs(slope_start):
            break
        if slope > 0.0:
            high, slope_high, slope_low = length, slope, 0.5 * slope_low
        else:
            low, slope_low, slope_high = length, slope, 0.5 * slope_high
    return best
