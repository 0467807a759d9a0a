"""Cost of an iteration of the service stage: factors used again against plain refactorisation.

    python benchmarks/service_iteration.py [--size M] [--far M] [--programme NAME] [--solver NAME]

The pile of ``cases/screwpile_quick.toml``, wished in place in its clay, goes sideways or down to
0.1 m. The same programme is run twice on the same mesh: with factors that are used again as the
case's defaults say, and with a factorisation in each iteration. CPU seconds are counted, because
machines are shared; the equilibration before the first programme compiles the kernels.
"""

import argparse
import os
import time
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import numpy as np

from handoff.fe_mesh import FEMesh
from handoff.fe_state_file import FEState
from handoff.hand_over import wished_in_place
from handoff.surface import level_surface
from service_fe.coupled_solver import CoupledSolver, CoupledSystem, Work
from service_fe.options import Displace, Lateral, Programme, ServiceNumerics
from service_fe.results import Curve
from service_fe.solve import run
from workflows.case import read_case
from workflows.placed import pile_at_end, service_problem
from workflows.screw_case import ScrewCase

CASE = Path(__file__).parent.parent / "cases" / "screwpile_quick.toml"
START = {"start": "equilibrated", "first_step_halvings": 1}
PROGRAMMES: dict[str, Programme] = {
    "lateral": Lateral("lateral", 0.1, 0.025, height=0.5, **START),
    "compression": Displace("compression", 0.1, 0.025, **START),
}


class Cost(NamedTuple):
    """What a programme took; CPU seconds."""

    iterations: int
    linear: float
    """Of the linear systems, with their preconditioner."""
    total: float
    work: Work
    curve: Curve


class TimedSolver:
    """Counts and times the linear systems given to a solver."""

    def __init__(self, solver: CoupledSolver) -> None:
        self.solver, self.matrix = solver, solver.matrix
        self.iterations, self.seconds = 0, 0.0

    @property
    def work(self) -> Work:
        """The work of the solver."""
        return self.solver.work

    def forget(self) -> None:
        """Use nothing of what was solved before."""
        self.solver.forget()

    def solve(self, system: CoupledSystem, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the solution."""
        begin = time.process_time()
        solution = self.solver.solve(system, tolerance)
        self.iterations += 1
        self.seconds += time.process_time() - begin
        return solution


def programme_cost(
    case: ScrewCase, mesh: FEMesh, start: FEState, programme: Programme, numerics: ServiceNumerics
) -> Cost:
    """Return the cost of ``programme`` from ``start`` with these ``numerics``."""
    assert case.service is not None
    case = replace(case, service=replace(case.service, numerics=numerics))
    problem = service_problem(case, pile_at_end(case), mesh)
    timed = TimedSolver(problem.model.solver)
    problem.model = problem.model._replace(solver=timed)  # type: ignore[arg-type]
    begin = time.process_time()
    curve = run(problem, start, [programme]).programmes[0].curve
    return Cost(timed.iterations, timed.seconds, time.process_time() - begin, timed.work, curve)


def start_of(case: ScrewCase) -> tuple[FEMesh, FEState]:
    """Return the mesh around the pile wished in place, and its state in equilibrium."""
    assert case.handoff is not None
    placed = pile_at_end(case)
    mesh = placed.mesh(case.box, case.handoff, level_surface(), ())
    problem = service_problem(case, placed, mesh)
    return mesh, wished_in_place(case.ground, case.interface, problem, case.handoff)


def print_row(name: str, cost: Cost, plain: Cost | None) -> None:
    """Print one line of the table."""
    per_iteration = cost.total / cost.iterations
    ratio = "" if plain is None else f"{per_iteration * plain.iterations / plain.total:8.2f}"
    print(
        f"{name:24} {cost.iterations:10} {cost.work.factorisations:14}"
        f" {cost.work.krylov_iterations:6} {cost.work.fallbacks:9}"
        f" {cost.linear:9.1f} {cost.total:8.1f} {per_iteration:14.2f} {ratio}",
        flush=True,
    )


MAX_REUSE = 40
"""Most iterations of GMRES before the stiffness is factorised again."""


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="0.2", help="of the elements at the plate in m")
    parser.add_argument("--far", default="1.1", help="of the elements far away in m")
    parser.add_argument("--programme", choices=PROGRAMMES, default="lateral")
    parser.add_argument("--solver", choices=("mumps", "iterative"), default="mumps")
    arguments = parser.parse_args()
    sizes = (
        f"handoff.size_at_pile='{arguments.size} m'",
        f"handoff.size_far='{arguments.far} m'",
    )
    case, _ = read_case(CASE, sizes)
    assert isinstance(case, ScrewCase)
    mesh, start = start_of(case)
    programme = PROGRAMMES[arguments.programme]
    print(
        f"{mesh.nodes.size} unknowns, {len(mesh.cell_nodes)} cells, {programme.name}; CPU seconds"
    )
    print(
        f"{'':24} {'iterations':>10} {'factorisations':>14} {'GMRES':>6} {'fallbacks':>9}"
        f" {'linear':>9} {'all':>8} {'per iteration':>14} {'ratio':>8}"
    )
    reused = ServiceNumerics(solver=arguments.solver, max_factor_reuse=MAX_REUSE)
    again = programme_cost(case, mesh, start, programme, reused)
    print_row(f"{arguments.solver}, as chosen", again, None)
    plain = programme_cost(case, mesh, start, programme, ServiceNumerics(max_factor_reuse=0))
    print_row("refactorised each time", plain, plain)
    print_row(f"{arguments.solver}, as chosen", again, plain)
    difference = np.abs(again.curve.head_load - plain.curve.head_load).max()
    print(f"largest difference of load: {difference / np.abs(plain.curve.head_load).max():.1e}")


if __name__ == "__main__":
    main()
