"""Stages under mpirun: what two ranks write is what one writes, and an error ends both."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from handoff.fe_state_file import read_handed_off_state
from service_fe.result_file import read_service_result
from workflows import ranks
from workflows.errors import CaseError
from workflows.runner import run_from_files

pytestmark = pytest.mark.dolfinx

ROOT = Path(__file__).parents[2]

ALONE = """
import sys
from mpi4py import MPI
from workflows import ranks
ranks.PATIENCE = 0.2
if MPI.COMM_WORLD.rank == 1:
    ranks.end_after(ValueError(), "screwpile: no good", 2)
MPI.COMM_WORLD.Barrier()
MPI.COMM_WORLD.Barrier()
"""


def on_two_ranks(*arguments):
    """Run Python on two ranks, in the environment of no MPI program."""
    clean = {k: v for k, v in os.environ.items() if not k.startswith(("PMIX", "OMPI_COMM", "PRTE"))}
    clean["OMPI_MCA_mpi_yield_when_idle"] = "1"
    command = ["mpirun", "-n", "2", "--oversubscribe", sys.executable, *arguments]
    return subprocess.run(command, cwd=ROOT, env=clean, capture_output=True, text=True, timeout=900)


def assert_close(one, two):
    """Compare records field by field to 1e-8 of the largest value."""
    for name, first, second in zip(one._fields, one, two, strict=True):
        scale = np.abs(first).max(initial=0.0)
        np.testing.assert_allclose(second, first, rtol=0, atol=1e-8 * scale, err_msg=name)


@pytest.mark.slow
def test_two_ranks_hand_over_and_serve_as_one_does(results_copy, tmp_path):
    other = Path(shutil.copytree(results_copy, tmp_path / "other"))
    for stage, command in (("hand_off", "handoff"), ("serve", "serve")):
        run_from_files(stage, results_copy)
        done = on_two_ranks("-m", "workflows.cli", command, str(other))
        assert done.returncode == 0, done.stderr
        assert done.stdout.count(f"{stage} ") == 1
    one, two = (
        {name: figure["value"] for name, figure in json.loads(path.read_text()).items()}
        for path in (results_copy / "certificate.json", other / "certificate.json")
    )
    assert two == pytest.approx(one, rel=1e-8, abs=1e-10)
    assert_close(
        *(read_handed_off_state(path / "handed_off.h5").state for path in (results_copy, other))
    )
    served = [read_service_result(path / "service.h5") for path in (results_copy, other)]
    for alone, together in zip(*(result.programmes for result in served), strict=True):
        for name in ("displacement", "head_load", "motion", "load"):
            first, second = getattr(alone.curve, name), getattr(together.curve, name)
            scale = np.abs(first).max()
            np.testing.assert_allclose(second, first, rtol=0, atol=1e-8 * scale, err_msg=name)
        assert_close(alone.state, together.state)


def test_error_of_all_ranks_is_said_once_with_status_2(tmp_path):
    done = on_two_ranks("-m", "workflows.cli", "serve", str(tmp_path / "nothing"))
    assert done.returncode == 2
    assert done.stderr.count("screwpile: ") == 1
    assert "no such directory" in done.stderr


def test_error_of_one_rank_ends_the_other_with_status_2():
    done = on_two_ranks("-c", ALONE)
    assert done.returncode == 2
    assert "screwpile: no good" in done.stderr


def test_stage_for_one_rank_is_refused_on_two(monkeypatch):
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "2")
    with pytest.raises(CaseError, match="`screwpile run` runs on one rank"):
        ranks.check_ranks("run", "screwpile run")
    ranks.check_ranks("serve", "screwpile serve DIR")


def test_first_rank_makes_and_all_have_it(monkeypatch):
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "1")
    assert ranks.on_first(lambda: 3) == 3
