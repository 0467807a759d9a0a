"""What several ranks of MPI find together is what one finds."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.dolfinx


def result_of(n_ranks, path):
    """Run ``on_ranks`` in processes of their own, which leave the processor while they wait.

    Their environment is that of no MPI program.
    """
    clean = {k: v for k, v in os.environ.items() if not k.startswith(("PMIX", "OMPI_COMM", "PRTE"))}
    clean["OMPI_MCA_mpi_yield_when_idle"] = "1"
    start = ["mpirun", "-n", str(n_ranks), "--oversubscribe"] if n_ranks > 1 else []
    command = [*start, sys.executable, "-m", "tests.service_fe.on_ranks", str(path)]
    done = subprocess.run(command, cwd=ROOT, env=clean, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    return np.load(path)


def test_two_ranks_equal_one(tmp_path):
    """Loads, motions, stress, displacement, along the pile to 1e-8; the cells are divided."""
    one = result_of(1, tmp_path / "one.npz")
    two = result_of(2, tmp_path / "two.npz")
    assert len(two["own_points"]) == 2
    assert two["own_points"].sum() == one["own_points"][0]
    assert two["own_points"].max() < 0.7 * one["own_points"][0]
    for name in one.files[1:]:
        scale = np.abs(np.nan_to_num(one[name])).max()
        np.testing.assert_allclose(two[name], one[name], rtol=0, atol=1e-8 * scale, err_msg=name)
