"""Cost of every soil law with its consistent tangent, in ns per point.

    python benchmarks/soil_laws.py [LAW ...]

Points of undisturbed ground, 2 to 12 m deep, are strained at random: so little that all stay
elastic, or so much that most yield. One thread; the arrays are far larger than the caches, and
every point is met once in a call, as in a step. CPU seconds are counted, because machines are
shared; the first call, which compiles, is left out.
"""

import argparse
import os
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import numpy as np

from install_mpm.constitutive import dispatch
from install_mpm.constitutive.mandel import COLUMN, ROW, SCALE
from install_mpm.geostatic import undisturbed_state
from install_mpm.ground import Ground, soils_of
from workflows.schema import build
from workflows.soil_template import soil_example
from workflows.soil_typical import TYPICAL

POINTS = 200_000
ELASTIC, PLASTIC = 1e-9, 3e-3
"""Standard deviation of the components of the strain increment."""
REPEATS = 10
"""The least time counts: others share caches and memory with other processes."""


def cost(name: str, amplitude: float) -> tuple[float, float]:
    """Return ns per point of the law ``name``, and the share of points that yielded."""
    ground = build(Ground, soil_example(name), "ground")
    rng = np.random.default_rng(1)
    start = undisturbed_state(ground, -rng.uniform(2.0, 12.0, POINTS), 1)
    elastic = start.elastic_strain[:, ROW, COLUMN] * SCALE
    trial = elastic + amplitude * rng.normal(size=elastic.shape)
    stress, strain = np.empty_like(trial), np.empty_like(trial)
    state, tangent = np.empty_like(start.state_variables), np.empty((POINTS, 6, 6))
    status = np.empty(POINTS, dtype=np.int64)
    materials, times = dispatch.pack(soils_of(ground)), []
    for _ in range(REPEATS + 1):
        begin = time.process_time()
        dispatch.update_all(
            materials, start.material, trial, start.state_variables, stress, strain, state,
            tangent, status,
        )  # fmt: skip
        times.append(time.process_time() - begin)
    if status.any():
        raise RuntimeError(f"{name}: {np.count_nonzero(status)} points failed")
    yielded = np.abs(strain - trial).max(axis=1) > 1e-15
    return 1e9 * min(times[1:]) / POINTS, float(yielded.mean())


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("laws", nargs="*", metavar="LAW", default=list(TYPICAL))
    print(f"{POINTS} points, one thread, ns per point with tangent")
    print(f"{'law':24} {'elastic':>8} {'yielding':>9} {'share that yields':>18}")
    for name in parser.parse_args().laws or TYPICAL:
        elastic, _ = cost(name, ELASTIC)
        plastic, share = cost(name, PLASTIC)
        print(f"{name:24} {elastic:8.0f} {plastic:9.0f} {share:18.0%}")


if __name__ == "__main__":
    main()
