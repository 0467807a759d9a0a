"""Cost of force, tangent and assembly in space per material point and evaluation, on one core.

    python benchmarks/space_kernels.py [--set key=value ...]

The quick screw pile in clay makes one step, which compiles; then the state that it ends with is
evaluated again and again: return mapping, force and stiffness of the quadratic tetrahedra,
interface, and assembly into the global matrix. The time is divided by all material points, whose
state the integration points of the cells carry. The best of the evaluations counts, in CPU
seconds, because machines are shared. The solution of the linear system is timed beside it.
"""

import argparse
import os
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import numpy as np

from install_mpm import carriers
from install_mpm.equilibrium import Prescribed, StepSystem
from install_mpm.rig import motion_to
from install_mpm.screw_installation import advance_pile, next_step
from install_mpm.screw_path import START
from install_mpm.screw_pile_mesh import generate_screw_mesh
from install_mpm.screw_setup import geostatic_state, set_up
from install_mpm.step import switch_on
from workflows.case import read_case

CASE = Path(__file__).parents[1] / "cases" / "screwpile_quick.toml"
EVALUATIONS = 20


def second_step(case):
    """Return the equations of the second step of the pile, and its first trial displacement."""
    mesh = generate_screw_mesh(case.pile, case.box, case.background_mesh)
    problem = set_up(
        case.ground, case.pile, case.interface, case.box, case.installation, case.numerics, mesh
    )
    state = geostatic_state(problem, mesh, case.background_mesh, "")
    state, _ = advance_pile(problem, state, START)
    state, is_accepted = advance_pile(problem, state, next_step(problem, state))
    assert is_accepted
    pose = next_step(problem, state).pose
    given = carriers.give_state(
        state.material_points, state.background_mesh, problem.model, problem.gradient
    )
    system = StepSystem(
        state.background_mesh, given.quadrature, given.fill,
        switch_on(state.interface, given.fill, problem.model), motion_to(state, pose),
        Prescribed(problem.supports, np.zeros_like(mesh.nodes)), problem.model,
    )  # fmt: skip
    return system, state.control.displacement_per_step.ravel(), state


def best_seconds(action):
    """Return the least CPU time of an action in s."""
    times = []
    for _ in range(EVALUATIONS):
        start = time.process_time()
        action()
        times.append(time.process_time() - start)
    return min(times)


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    case, _ = read_case(CASE, parser.parse_args().set)
    system, trial, state = second_step(case)
    points, cells = len(state.material_points.mass), len(state.background_mesh.cell_nodes)
    evaluation = system.evaluate(trial)
    changed = system.trial.state_variables != system.points.state_variables
    n_yield = np.count_nonzero(changed.any(axis=1))
    seconds = {
        "force, tangent and assembly": best_seconds(lambda: system.evaluate(trial)),
        "linear solve": best_seconds(
            lambda: system.solver()(evaluation.tangent, -evaluation.residual)
        ),
    }
    print(
        f"{cells} cells, {points} material points, {trial.size} unknowns; "
        f"{n_yield} of {len(changed)} integration points yield"
    )
    print(f"{'':30} {'ms':>8} {'us/point':>10}")
    for name, value in seconds.items():
        print(f"{name:30} {1e3 * value:8.1f} {1e6 * value / points:10.2f}")


if __name__ == "__main__":
    main()
