"""Stages under mpirun: what two ranks write is what one writes, and an error ends both."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from handoff.fe_state_file import read_handed_off_state
from service_fe.result_file import read_service_result
from workflows import ranks
from workflows.case import case_text, read_case
from workflows.directory import CASE, HANDED_OFF, SERVICE, WISHED_SERVICE
from workflows.errors import CaseError
from workflows.runner import run_from_case, run_from_files

pytestmark = pytest.mark.dolfinx

ROOT = Path(__file__).parents[2]

STEEL = ("service.pile={youngs_modulus='200 GPa', contact='interface'}",)

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


TIGHT = "service.numerics.tolerance=1e-12"
"""Steps that end at 1e-9 of all loads leave 1e-7 of single stresses and small motions."""


def assert_close(one, two):
    """Compare records field by field to 1e-8 of the largest value; what one has not, none has."""
    for name, first, second in zip(one._fields, one, two, strict=True):
        scale = np.abs(np.nan_to_num(first)).max(initial=0.0)
        np.testing.assert_allclose(second, first, rtol=0, atol=1e-8 * scale, err_msg=name)


def assert_same_certificate(one, two):
    first, second = (
        {name: figure["value"] for name, figure in json.loads(path.read_text()).items()}
        for path in (one / "certificate.json", two / "certificate.json")
    )
    assert second == pytest.approx(first, rel=1e-8, abs=1e-10)


def assert_same_curves(one, two, file):
    """Compare the curves of all programmes."""
    results = [read_service_result(path / file) for path in (one, two)]
    for alone, together in zip(*(result.programmes for result in results), strict=True):
        for name in ("displacement", "head_load", "motion", "load"):
            first, second = getattr(alone.curve, name), getattr(together.curve, name)
            scale = np.abs(first).max()
            np.testing.assert_allclose(second, first, rtol=0, atol=1e-8 * scale, err_msg=name)


def assert_same_service(one, two, file):
    """Compare the curves of all programmes, their last states, and what the pile feels."""
    assert_same_curves(one, two, file)
    results = [read_service_result(path / file) for path in (one, two)]
    for alone, together in zip(*(result.programmes for result in results), strict=True):
        assert_close(alone.state, together.state)
        assert (alone.along is None) == (together.along is None)
        if alone.along is not None:
            assert_close(alone.along, together.along)


def together(stage, command, *arguments):
    """Run a stage on two ranks, which say once that it is done.

    Open MPI gives the ranks a terminal, so progress may stand before it.
    """
    done = on_two_ranks("-m", "workflows.cli", command, *map(str, arguments))
    assert done.returncode == 0, done.stderr
    assert len(re.findall(rf"{stage} .*: [\d.]+ s\b", done.stdout)) == 1


def hand_over_and_serve(one, two, compare=assert_same_service):
    """Hand over and serve in ``one`` on one rank and in ``two`` on two; compare the results."""
    for stage, command in (("hand_off", "handoff"), ("serve", "serve")):
        run_from_files(stage, one)
        together(stage, command, two)
    assert_same_certificate(one, two)
    assert_close(*(read_handed_off_state(path / HANDED_OFF).state for path in (one, two)))
    compare(one, two, SERVICE)


@pytest.mark.slow
def test_two_ranks_hand_over_and_serve_as_one_does(results_copy, tmp_path):
    hand_over_and_serve(results_copy, Path(shutil.copytree(results_copy, tmp_path / "other")))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("overrides", "compare"),
    [((TIGHT,), assert_same_service), (STEEL, assert_same_curves)],
    ids=["rigid", "steel"],
)
def test_two_ranks_take_a_screw_pile_to_the_end_of_service(
    installed_screw, overrides, compare, tmp_path
):
    """Forces in a pile of steel have too much round-off for steps that end at 1e-12."""
    one, two = (Path(shutil.copytree(installed_screw, tmp_path / name)) for name in "ab")
    case, _ = read_case(one / CASE, overrides)
    for directory in (one, two):
        (directory / CASE).write_text(case_text(case), encoding="utf-8")
    hand_over_and_serve(one, two, compare)
    run_from_case("wished", case, one)
    together("wished", "wished", two / CASE, "-o", two)
    compare(one, two, WISHED_SERVICE)


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
