"""Cost of the installation stage per material point and Newton iteration.

    python benchmarks/installation_step.py [--set key=value ...]

Ten steps of the main case on one thread, with MUMPS and, as the reference of the same run, with
SuperLU; and the time that memory needs to move the 1.1 kB that a point-iteration touches, which is
the physical limit. CPU seconds are compared, because machines are shared; the first step, which
compiles, is left out.
"""

import argparse
import dataclasses
import os
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import numpy as np

from install_mpm.installation import install
from workflows.case import read_case

CASE = Path(__file__).parents[1] / "cases" / "jacked_pile_clay.toml"
STEPS = 10
BYTES_PER_POINT_ITERATION = 1.1e3


def microseconds_per_point_iteration(case, linear_solver):
    """CPU time of the moving steps over material points times evaluations of the tangent."""
    clock, marks = time.process_time, []
    programme = dataclasses.replace(case.installation, penetration=STEPS * case.installation.step)
    numerics = dataclasses.replace(case.numerics, linear_solver=linear_solver)
    state = install(
        case.ground, case.pile, case.interface, case.box, case.background_mesh, programme, numerics,
        "", observe=lambda state, progress: marks.append(clock()),
    )  # fmt: skip
    evaluations = (state.history.iterations[1:] + 1).sum()
    points = len(state.material_points.mass)
    return 1e6 * (marks[-1] - marks[0]) / (evaluations * points), points


def microseconds_of_memory():
    """CPU time to move the data of one point-iteration through memory (triad, best of ten)."""
    a, b, c = (np.ones(20_000_000) for _ in range(3))
    times = []
    for _ in range(10):
        start = time.process_time()
        np.multiply(b, 3.0, out=a)
        np.add(a, c, out=a)
        times.append(time.process_time() - start)
    bandwidth = 5 * a.nbytes / min(times)
    return 1e6 * BYTES_PER_POINT_ITERATION / bandwidth


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    case, _ = read_case(CASE, parser.parse_args().set)
    limit = microseconds_of_memory()
    rows = [(name, *microseconds_per_point_iteration(case, name)) for name in ("mumps", "superlu")]
    reference = rows[1][1]
    print(f"{rows[0][2]} material points, {STEPS} steps, everything included")
    print(f"{'':10} {'us/point-iteration':>20} {'over SuperLU':>14} {'over memory':>12}")
    for name, cost, _ in rows:
        print(f"{name:10} {cost:20.2f} {cost / reference:14.2f} {cost / limit:12.1f}")
    print(f"{'memory':10} {limit:20.2f}")


if __name__ == "__main__":
    main()
