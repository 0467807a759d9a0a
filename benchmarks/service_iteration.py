"""Cost of an iteration of the service stage: factors used again, or multigrid, against factorising.

    python benchmarks/service_iteration.py [--size M] [--far M] [--programme NAME] [--way M]
        [--solvers reused multigrid plain]

The pile of ``cases/screwpile_quick.toml``, wished in place in its clay, goes sideways or down, to
0.1 m. The same programme is run once with each solver on the same mesh: with factors that are used
again, with multigrid, and with a factorisation in each iteration. CPU seconds are counted, because
machines are shared; the equilibration before the first programme compiles the kernels. The peak of
memory is that of the process so far: give one solver alone to compare it.
"""

import argparse
import os
import resource
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
from service_fe.coupled_solver import USUAL_REUSE, CoupledSolver, CoupledSystem, Work
from service_fe.options import Displace, Lateral, Programme, ServiceNumerics
from service_fe.results import Curve
from service_fe.solve import run
from workflows.case import read_case
from workflows.placed import pile_at_end, service_problem
from workflows.screw_case import ScrewCase

CASE = Path(__file__).parent.parent / "cases" / "screwpile_quick.toml"
START = {"start": "equilibrated", "first_step_halvings": 1}
STEP = 0.025
SOLVERS = {
    "reused": ServiceNumerics(max_factor_reuse=USUAL_REUSE),
    "multigrid": ServiceNumerics(solver="iterative", max_factor_reuse=USUAL_REUSE),
    "plain": ServiceNumerics(max_factor_reuse=0),
}


def programme_of(name: str, way: float) -> Programme:
    """Return a programme that goes ``way`` in m."""
    if name == "lateral":
        return Lateral(name, way, STEP, height=0.5, **START)
    return Displace(name, way, STEP, **START)


class Cost(NamedTuple):
    """What a programme took; CPU seconds."""

    iterations: int
    linear: float
    """Of the linear systems, with their preconditioner."""
    total: float
    peak: float
    """Memory of the process so far in GB."""
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
    problem = service_problem(with_numerics(case, numerics), pile_at_end(case), mesh)
    timed = TimedSolver(problem.model.solver)
    problem.model = problem.model._replace(solver=timed)  # type: ignore[arg-type]
    begin = time.process_time()
    curve = run(problem, start, [programme]).programmes[0].curve
    total = time.process_time() - begin
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    return Cost(timed.iterations, timed.seconds, total, peak, timed.work, curve)


def with_numerics(case: ScrewCase, numerics: ServiceNumerics) -> ScrewCase:
    """Return the case with other numerics of the service stage."""
    assert case.service is not None
    return replace(case, service=replace(case.service, numerics=numerics))


def start_of(case: ScrewCase) -> tuple[FEMesh, FEState]:
    """Return the mesh around the pile wished in place, and its state in equilibrium."""
    assert case.handoff is not None
    placed = pile_at_end(case)
    mesh = placed.mesh(case.box, case.handoff, level_surface(), ())
    problem = service_problem(case, placed, mesh)
    return mesh, wished_in_place(case.ground, case.interface, problem, case.handoff)


def print_row(name: str, cost: Cost, plain: Cost | None) -> None:
    """Print one line of the table; ratios, if the plain one is known, are those to it.

    Of the linear systems of an iteration, of a whole iteration, and of the programme.
    """
    count, work = cost.iterations, cost.work
    print(
        f"{name:10} {count:10} {work.factorisations:14} {work.krylov_iterations:6}"
        f" {work.fallbacks:9} {cost.linear:9.1f} {cost.total:8.1f} {cost.linear / count:9.2f}"
        f" {cost.total / count:9.2f} {cost.peak:6.2f}",
        end="",
    )
    if plain is not None:
        ratios = (
            cost.linear / count / (plain.linear / plain.iterations),
            cost.total / count / (plain.total / plain.iterations),
            cost.total / plain.total,
        )
        print("".join(f"{ratio:8.2f}" for ratio in ratios), end="")
    print(flush=True)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="0.2", help="of the elements at the plate in m")
    parser.add_argument("--far", default="1.1", help="of the elements far away in m")
    parser.add_argument("--programme", choices=("lateral", "compression"), default="lateral")
    parser.add_argument("--way", type=float, default=0.1, help="of the programme in m")
    parser.add_argument("--solvers", nargs="+", choices=SOLVERS, default=["reused", "plain"])
    arguments = parser.parse_args()
    sizes = (
        f"handoff.size_at_pile='{arguments.size} m'",
        f"handoff.size_far='{arguments.far} m'",
    )
    case, _ = read_case(CASE, sizes)
    assert isinstance(case, ScrewCase)
    mesh, start = start_of(with_numerics(case, SOLVERS[arguments.solvers[0]]))
    programme = programme_of(arguments.programme, arguments.way)
    print(
        f"{mesh.nodes.size} unknowns, {len(mesh.cell_nodes)} cells, {programme.name}; CPU seconds"
    )
    print(
        f"{'':10} {'iterations':>10} {'factorisations':>14} {'GMRES':>6} {'fallbacks':>9}"
        f" {'linear':>9} {'all':>8} {'lin/iter':>9} {'all/iter':>9} {'GB':>6}"
        f" {'ratios: lin/iter, all/iter, all':>24}"
    )
    costs = {}
    for name in arguments.solvers:
        costs[name] = programme_cost(case, mesh, start, programme, SOLVERS[name])
        print_row(name, costs[name], costs.get("plain"))
    if "plain" in costs:
        print_comparison(costs)


def print_comparison(costs: dict[str, Cost]) -> None:
    """Print the table with ratios, and by how much the curves differ from the plain one."""
    plain = costs["plain"]
    print("beside the plain one:")
    for name, cost in costs.items():
        print_row(name, cost, plain)
    for name, cost in costs.items():
        difference = np.abs(cost.curve.head_load - plain.curve.head_load).max()
        relative = difference / np.abs(plain.curve.head_load).max()
        print(f"{name}: largest difference of load {relative:.1e}")


if __name__ == "__main__":
    main()
