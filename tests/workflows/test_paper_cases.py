"""Cases of the paper's demonstrations: read like other cases, run by one command, drawn."""

import re
import sys
from pathlib import Path

import pytest

from workflows import cli
from workflows.errors import CaseError
from workflows.verification.paper_figures import cases, write_pictures
from workflows.verification.parameters import parameters_of
from workflows.verification.runner import run_problem
from workflows.verification_case import read_problem_case

FOLDER = Path(__file__).parents[2] / "cases" / "paper"
FIG9 = (FOLDER / "fig9.toml").read_text(encoding="utf-8")


def verify(monkeypatch, *arguments):
    monkeypatch.setattr(sys, "argv", ["screwpile", "verify", *map(str, arguments)])
    with pytest.raises(SystemExit) as stopped:
        cli.main()
    return stopped.value.code


def test_each_figure_has_a_case_that_names_every_parameter():
    found = {run.name: run for run in cases(FOLDER)}
    assert set(found) == {
        "fig3", "fig4_7_hencky", "fig4_7_neo_hookean", "fig6", "fig6_default", "fig8", "fig9",
        "fig9_normal_stress", "friction",
    }  # fmt: skip
    for run in found.values():
        assert set(run.values) == set(parameters_of(run.problem)), run.name


def test_values_of_the_paper_are_the_defaults_of_the_problems():
    """The tables of the prototype and the statements of the page are for these values."""
    for run in cases(FOLDER):
        for name, parameter in parameters_of(run.problem).items():
            assert run.values[name] == pytest.approx(parameter.default, rel=2e-6), (run.name, name)
    (fig8,) = (run for run in cases(FOLDER) if run.name == "fig8")
    assert (fig8.values["kn"], fig8.values["ks_small"]) == (1e8, 1e1)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('c = "1e-4 kPa"', "c = 0.1", "parameters.c: 0.1 has no unit"),
        ('c = "1e-4 kPa"', 'c = "1 m"', "'m' is a length, but a pressure or stress is needed"),
        ('c = "1e-4 kPa"', 'cc = "1 kPa"', "parameters.cc is not a known key; did you mean"),
        ('problem = "PA11"', 'problem = "PA111"', "did you mean PA11"),
        ('problem = "PA11"', "problem = 11", "problem is missing or no text"),
        ('title = "', 'titel = "', 'titel is not a known key; did you mean "title"?'),
        ("[parameters]", "[parameters", "not valid TOML"),
    ],
)
def test_bad_cases_are_refused_in_a_sentence(old, new, words, tmp_path, monkeypatch, capsys):
    path = tmp_path / "case.toml"
    assert old in FIG9
    path.write_text(FIG9.replace(old, new), encoding="utf-8")
    with pytest.raises(CaseError, match=re.escape(words)):
        read_problem_case(path)
    assert verify(monkeypatch, path) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line


def test_one_command_runs_a_case_and_draws_its_figure(tmp_path, monkeypatch, capsys):
    page = tmp_path / "page.md"
    assert verify(monkeypatch, FOLDER / "fig9.toml", "--report", page) == 0
    assert "fig9  Figure 9: two blocks: met" in capsys.readouterr().out
    assert "images/page/fig9-states.png" in page.read_text(encoding="utf-8")
    assert (tmp_path / "images" / "page" / "fig9-states.png").stat().st_size > 5000


def test_values_of_a_case_can_be_changed(tmp_path, monkeypatch, capsys):
    assert verify(monkeypatch, FOLDER / "fig9.toml", "--set", "c=2 Pa", "E=20 kPa") == 0
    assert "E = 20000 Pa" in capsys.readouterr().out


def test_missing_file_is_refused(monkeypatch, capsys):
    assert verify(monkeypatch, "no_such.toml") == 2
    assert "no such file" in capsys.readouterr().err


@pytest.mark.gmsh
@pytest.mark.parametrize(
    ("name", "quicker", "pictures"),
    [
        ("fig3", {}, {"fig3.png", "fig3-states.png"}),
        ("fig6", {"penetration": 0.1, "h": 1.0}, {"fig6.png", "fig6-states.png"}),
        ("fig6_default", {"penetration": 0.1, "h": 1.0}, {"fig6_default-states.png",
                                                          "fig6_default.png"}),
    ],
)  # fmt: skip
def test_pictures_are_drawn(name, quicker, pictures, tmp_path):
    (run,) = (run for run in cases(FOLDER) if run.name == name)
    result = run_problem(run.problem, {**run.values, **quicker})
    assert result.is_met, (result.failure, result.checks)
    files = write_pictures(name, result, tmp_path)
    assert {path.name for path in files} == pictures
    assert all(path.stat().st_size > 5000 for path in files)
