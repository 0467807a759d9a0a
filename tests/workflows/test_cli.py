"""Command line: wrong input gives one sentence and status 2, no traceback, and writes nothing."""

import hashlib
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from install_mpm.seal import seal
from workflows import cli
from workflows.directory import REPORT, SERVICE, WISHED_SERVICE

CASES = Path(__file__).parents[2] / "cases"
QUICK = CASES / "jacked_pile_clay_quick.toml"


def screwpile(monkeypatch, *arguments):
    """Run the command line in this process; return the exit status."""
    monkeypatch.setattr(sys, "argv", ["screwpile", *map(str, arguments)])
    with pytest.raises(SystemExit) as stopped:
        cli.main()
    return stopped.value.code


def content(directory):
    """Return the hash of every file below ``directory``."""
    return {
        path.relative_to(directory): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in directory.rglob("*")
        if path.is_file()
    }


def assert_refused(monkeypatch, capsys, words, *arguments):
    """Assert status 2 and one sentence that holds ``words``."""
    assert screwpile(monkeypatch, *arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    (line,) = captured.err.splitlines()
    assert line.startswith("screwpile: ")
    assert words in line
    assert "Traceback" not in line


MALFORMED = {
    "misspelt key": ('embedment = "4 m"', 'embedmnet = "4 m"', 'did you mean "embedment"?'),
    "no unit": ('embedment = "4 m"', "embedment = 4", 'e.g. "4 m"'),
    "wrong dimension": ('embedment = "4 m"', 'embedment = "4 kPa"', "but a length is needed"),
    "out of range": ("poissons_ratio = 0.49", "poissons_ratio = 0.5", ">= 0 and < 0.5"),
    "unknown soil": ('model = "von_mises"', 'model = "mohr"', "use one of hencky_elastic"),
    "pile wider than the box": ('half_width = "0.5 m"', 'half_width = "7 m"', "box wider"),
    "deeper than the box": ('penetration = "0.3 m"', 'penetration = "6 m"', "make box.depth at"),
    "element larger than the pile": (
        'size_at_pile = "0.25 m"',
        'size_at_pile = "1.2 m"',
        "larger than half the pile width",
    ),
    "step larger than half a cell": ('step = "30 mm"', 'step = "0.2 m"', "half the smallest cell"),
    "missing section": ("[box]", "[service.box]", "box is missing"),
    "unknown start": ('start = "equilibrated"', 'start = "then"', "which is not before it"),
    "broken TOML": ("[box]", "[box", "not valid TOML"),
}


@pytest.mark.parametrize("name", MALFORMED)
@pytest.mark.parametrize("command", ["run", "install", "wished", "check"])
def test_malformed_cases_are_refused_before_anything_runs(
    name, command, tmp_path, monkeypatch, capsys
):
    right, wrong, words = MALFORMED[name]
    text = QUICK.read_text(encoding="utf-8")
    assert right in text
    (tmp_path / "case.toml").write_text(text.replace(right, wrong, 1), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    options = [] if command == "check" else ["-o", "out"]
    assert_refused(monkeypatch, capsys, words, command, "case.toml", *options)
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]


def truncate(path):
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def wrong_version(path):
    with h5py.File(path, "r+") as file:
        file.attrs["version"] = 99
    seal(path)


def missing_dataset(path):
    with h5py.File(path, "r+") as file:
        del file["material_points/mass"]
    seal(path)


def nan_stress(path):
    with h5py.File(path, "r+") as file:
        file["material_points/kirchhoff_stress"][3, 1, 1] = np.nan
    seal(path)


def other_case(path):
    """Exchange the case for one with another soil, as in a file copied from another directory."""
    from install_mpm.state_file import case_hash

    with h5py.File(path, "r+") as file:
        text = file["case"].attrs["toml"].replace('"20000 Pa"', '"30000 Pa"')
        file["case"].attrs["toml"] = text
        file.attrs["case_sha256"] = case_hash(text)
    seal(path)


DAMAGES = {
    truncate: "truncated or not an HDF5 file",
    wrong_version: "version 99",
    missing_dataset: "/material_points/mass is missing",
    nan_stress: "/material_points/kirchhoff_stress holds 1 values that are not finite",
    other_case: "belongs to another case ([ground] differs)",
}


@pytest.mark.dolfinx
@pytest.mark.parametrize("damage", DAMAGES, ids=lambda damage: damage.__name__)
@pytest.mark.parametrize("command", ["handoff", "compare", "run"])
def test_damaged_state_files_are_refused_and_nothing_is_overwritten(
    damage, command, results_copy, monkeypatch, capsys
):
    damage(results_copy / "installed.h5")
    before = content(results_copy)
    arguments = [QUICK, "-o", results_copy] if command == "run" else [results_copy]
    assert_refused(monkeypatch, capsys, DAMAGES[damage], command, *arguments)
    assert content(results_copy) == before


@pytest.mark.dolfinx
@pytest.mark.parametrize(
    ("missing", "command", "words"),
    [
        ("installed.h5", "handoff", "run `screwpile install CASE` first"),
        ("handed_off.h5", "serve", "run `screwpile handoff DIR` first"),
        ("certificate.json", "compare", "run `screwpile handoff DIR` first"),
        ("repeated.json", "compare", "run `screwpile repeat DIR` first"),
        ("wished_in_place/service.h5", "export", "run `screwpile wished CASE` first"),
    ],
)
def test_missing_files_are_named_with_the_command_that_writes_them(
    missing, command, words, results_copy, monkeypatch, capsys
):
    (results_copy / missing).unlink()
    assert_refused(monkeypatch, capsys, words, command, results_copy)


@pytest.mark.dolfinx
def test_a_failed_certificate_stops_the_run_unless_accepted(results_copy, monkeypatch, capsys):
    strict = ("--set", "handoff.max_synthetic_error=1e-6")
    run = ("run", QUICK, "-o", results_copy, *strict)
    before = content(results_copy)
    assert screwpile(monkeypatch, *run) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "handed_off.h5: the hand-over is not certified: synthetic_error is " in line
    assert "(limit 1e-06), synthetic_error_near_pile is " in line
    assert line.endswith("or go on with --accept-uncertified")
    for name in (SERVICE, WISHED_SERVICE, REPORT):
        assert content(results_copy)[Path(name)] == before[Path(name)]
    assert_refused(monkeypatch, capsys, "is not certified", "serve", results_copy)

    assert screwpile(monkeypatch, *run, "--accept-uncertified") == 0
    assert "not certified, and accepted: synthetic_error is" in capsys.readouterr().out
    page = (results_copy / REPORT).read_text(encoding="utf-8")
    assert 'class="warning"><strong class="fail">Not certified.</strong>' in page
    assert screwpile(monkeypatch, *run) == 2  # also when all stages are up to date


@pytest.mark.dolfinx
def test_a_directory_of_another_case_is_refused(results_copy, monkeypatch, capsys):
    before = content(results_copy)
    main_case = CASES / "jacked_pile_clay.toml"
    words = "holds the results of another case, 'Pile jacked into clay (quick)'"
    for command in ("run", "install", "wished"):
        assert_refused(monkeypatch, capsys, words, command, main_case, "-o", results_copy)
    assert content(results_copy) == before


@pytest.mark.dolfinx
def test_a_checkpoint_of_another_case_is_refused(quick_results, tmp_path, monkeypatch, capsys):
    directory = tmp_path / "out"
    directory.mkdir()
    checkpoint = directory / "installed.checkpoint.h5"
    shutil.copy(quick_results / "installed.h5", checkpoint)
    other_case(checkpoint)
    arguments = ["install", QUICK, "-o", directory, "--resume"]
    assert_refused(monkeypatch, capsys, "belongs to another case", *arguments)
    assert not (directory / "installed.h5").exists()


def test_a_directory_that_is_a_file_or_missing_is_refused(tmp_path, monkeypatch, capsys):
    (tmp_path / "file").touch()
    assert_refused(monkeypatch, capsys, "is a file", "run", QUICK, "-o", tmp_path / "file")
    assert_refused(monkeypatch, capsys, "no such directory", "serve", tmp_path / "nowhere")


@pytest.mark.dolfinx
@pytest.mark.parametrize("name", ["case.toml", "manifest.json", "certificate.json"])
def test_a_damaged_text_file_is_named(name, results_copy, monkeypatch, capsys):
    (results_copy / name).write_text("{", encoding="utf-8")
    before = content(results_copy)
    assert_refused(monkeypatch, capsys, f"{results_copy / name}", "compare", results_copy)
    assert content(results_copy) == before


@pytest.mark.gmsh
def test_check_prints_a_forecast(monkeypatch, capsys):
    assert screwpile(monkeypatch, "check", QUICK) == 0
    shown = capsys.readouterr().out
    for words in (
        "nodes",
        "cells",
        "material points",
        "degrees of freedom",
        "memory about",
        "time",
    ):
        assert words in shown


def test_template_is_printed(monkeypatch, capsys, tmp_path):
    assert screwpile(monkeypatch, "template") == 0
    path = tmp_path / "case.toml"
    path.write_text(capsys.readouterr().out, encoding="utf-8")
    from workflows.case import read_case

    case, _ = read_case(path)
    assert case.title == "Pile jacked into clay"


def test_every_command_has_help():
    shown = subprocess.run(
        [sys.executable, "-m", "workflows.cli", "--help"],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    for command in (
        "run",
        "install",
        "handoff",
        "serve",
        "wished",
        "repeat",
        "compare",
        "report",
        "check",
        "verify",
    ):
        assert f" {command} " in shown


@pytest.mark.parametrize(
    "stage", ["install", "hand_off", "serve", "wished", "repeat", "compare", "export"]
)
def test_every_stage_is_a_script_of_its_own(stage):
    command = [sys.executable, "-m", f"workflows.stages.{stage}", "nothing"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 2
    assert ended.stderr.startswith("screwpile: nothing: no such")
    assert len(ended.stderr.splitlines()) == 1


def test_an_unexpected_error_keeps_its_traceback(monkeypatch):
    def fail(*_arguments):
        raise ZeroDivisionError

    monkeypatch.setattr("workflows.case.read_case", fail)
    monkeypatch.setattr(sys, "argv", ["screwpile", "check", str(QUICK)])
    with pytest.raises(ZeroDivisionError):
        cli.main()


@pytest.mark.parametrize("has_checkpoint", [True, False])
def test_interrupted_installation_says_that_it_can_go_on(
    has_checkpoint, tmp_path, monkeypatch, capsys
):
    def interrupted(*_arguments, **_options):
        if has_checkpoint:
            (tmp_path / "installed.checkpoint.h5").touch()
        raise KeyboardInterrupt

    monkeypatch.setattr("workflows.runner.run_case", interrupted)
    assert screwpile(monkeypatch, "run", QUICK, "-o", tmp_path) == 130
    errors = capsys.readouterr().err
    assert ("--resume" in errors) == has_checkpoint
    assert "screwpile: stopped" in errors


def test_interrupted_verification_says_nothing_of_installations(monkeypatch, capsys):
    def interrupted(*_arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr("workflows.verification_console.verify_problems", interrupted)
    assert screwpile(monkeypatch, "verify", "PA11") == 130
    errors = capsys.readouterr().err
    assert "screwpile: stopped" in errors
    assert "resume" not in errors
