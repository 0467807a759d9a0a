"""A whole run: its files, what is skipped, later stages alone, and no installation at all."""

import csv
import json
from pathlib import Path

import h5py
import meshio
import numpy as np
import pytest
from rich.console import Console

from workflows.case import read_case
from workflows.directory import REPEATS, TIMING
from workflows.progress import Reporter
from workflows.runner import is_up_to_date, run_case, run_from_case, run_from_files
from workflows.stage_table import STAGES, stages_of

pytestmark = pytest.mark.dolfinx

QUICK = Path(__file__).parents[2] / "cases" / "jacked_pile_clay_quick.toml"


def recording_reporter():
    return Reporter(Console(record=True, quiet=False, force_terminal=False, width=200))


def summary_of(directory):
    return json.loads((directory / "summary.json").read_text(encoding="utf-8"))


def stale(directory, *overrides):
    case, _ = read_case(QUICK, overrides)
    return [stage.name for stage in stages_of(case) if not is_up_to_date(stage, case, directory)]


def test_every_promised_file_is_there(quick_results):
    promised = {file for stage in STAGES for file in stage.writes}
    promised |= {"case.toml", "manifest.json", TIMING}
    for name in promised:
        assert (quick_results / name).is_file(), name
    found = {
        path.relative_to(quick_results).as_posix()
        for path in quick_results.rglob("*")
        if path.is_file() and REPEATS not in path.relative_to(quick_results).parts
    }
    assert found == promised  # no checkpoint, nothing partial


def test_summary_holds_results_versions_hashes_timings_and_seeds(quick_results):
    summary = summary_of(quick_results)
    results = summary["results"]
    assert results["installation"]["tip_depth_m"] == pytest.approx(4.3)
    assert results["installation"]["crowd_force_N"] > 0.0
    for name in ("compression", "uplift"):
        ratios = results["service"][name]["ratio"]
        assert set(ratios) == {"initial_stiffness", "capacity", "tangent_capacity"}
        for key in ("installed", "wished_in_place"):
            assert results["service"][name][key]["initial_stiffness_N/m"] > 0.0
    assert "head_load_over_crowd_force_at_0.02_B" in results["continuity"]["push_on"]
    assert results["service"]["release"]["installed"]["head_load_before_N"] > 0.0
    for key in ("versions", "timings_s", "seeds", "files_sha256", "case_sha256", "convergence"):
        assert summary[key]
    assert set(summary["timings_s"]) >= {"install", "hand_off", "serve", "wished"}
    assert summary["convergence"]["installation"]["largest_residual"] <= 1e-6


