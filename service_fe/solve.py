"""Stage 3: the programmes of loading, one after the other; the step loop with cutting.

A state is a value: programmes that start from the same state are independent branches.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal, NamedTuple

import numpy as np

from handoff.fe_state_file import FEIntegrationPoints, FEInterfacePoints, FEState
from install_mpm.newton import convergence_order
from service_fe.along_pile import Recorder
from service_fe.coupled_solver import Work
from service_fe.loading import (
    END_OF,
    EQUILIBRATED,
    ImposedStep,
    Mode,
    contradiction,
    imposed_steps,
    shows_moment,
    start_of,
)
from service_fe.newton import StepNotConvergedError
from service_fe.options import Programme
from service_fe.problem import ServiceProblem
from service_fe.results import Curve, Displacement, ModelName, ProgrammeResult, ServiceResult
from service_fe.settling import Settled, settle
from service_fe.step import Step, Unknowns


class ServiceError(RuntimeError):
    """The service stage cannot go on; the message names programme and step and says what to do."""


class ServiceProgress(NamedTuple):
    """What an observer is told after each step; displacement and load as in ``results.Curve``."""

    programme: str
    step: int
    n_steps: int
    load_unit: Literal["N", "N m"]
    displacement: float
    head_load: float
    iterations: int
    cuts: int


Observer = Callable[[ServiceProgress], None]


class Advance(NamedTuple):
    """A whole step of a programme, taken in one or more parts."""

    last: Step
    increment: Unknowns
    iterations: int
    cuts: int
    settled: int
    """Damped parts."""


def run(
    problem: ServiceProblem,
    state: FEState,
    programmes: Sequence[Programme],
    observe: Observer = lambda progress: None,
    *,
    rebound: np.ndarray | None = None,
    model: ModelName = "installed",
    case_text: str = "",
) -> ServiceResult:
    """Return the result of all programmes.

    Parameters
    ----------
    problem
        Finite-element model.
    state
        Equilibrated state: handed over, or ``problem.wished_in_place_state()``.
    programmes
        Programmes in order; "released" is the end of the release before them, "resumed" that of
        the rig's coming back, and a programme may start from the end of any before it.
    observe
        Called after each step.
    rebound
        Motion (n_motions,) in m and rad of the pile while the rig let go of it, before the
        hand-over; None: it did not.
    model, case_text
        Name of the model and text of the case, kept in the result.

    Raises
    ------
    ServiceError
        If two programmes have one name, a programme needs a release that has not been run, or a
        step does not converge after ``max_cuts`` halvings.
    """
    check_programmes(programmes)
    starts = {EQUILIBRATED: state}
    results = []
    for programme in programmes:
        start = starts[start_of(programme)]
        results.append(run_programme(problem, start, programme, observe, rebound))
        starts[programme.name] = results[-1].state
        starts[END_OF.get(programme.kind, programme.name)] = results[-1].state
    return ServiceResult(
        model=model,
        mesh=problem.mesh,
        integration=FEIntegrationPoints(problem.integration_positions, problem.integration_volumes),
        interface=FEInterfacePoints(
            problem.interface_positions,
            problem.interface_normals,
            problem.interface_areas,
            problem.interface_parts,
        ),
        programmes=tuple(results),
        case_text=case_text,
    )


def check_programmes(programmes: Sequence[Programme]) -> None:
    """Check names and start states.

    Raises
    ------
    ServiceError
        If two programmes have one name, or one moves nothing or starts from what is not before it.
    """
    wrong = contradiction(programmes)
    if wrong is not None:
        raise ServiceError(f"programme: {wrong}")


def run_programme(
    problem: ServiceProblem,
    state: FEState,
    programme: Programme,
    observe: Observer = lambda progress: None,
    rebound: np.ndarray | None = None,
) -> ProgrammeResult:
    """Return the result of one programme that starts from ``state``; see ``run`` for the rest.

    Raises
    ------
    ServiceError
        If a step does not converge.
    """
    problem.model.solver.forget()
    load = problem.pile_load(state)
    steps = imposed_steps(programme, load, rebound)
    rows = [_first_row(problem, steps[0].mode, load)]
    displacement = np.zeros_like(problem.mesh.nodes)
    guess, size = None, 0.0
    along = Recorder(problem)
    along.add(state, displacement, rows[0].motion)
    for number, imposed in enumerate(steps, start=1):
        guess = guess.scaled(imposed.size / size) if guess is not None and size else None
        before = problem.model.solver.work
        try:
            taken = advance(problem, state, imposed, guess)
        except StepNotConvergedError as error:
            raise ServiceError(
                f"programme {programme.name!r}, step {number} of {len(steps)} at"
                f" {rows[-1].displacement:g} m: {error}; take smaller steps"
            ) from error
        state, size = taken.last.state, imposed.size
        guess = None if taken.settled else taken.increment
        displacement += taken.increment.displacement
        work = problem.model.solver.work.since(before)
        rows.append(_row(problem, rows[-1], imposed.mode, taken, work))
        along.add(state, displacement, rows[-1].motion)
        unit: Literal["N", "N m"] = "N m" if shows_moment(programme) else "N"
        observe(ServiceProgress(programme.name, number, len(steps), unit, *rows[-1][:4]))
    return ProgrammeResult(
        programme, _curve(rows), Displacement(displacement), state, along.result()
    )


def advance(
    problem: ServiceProblem, state: FEState, imposed: ImposedStep, guess: Unknowns | None = None
) -> Advance:
    """Return a whole step, settled or halved as often as needed.

    ``guess`` may be the step before.  After a success the next part is twice as long again.

    Raises
    ------
    StepNotConvergedError
        If a part of 1 / 2^max_cuts of the step does not converge.
    """
    done, share, cuts, iterations, settled = 0.0, 1.0, 0, 0, 0
    total = Unknowns(np.zeros_like(problem.mesh.nodes), np.zeros_like(imposed.motion))
    part = None
    while done < 1.0:
        try:
            part = _part(problem, state, imposed, (done, done + share), guess)
        except StepNotConvergedError:
            guess = None
            cuts += 1
            share *= 0.5
            if share < 0.5**problem.numerics.max_cuts:
                raise
            continue
        state, done, iterations = part.last.state, done + share, iterations + part.iterations
        total, settled = total.plus(part.increment), settled + part.parts
        next_share = min(2.0 * share, 1.0 - done)
        guess = None if part.parts else part.increment.scaled(next_share / share)
        share = next_share
    assert part is not None
    return Advance(part.last, total, iterations, cuts, settled)


def _part(
    problem: ServiceProblem,
    state: FEState,
    imposed: ImposedStep,
    shares: tuple[float, float],
    guess: Unknowns | None,
) -> Settled:
    """Return a step between two shares of it, solved from ``guess``, from rest, or settled."""
    numerics, control = problem.numerics, imposed.control(*shares)
    viscous = numerics.viscosity / (shares[1] - shares[0])
    for first in (guess, None) if guess is not None else (None,):
        try:
            step = problem.solve(state, control, guess=first, damping=viscous)
        except StepNotConvergedError:
            if first is None and numerics.damping == 0.0:
                raise
        else:
            return Settled(step, step.increment, step.iterations, 0)
    return settle(problem, state, control, numerics.damping)


class _Row(NamedTuple):
    displacement: float
    head_load: float
    iterations: int
    cuts: int
    settled: int
    viscous_share: float
    work: Work
    residuals: tuple[float, ...]
    motion: np.ndarray
    load: np.ndarray


def _first_row(problem: ServiceProblem, mode: Mode, load: np.ndarray) -> _Row:
    whole = problem.whole_body * load
    head_load = float(mode.measure @ (whole @ mode.frame))
    return _Row(0.0, head_load, 0, 0, 0, 0.0, Work(), (), np.zeros(len(load)), whole)


def _row(problem: ServiceProblem, before: _Row, mode: Mode, taken: Advance, work: Work) -> _Row:
    moved = taken.increment.motion
    load = problem.whole_body * taken.last.pile_load
    return _Row(
        before.displacement + float(mode.measure @ np.linalg.solve(mode.frame, moved)),
        float(mode.measure @ (load @ mode.frame)) + 0.0,  # no negative zero
        taken.iterations,
        taken.cuts,
        taken.settled,
        taken.last.viscous_share,
        work,
        taken.last.residuals,
        before.motion + moved,
        load,
    )


def _curve(rows: Sequence[_Row]) -> Curve:
    width = max(len(row.residuals) for row in rows)
    history = np.full((len(rows), width), np.nan)
    for padded, row in zip(history, rows, strict=True):
        padded[: len(row.residuals)] = row.residuals
    return Curve(
        displacement=np.array([row.displacement for row in rows]),
        head_load=np.array([row.head_load for row in rows]),
        iterations=np.array([row.iterations for row in rows], dtype=np.int64),
        residual=np.array([row.residuals[-1] if row.residuals else 0.0 for row in rows]),
        convergence_order=np.array([convergence_order(np.array(row.residuals)) for row in rows]),
        cuts=np.array([row.cuts for row in rows], dtype=np.int64),
        settled=np.array([row.settled for row in rows], dtype=np.int64),
        viscous_share=np.array([row.viscous_share for row in rows]),
        **_work_of([row.work for row in rows]),
        residual_history=history,
        motion=np.array([row.motion for row in rows]),
        load=np.array([row.load for row in rows]),
    )


def _work_of(steps: Sequence[Work]) -> dict[str, np.ndarray]:
    """Return the work of the linear solver, one array (load_step,) for each of its counts."""
    return {
        name: np.array(counts, dtype=np.int64)
        for name, counts in zip(Work._fields, zip(*steps, strict=True), strict=True)
    }
