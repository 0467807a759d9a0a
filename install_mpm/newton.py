"""Newton's method with backtracking.

Knows a residual, a tangent and a linear solver, and nothing of soil.

Order of evaluation: residual and tangent at the start; then solve, step, and evaluate again,
halving the step while the trial is inadmissible or the residual grows.  The last *accepted* iterate
is returned; nothing is kept on failure.

A dof that hardly anything holds can ask for a correction far beyond all others, which would have to
be halved until nothing is left of them.  It can be given a limit of its own: the others then keep
their full correction, and near the solution no limit is reached.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from install_mpm.linear_solvers import LinearSolve, SingularMatrixError
from install_mpm.timing import measured

BACKTRACKS = 6
"""Halvings of a Newton step before the iteration goes on with the best trial found."""

BACKTRACKS_BEFORE_GIVING_UP = 2
"""Halvings after which an iteration that may give up does so.

Where Newton's method goes back and forth, one halving brings it on; a trial far from equilibrium
does not get better in any number of them.
"""

GROWTH_ALLOWED = 1.0
"""A full step is taken while the residual does not grow beyond this factor."""

ROUND_OFF = 2e-12
"""Relative residuals below this are round-off and say nothing about the order of convergence."""

NO_LIMIT = np.array(np.inf)
"""Of corrections."""

EXACT = float(np.finfo(float).eps)
"""What a residual of zero counts as where logarithms are taken."""


class Evaluation(NamedTuple):
    """Residual, tangent and the force they are measured against, for one trial."""

    residual: np.ndarray
    """Out-of-balance force of the free dofs, zero elsewhere, (n_dofs,) in N."""
    tangent: Any
    """The constrained tangent, as the linear solver takes it."""
    reference: float
    """Force in N that the residual is measured against."""
    is_admissible: bool
    """False if a cell collapsed or a law failed."""
    mismatch: float = 0.0
    """How far resultants are from balance, held to the same tolerance; 0: they are not compared."""


class NewtonResult(NamedTuple):
    """Outcome of a Newton iteration; ``solution`` is of use only if ``is_converged``."""

    solution: np.ndarray
    is_converged: bool
    residuals: np.ndarray
    """Relative out-of-balance force, the start first."""
    mismatch: float = 0.0
    """Of the resultants at the solution, see ``Evaluation``."""


def solve_newton(
    evaluate: Callable[[np.ndarray], Evaluation],
    solve: LinearSolve,
    start: np.ndarray,
    tolerance: float,
    max_iterations: int,
    largest_correction: np.ndarray = NO_LIMIT,
    *,
    gives_up: bool = False,
    patience: int | None = None,
) -> NewtonResult:
    """Return the solution of ``evaluate(x).residual = 0`` from ``start`` (n_dofs,).

    Convergence means |residual| <= tolerance * reference, and that resultants balance to the same
    tolerance; at least one correction is always made, unless the start is exact to round-off.  No
    dof is corrected by more than ``largest_correction``, one number or (n_dofs,), in an iteration.
    If it ``gives_up``, the iteration ends with the first correction that increases the residual
    even after ``BACKTRACKS_BEFORE_GIVING_UP`` halvings; with ``patience``, if the residual has not
    halved in so many iterations.
    """
    x = start
    state = evaluate(x)
    if not state.is_admissible:
        return NewtonResult(x, False, np.array([np.inf]))
    residuals = [_relative(state)]
    halvings = BACKTRACKS_BEFORE_GIVING_UP if gives_up else BACKTRACKS
    for iteration in range(max_iterations):
        small_enough = tolerance if iteration else ROUND_OFF
        if residuals[-1] <= small_enough and state.mismatch <= tolerance:
            return NewtonResult(x, True, np.array(residuals), state.mismatch)
        try:
            with measured("linear solves"):
                correction = solve(state.tangent, -state.residual)
        except SingularMatrixError:
            return NewtonResult(x, False, np.array(residuals), state.mismatch)
        correction = np.clip(correction, -largest_correction, largest_correction)
        x, state = _backtrack(evaluate, x, correction, state, halvings)
        if not state.is_admissible:
            break
        residuals.append(_relative(state))
        if gives_up and residuals[-1] > GROWTH_ALLOWED * residuals[-2]:
            break
        if patience is not None and 2.0 * residuals[-1] > min(
            residuals[:-patience], default=np.inf
        ):
            break
    is_converged = state.is_admissible and max(residuals[-1], state.mismatch) <= tolerance
    return NewtonResult(x, is_converged, np.array(residuals), state.mismatch)


def _relative(state: Evaluation) -> float:
    return float(np.linalg.norm(state.residual) / state.reference)


def _backtrack(
    evaluate: Callable[[np.ndarray], Evaluation],
    x: np.ndarray,
    correction: np.ndarray,
    before: Evaluation,
    halvings: int,
) -> tuple[np.ndarray, Evaluation]:
    """Return the first admissible trial that does not increase the residual, else the best.

    The residual is that over its reference, which changes from trial to trial: by the force alone
    the bending of a slender body, which begins with large forces that the supports share, stops.
    """
    best: tuple[float, np.ndarray, Evaluation] | None = None
    for halving in range(halvings + 1):
        trial = x + correction * 0.5**halving
        state = evaluate(trial)
        residual = _relative(state) if state.is_admissible else np.inf
        if residual <= GROWTH_ALLOWED * _relative(before):
            return trial, state
        if best is None or residual < best[0]:
            best = (residual, trial, state)
    assert best is not None  # the loop above runs at least once
    return best[1], evaluate(best[1])  # what an evaluation leaves behind has to be of this trial


def convergence_order(residuals: np.ndarray, round_off: float = ROUND_OFF) -> float:
    """Return the order p of the end of a residual history, r_k+1 ~ r_k^p.

    NaN if there are fewer than three residuals.

    Three successive residuals give p = ln(r_3 / r_2) / ln(r_2 / r_1).  Residuals below
    ``round_off`` say nothing; stiff ground under a small load has it higher than the default.  The
    last three above round-off are used; if one more lies below, it can only be too large for its
    order, so its triple counts where it gives more.
    """
    n_above = int(np.count_nonzero(residuals > round_off))
    orders = [
        _order_of_three(residuals[last - 3 : last])
        for last in (n_above, n_above + 1)
        if 3 <= last <= len(residuals)
    ]
    return max(orders, default=float("nan"))


def _order_of_three(residuals: np.ndarray) -> float:
    """Return the order of three successive residuals, 0 if they do not fall."""
    first, second, third = np.log(np.maximum(residuals, EXACT))
    return float((third - second) / (second - first)) if third < second < first else 0.0