def test_curves_hold_both_models_with_signs_downward_positive(quick_results):
    with (quick_results / "curves.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    models = {row["model"] for row in rows}
    assert models == {"installed", "wished_in_place"}
    for model in models:
        for programme, sign in (("compression", 1.0), ("uplift", -1.0)):
            curve = [row for row in rows if (row["model"], row["programme"]) == (model, programme)]
            assert float(curve[0]["displacement_m"]) == 0.0
            assert sign * float(curve[-1]["displacement_m"]) == pytest.approx(0.1)
            assert sign * float(curve[-1]["head_load_N"]) > 0.0


def test_views_can_be_read(quick_results):
    points = meshio.read(quick_results / "paraview" / "material_points.vtu")
    with h5py.File(quick_results / "installed.h5") as file:
        position = file["material_points/position"][()]
        stress = file["material_points/kirchhoff_stress"][()]
        ratio = file["material_points/volume_ratio"][()]
    np.testing.assert_array_equal(points.points[:, :2], position)
    assert not points.point_data["hydrostatic_pressure"].any()  # there is no water table
    cauchy = stress / ratio[:, None, None]
    np.testing.assert_allclose(
        points.point_data["cauchy_stress"][:, 3], cauchy[:, 0, 1], rtol=1e-12
    )
    view = meshio.read(quick_results / "paraview" / "service_installed.vtu")
    assert "displacement_compression" in view.point_data
    assert "cauchy_stress_uplift" in view.cell_data


def test_stages_are_skipped_when_nothing_changed(results_copy):
    case, _ = read_case(QUICK)
    before = {path: path.stat().st_mtime_ns for path in results_copy.rglob("*.h5")}
    reporter = recording_reporter()
    run_case(case, results_copy, reporter)
    shown = reporter.console.export_text()
    assert shown.count("up to date") == len(STAGES)
    assert {path: path.stat().st_mtime_ns for path in results_copy.rglob("*.h5")} == before


def test_a_change_makes_exactly_its_stages_stale(quick_results):
    after_service = ["serve", "wished", "repeat", "compare", "export", "report"]
    assert stale(quick_results) == []
    assert stale(quick_results, "pile.half_width=500 mm") == []
    assert stale(quick_results, "service.programmes.uplift.step=10 mm") == after_service
    assert stale(quick_results, "handoff.neighbours=24") == ["hand_off", *after_service]
    assert stale(quick_results, "numerics.max_cuts=5")[0] == "install"
    assert len(stale(quick_results, "ground.k0=0.9")) == len(STAGES)


def test_a_changed_or_missing_file_makes_its_stages_stale(results_copy):
    (results_copy / "certificate.json").write_text("{}", encoding="utf-8")
    assert stale(results_copy)[0] == "hand_off"
    (results_copy / "manifest.json").unlink()
    assert len(stale(results_copy)) == len(STAGES)


def test_a_change_of_the_comparison_repeats_only_what_it_changes(results_copy):
    """A ratio is that of the run, its range the largest deviation of the repeats."""
    before = summary_of(results_copy)["results"]
    kept = (results_copy / "repeated" / "transfer" / "service.h5").stat().st_mtime_ns
    case, _ = read_case(QUICK, ["comparison.size_factor=1.25"])
    run_case(case, results_copy, recording_reporter())
    results = summary_of(results_copy)["results"]
    assert (results_copy / "repeated" / "transfer" / "service.h5").stat().st_mtime_ns == kept
    assert results["repeats"]["mesh"]["what"] == "finite elements 1.25 times as large"
    assert results["repeats"]["transfer"] == before["repeats"]["transfer"]
    assert set(results["repeats"]["mesh"]["continuity"]) == {"push_on"}
    for name in ("compression", "uplift"):
        ratio = results["service"][name]["ratio"]["capacity"]
        others = [repeat["ratio"][name]["capacity"] for repeat in results["repeats"].values()]
        assert ratio == before["service"][name]["ratio"]["capacity"]
        assert len({ratio, *others}) == 3
        deviation = results["service"][name]["ratio_range"]["capacity"]
        assert deviation == max(abs(other - ratio) for other in others)


def test_later_stages_alone_give_the_same_figures(quick_results, results_copy):
    for stage in STAGES[1:]:
        for name in stage.writes:
            (results_copy / name).unlink()
    case, _ = read_case(QUICK)
    run_from_files("hand_off", results_copy)
    run_from_files("serve", results_copy)
    run_from_case("wished", case, results_copy)
    for name in ("repeat", "compare"):
        run_from_files(name, results_copy)
    first, second = summary_of(quick_results), summary_of(results_copy)
    for summary in (first, second):
        del summary["timings_s"]
    assert first == second


def test_a_stage_needs_nothing_but_the_file_before_it(quick_results, tmp_path):
    directory = tmp_path / "only_installed"
    directory.mkdir()
    (directory / "installed.h5").write_bytes((quick_results / "installed.h5").read_bytes())
    run_from_files("hand_off", directory)
    assert (directory / "handed_off.h5").read_bytes() == (
        quick_results / "handed_off.h5"
    ).read_bytes()


def test_without_installation_both_models_have_the_same_curves(tmp_path):
    case, _ = read_case(QUICK, ["installation.penetration=0 m"])
    for name in ("install", "wished"):
        run_from_case(name, case, tmp_path)
    for name in ("hand_off", "serve", "repeat", "compare"):
        run_from_files(name, tmp_path)
    curves = {}
    with (tmp_path / "curves.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            curves.setdefault(row["model"], []).append(
                (float(row["displacement_m"]), float(row["head_load_N"]))
            )
    installed, wished = (np.array(curves[model]) for model in ("installed", "wished_in_place"))
    largest = np.abs(wished).max(axis=0)
    assert largest[1] > 1e5
    assert np.abs(installed - wished).max(axis=0)[1] <= 1e-6 * largest[1]
    assert np.abs(installed - wished).max(axis=0)[0] <= 1e-6 * largest[0]
    results = summary_of(tmp_path)["results"]
    assert results["continuity"] == {}
    for name in ("compression", "uplift"):
        for figure, ratio in results["service"][name]["ratio"].items():
            deviation = results["service"][name]["ratio_range"][figure]
            assert (ratio, deviation) == (None, None) or (
                abs(ratio - 1.0) <= 1e-6 and deviation <= 1e-6
            )
