"""The studies of screw piles: their runs are valid cases, results are kept and tabled."""

import importlib
import json
import sys
from pathlib import Path

import pytest

from workflows.case import case_text, read_case, sections_text
from workflows.directory import INSTALL_KEYS

sys.path.append(str(Path(__file__).parents[2] / "benchmarks"))
study = importlib.import_module("screw_pile_study")
ratios = importlib.import_module("screw_pile_ratios")
beside = importlib.import_module("installed_over_wished")


def test_every_run_is_a_valid_case_that_differs_from_the_others():
    found = study.runs("coarse", 0.5, None)
    texts = [case_text(read_case(study.CASE, overrides)[0]) for *_, overrides in found]
    assert len(set(texts)) == len(found) == len({folder for _, _, folder, _ in found})
    assert {group for group, *_ in found} == set(study.GROUPS)


def test_only_one_run_of_a_group():
    found = study.runs("fine", 1.0, ["volumetric term 0.05 E"])
    assert [value for _, value, *_ in found] == ["fine", "0.05 E"]
    assert set(study.NAMES) > {"step", "step 11 mm"}


@pytest.mark.parametrize("soil", ratios.SOILS)
def test_every_advancement_ratio_is_a_valid_case(soil):
    for ratio in ratios.RATIOS:
        case, _ = read_case(ratios.SOILS[soil], ratios.overrides_of(0.25, ratio))
        (phase,) = case.installation.phases
        assert (phase.turns, phase.advancement_ratio) == (0.25, ratio)
        assert not case.installation.release


@pytest.mark.parametrize("mesh", study.MESHES)
def test_only_some_groups_on_any_mesh(mesh):
    found = study.runs(mesh, 1.0, ["step"])
    assert [(group, value) for group, value, *_ in found] == [("mesh", mesh), ("step", "11 mm")]
    case, _ = read_case(study.CASE, found[1][3])
    assert case.installation.step == pytest.approx(0.011)
    assert case.background_mesh.size_at_edges == float(study.MESHES[mesh][0].split()[0])


def test_a_result_is_not_computed_again_and_must_belong_to_the_study(tmp_path):
    _, _, _, overrides = study.runs("coarse", 0.5, None)[0]
    text = sections_text(read_case(study.CASE, overrides)[0], INSTALL_KEYS)
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


def test_torque_and_force_of_two_soils_are_tabled_and_drawn(tmp_path):
    result = {
        "torque": 8e3, "normal_torque": 3e3, "crowd_force": -10e3, "iterations": 3.0,
        "share_cut": 0.0, "smallest_volume_ratio": 0.99, "largest_volume_ratio": 1.2,
        "rotation_history": [0.0, 45.0, 90.0], "torque_history": [0.0, 7e3, 8e3],
        "crowd_force_history": [0.0, -8e3, -10e3],
    }  # fmt: skip
    rows = [("clay", 0.5, result), ("sand", 1.0, result)]
    assert ratios.table(rows).splitlines()[-1] == (
        "| sand | 1 | 8.00 | 3.00 | -10.0 | 3.0 | 0 % | 0.990 - 1.200 |"
    )
    ratios.draw(rows, tmp_path / "ratios.png")
    assert (tmp_path / "ratios.png").stat().st_size > 10_000


@pytest.mark.parametrize("soil", beside.SOILS)
def test_a_pile_beside_the_wished_one_is_released_and_loaded(soil):
    case = beside.case_of(soil, 0.5, 0.25)
    assert case.installation.release
    assert case.installation.phases[0].advancement_ratio == 0.5
    assert [programme.name for programme in case.service.programmes] == list(beside.PROGRAMMES)
    assert case.comparison is not None


def test_ratios_are_tabled_with_their_range():
    figures = {
        "ratio": {"initial_stiffness": 0.9, "capacity": 1.02, "tangent_capacity": 1.0},
        "ratio_range": {"initial_stiffness": 0.05, "capacity": 0.01, "tangent_capacity": 0.0},
    }
    results = {
        "installation": {"torque_N m": 7.5e3, "crowd_force_N": -23.4e3},
        "service": dict.fromkeys(beside.PROGRAMMES[1:], figures),
    }
    lines = beside.rows_of("clay", 0.5, {"results": results})
    assert lines[1] == "| clay | 0.5 | 7.5 | -23 | uplift | 0.900 ± 0.050 | 1.020 ± 0.010 |"
    assert len(lines) == 3
