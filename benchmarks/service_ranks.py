"""Memory of the service stage on one rank and on several: the peak of each rank.

    python benchmarks/service_ranks.py [--size M] [--far M]
    mpirun -n 2 python benchmarks/service_ranks.py [--size M] [--far M]

The pile of ``cases/screwpile_quick.toml``, wished in place in its clay, goes sideways by 10 mm in
one step. The first peak holds Python, the libraries and the model, the last one also the factors.
CPU seconds are those of the load steps, waiting included; load and stress are there to be compared.
"""

import argparse
import os
import resource
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import numpy as np
from mpi4py import MPI

from handoff.surface import level_surface
from service_fe.options import Lateral
from service_fe.solve import run
from workflows.case import read_case
from workflows.placed import pile_at_end, service_problem
from workflows.ranks import on_first

CASE = Path(__file__).parent.parent / "cases" / "screwpile_quick.toml"
PUSH = Lateral("lateral", 0.01, 0.01, height=0.5, start="equilibrated", first_step_halvings=0)


def peak_memory() -> float:
    """Return the largest memory in MB that this rank has had so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def main() -> None:
    """Print the peaks of all ranks, and what they found."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="0.1", help="of the elements at the plate in m")
    parser.add_argument("--far", default="0.5", help="of the elements far away in m")
    arguments = parser.parse_args()
    case, _ = read_case(
        CASE,
        (
            f"handoff.size_at_pile='{arguments.size} m'",
            f"handoff.size_far='{arguments.far} m'",
            "service.numerics.max_factor_reuse=40",
        ),
    )
    assert case.handoff is not None
    placed, options = pile_at_end(case), case.handoff
    mesh = on_first(lambda: placed.mesh(case.box, options, level_surface(), ()))
    problem = service_problem(case, placed, mesh)
    state = problem.wished_in_place_state()
    before, begin = peak_memory(), time.process_time()
    (entry,) = run(problem, state, (PUSH,)).programmes
    peaks = MPI.COMM_WORLD.gather((before, peak_memory(), time.process_time() - begin))
    if MPI.COMM_WORLD.rank > 0:
        return
    print(f"{mesh.nodes.size} unknowns, {len(mesh.cell_nodes)} cells")
    print(f"{'rank':>4} {'before, MB':>12} {'peak, MB':>10} {'CPU, s':>8}")
    for rank, (first, last, seconds) in enumerate(peaks):
        print(f"{rank:4} {first:12.0f} {last:10.0f} {seconds:8.1f}")
    print(
        f"{entry.curve.iterations.sum()} iterations,"
        f" {entry.curve.factorisations.sum()} factorisations"
    )
    print(f"load in N: {entry.curve.head_load.tolist()}")
    print(f"norm of the stress in Pa: {np.linalg.norm(entry.state.cauchy_stress):.12e}")


if __name__ == "__main__":
    main()
