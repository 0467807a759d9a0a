"""What a step of a screw pile pays for linear solves: analysis, factorisation, and which dofs.

    python benchmarks/screw_pile_solver.py [--case CASE] [--set key=value ...]

The pile makes one step; the tangent that the next begins with is solved by MUMPS with different
choices of the dofs that are factorised together and of the order in which they are eliminated.
The first solution of a solver analyses, later ones do not; a second right-hand side costs its
substitution alone. CPU seconds, the least of a few, because machines are shared. A step is counted
with three solutions. The reference is the first row: the dofs of cells that hold soil change in
most steps, so that every step analyses.
"""

import argparse
import os
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import numpy as np
from petsc4py import PETSc
from space_kernels import CASE, second_step

from install_mpm.linear_solvers import mumps
from workflows.case import read_case

ORDERINGS = {"automatic": 7, "approximate minimum fill": 2, "PORD": 4, "quasi-dense AMD": 6}
REPETITIONS = 3
SOLUTIONS_PER_STEP = 3


def seconds(action):
    """Return the CPU time of an action in s."""
    start = time.process_time()
    action()
    return time.process_time() - start


def parts(pattern, evaluation, left_out):
    """Return seconds of analysis, factorisation and substitution without the dofs ``left_out``."""
    values, load = evaluation.tangent, -evaluation.residual
    loads = np.stack([load, load], axis=1)
    first, later, two = [], [], []
    for _ in range(REPETITIONS):
        solve = mumps(pattern)
        first.append(seconds(lambda: solve(values, load, left_out)))  # noqa: B023
        later.append(seconds(lambda: solve(values, load, left_out)))  # noqa: B023
        two.append(seconds(lambda: solve(values, loads, left_out)))  # noqa: B023
    substitution = max(min(two) - min(later), 0.0)
    return min(first) - min(later), min(later) - substitution, substitution


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--case", type=Path, default=CASE)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    arguments = parser.parse_args()
    case, _ = read_case(arguments.case, arguments.set)
    system, trial, _ = second_step(case)
    evaluation, pattern = system.evaluate(trial), system.model.pattern
    without_soil, supports = ~system.is_free.ravel(), system.is_prescribed.ravel()
    rows = [("with soil, analysed every step", without_soil, "automatic", 1)]
    rows += [(f"all but supports, {name}", supports, name, 0) for name in ORDERINGS]
    rows += [("all", np.zeros_like(supports), "automatic", 0)]
    print(
        f"{'dofs':44} {'number':>7} {'analysis':>9} {'factors':>8} {'solve':>7} {'step':>7} ratio"
    )
    reference = None
    for name, left_out, ordering, analyses in rows:
        PETSc.Options()["mat_mumps_icntl_7"] = ORDERINGS[ordering]
        analysis, factors, substitution = parts(pattern, evaluation, left_out)
        step = analyses * analysis + SOLUTIONS_PER_STEP * (factors + substitution)
        reference = reference or step
        print(
            f"{name:44} {np.count_nonzero(~left_out):7d} {analysis:9.3f} {factors:8.3f} "
            f"{substitution:7.3f} {step:7.3f} {step / reference:5.2f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
