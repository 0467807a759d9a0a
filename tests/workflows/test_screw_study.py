"""The convergence study of a screw pile: its runs are valid cases, results are kept and tabled."""

import importlib.util
import json
from pathlib import Path

import pytest

from workflows.case import case_text, read_case

SCRIPT = Path(__file__).parents[2] / "benchmarks" / "screw_pile_study.py"

specification = importlib.util.spec_from_file_location("screw_pile_study", SCRIPT)
study = importlib.util.module_from_spec(specification)
specification.loader.exec_module(study)


def test_every_run_is_a_valid_case_that_differs_from_the_others():
    found = study.runs("coarse", 0.5, None)
    texts = [case_text(read_case(study.CASE, overrides)[0]) for *_, overrides in found]
    assert len(set(texts)) == len(found) == len({folder for _, _, folder, _ in found})
    assert {group for group, *_ in found} == set(study.GROUPS)


@pytest.mark.parametrize("mesh", study.MESHES)
def test_only_some_groups_on_any_mesh(mesh):
    found = study.runs(mesh, 1.0, ["step"])
    assert [(group, value) for group, value, *_ in found] == [("mesh", mesh), ("step", "11 mm")]
    case, _ = read_case(study.CASE, found[1][3])
    assert case.installation.step == pytest.approx(0.011)
    assert case.background_mesh.size_at_edges == float(study.MESHES[mesh][0].split()[0])


def test_a_result_is_not_computed_again_and_must_belong_to_the_study(tmp_path):
    _, _, _, overrides = study.runs("coarse", 0.5, None)[0]
    text = case_text(read_case(study.CASE, overrides)[0])
    (tmp_path / study.RESULT).write_text(json.dumps({"case": text, "torque": 1.0}))
    assert study.result_of(tmp_path, overrides)["torque"] == 1.0
    with pytest.raises(SystemExit, match="another study"):
        study.result_of(tmp_path, study.runs("coarse", 0.25, None)[0][3])


def test_the_table_says_how_far_a_run_is_from_the_reference():
    reference = {
        "torque": 8e3, "normal_torque": 3e3, "crowd_force": 10e3, "cells": 2000,
        "iterations": 3.0, "share_cut": 0.0, "deviations": {"rim": 0.01, "shaft": -0.02},
    }  # fmt: skip
    other = reference | {"torque": 7e3, "crowd_force": 11e3, "share_cut": 0.25}
    lines = study.table([("mesh", "coarse", reference), ("step", "11 mm", other)]).splitlines()
    assert (
        lines[2]
        == "| mesh | coarse | 2,000 | 8.00 |  | 3.00 | 10.00 |  | shaft -2.0 % | 3.0 | 0 % |"
    )
    assert lines[3] == (
        "| step | 11 mm | 2,000 | 7.00 | -12.5 % | 3.00 | 11.00 | +10.0 % | shaft -2.0 % "
        "| 3.0 | 25 % |"
    )
