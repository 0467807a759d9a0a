"""Runs reference problems one after the other and judges them."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from install_mpm.newton import convergence_order
from workflows.verification.parameters import Parameter, parameters_of
from workflows.verification.problem import Check, Outcome, Problem, at_least

QUADRATIC = 1.8
"""Order of Newton's method, of a step and in the median of steps, that counts as quadratic."""

STRAIGHT_ITERATIONS = 2
"""Most iterations of a step of a problem that shows no order: the second meets round-off."""

QUICK_SECONDS, OTHER_SECONDS = 5.0, 60.0
"""Typical time of a problem, for the estimate while they run."""


@dataclass(frozen=True)
class NewtonStatement:
    """How Newton's method converged over all steps of a problem."""

    steps: int
    most_iterations: int
    median_order: float
    """NaN if no step took enough iterations to tell."""
    smallest_order: float
    quadratic_share: float
    """Of the steps that show an order; NaN likewise."""

    @property
    def text(self) -> str:
        """The statement in words."""
        counts = f"{self.steps} steps, at most {self.most_iterations} iterations"
        if np.isnan(self.median_order):
            return f"{counts}; too few above round-off to tell an order"
        return (
            f"{counts}; order {self.median_order:.2f} (median), {self.smallest_order:.2f} (min);"
            f" {self.quadratic_share:.0%} of the steps at {QUADRATIC} or more"
        )

    @property
    def check(self) -> Check:
        """The check of every problem that iterates.

        The order of a step is that of its last three residuals above round-off.  Steps in which
        points begin to yield or to slip find their branch first, so the median counts.  Where no
        step leaves three residuals above round-off, each is solved by a straight correction.
        """
        if np.isnan(self.median_order):
            text = "Newton iterations of a step, largest; solved at once, too few to show an order"
            return Check(text, self.most_iterations, STRAIGHT_ITERATIONS,
                         max(self.most_iterations - STRAIGHT_ITERATIONS, 0), 0.0)  # fmt: skip
        return at_least("order of Newton's method, median", self.median_order, QUADRATIC)


@dataclass(frozen=True)
class Run:
    """A problem to be run, alone or as a case file describes it."""

    problem: Problem
    values: Mapping[str, Any]
    """Values in place of defaults."""
    name: str
    """Of the problem, or of the case file without its ending."""
    title: str


@dataclass(frozen=True)
class Verified:
    """A problem, what it was run with and what came out."""

    problem: Problem
    values: Mapping[str, Any]
    """Value of every parameter."""
    seconds: float
    """Of processor time, which other work on the machine does not change."""
    outcome: Outcome | None
    """None if the problem could not be solved."""
    failure: str = ""
    """Why it could not, in a sentence."""
    is_kept: bool = False
    """Whether it was computed by an earlier run."""
    case_name: str = ""
    """Of the case file without its ending; empty without a case."""
    case_title: str = ""

    @property
    def name(self) -> str:
        """What the result is called: the case, or the identifier of the problem."""
        return self.case_name or self.problem.identifier

    @property
    def title(self) -> str:
        """Title of the case, or of the problem."""
        return self.case_title or self.problem.title

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The parameters of the problem, in its order."""
        return tuple(parameters_of(self.problem).values())

    @property
    def newton(self) -> NewtonStatement | None:
        """The statement on convergence, None if the problem has no Newton iterations."""
        if self.outcome is None or not self.outcome.residual_histories:
            return None
        return newton_statement(self.outcome.residual_histories, self.outcome.round_off)

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks of the problem, and that of Newton's method if the problem iterates."""
        newton = self.newton
        own = self.outcome.checks if self.outcome else ()
        return own if newton is None else (*own, newton.check)

    @property
    def is_met(self) -> bool:
        """Whether the problem was solved and every check holds."""
        return bool(self.checks) and all(check.is_met for check in self.checks)


def newton_statement(histories: Sequence[Sequence[float]], round_off: float) -> NewtonStatement:
    """Return the statement on residual histories; steps that show no order are left out of it."""
    orders = np.array([_order_shown(np.array(history), round_off) for history in histories])
    orders = orders[~np.isnan(orders)]
    return NewtonStatement(
        steps=len(histories),
        most_iterations=max(len(history) - 1 for history in histories),
        median_order=float(np.median(orders)) if orders.size else float("nan"),
        smallest_order=float(orders.min()) if orders.size else float("nan"),
        quadratic_share=float((orders >= QUADRATIC).mean()) if orders.size else float("nan"),
    )


def _order_shown(residuals: np.ndarray, round_off: float) -> float:
    """Return the order of a step, NaN if it shows none.

    Where the third of three residuals is round-off, they give a lower bound only: short of a
    quadratic order it says nothing.
    """
    order = convergence_order(residuals, round_off)
    is_bound = np.count_nonzero(residuals > round_off) < 3
    return float("nan") if is_bound and order < QUADRATIC else order


def run_problem(problem: Problem, values: Mapping[str, Any] | None = None) -> Verified:
    """Return the result of ``problem`` with ``values`` in place of its defaults.

    A problem that raises an error is a failed one; nothing is raised.
    """
    inputs = inputs_of(problem, values or {})
    start = time.process_time()
    try:
        outcome, failure = problem.run(**inputs), ""
    except Exception as error:  # whatever it is, the other problems go on
        outcome, failure = None, _sentence(error)
    return Verified(problem, inputs, time.process_time() - start, outcome, failure)


def inputs_of(problem: Problem, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the value of every parameter, with ``values`` in place of defaults."""
    return {name: one.default for name, one in parameters_of(problem).items()} | dict(values)


def _sentence(error: Exception) -> str:
    text = " ".join(str(error).split())
    is_told = isinstance(error, RuntimeError | ValueError) and text
    return text if is_told else f"{type(error).__name__}: {text}".removesuffix(": ")


def run_problems(
    runs: Sequence[Run],
    advance: Callable[[int, int, str], None],
    observe: Callable[[Verified], None],
    solve: Callable[[Problem, Mapping[str, Any]], Verified] = run_problem,
) -> list[Verified]:
    """Return the results of all ``runs``.

    ``advance`` is told of expected seconds before each problem, ``observe`` gets each result.
    ``solve`` returns the result of a problem with values in place of its defaults.
    """
    expected = [QUICK_SECONDS if run.problem.is_quick else OTHER_SECONDS for run in runs]
    results: list[Verified] = []
    for number, run in enumerate(runs):
        note = f"{run.name} {run.title}"
        advance(round(sum(expected[:number])), round(sum(expected)), note)
        result = solve(run.problem, run.values)
        if run.name != run.problem.identifier:
            result = replace(result, case_name=run.name, case_title=run.title)
        results.append(result)
        observe(result)
    return results
