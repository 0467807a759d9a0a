"""Results of the quick case and a tiny screw pile, computed once for all tests of this folder."""

import shutil
from pathlib import Path

import pytest

from workflows.case import read_case
from workflows.runner import run_case, run_from_case

QUICK = Path(__file__).parents[2] / "cases" / "jacked_pile_clay_quick.toml"
TINY_SCREW = Path(__file__).parent / "tiny_screw.toml"


@pytest.fixture(scope="session")
def quick_results(tmp_path_factory):
    """The finished run of the quick case; not to be changed."""
    directory = tmp_path_factory.mktemp("quick") / "results"
    case, _ = read_case(QUICK)
    run_case(case, directory)
    return directory


@pytest.fixture
def results_copy(quick_results, tmp_path):
    """A copy of the finished run that a test may change."""
    return Path(shutil.copytree(quick_results, tmp_path / "results"))


@pytest.fixture(scope="session")
def installed_screw(tmp_path_factory):
    """The tiny screw pile, installed; not to be changed."""
    directory = tmp_path_factory.mktemp("screw") / "results"
    case, _ = read_case(TINY_SCREW)
    run_from_case("install", case, directory)
    return directory
