"""``screwpile verify``: what is run with which values, what it writes, and its exit status."""

import json
import re
import sys
from dataclasses import replace
from typing import Annotated, Literal

import numpy as np
import pytest

from install_mpm.conventions import Kinematics, Unit
from workflows import cli
from workflows.errors import CaseError
from workflows.verification import registry
from workflows.verification.parameters import parameters_of, read_assignments
from workflows.verification.problem import (
    Check,
    Outcome,
    Problem,
    Series,
    at_least,
    relative,
    shown,
)
from workflows.verification.runner import newton_statement, run_problem
from workflows.verification_numbers import cells, number_text

PROBLEMS = registry.problems()


def area(
    *,
    a: Annotated[float, Unit("m")] = 2.0,
    p: Annotated[float, Unit("Pa")] = 1e3,
    phi: Annotated[float, Unit("rad")] = 0.5,
    excess: float = 0.25,
    steps: int = 3,
    is_rough: bool = True,
    kinematics: Kinematics = Kinematics.PLANE_STRAIN,
    law: Literal["hencky", "neo-hookean"] = "hencky",
) -> Outcome:
    """Area of a square, off by excess, ``p`` aside.

    Parameters
    ----------
    a
        Side.
    """
    if excess >= 1.0:
        raise ValueError("excess has to be\nbelow 1")
    if steps == 99:
        raise KeyError("no_steps")
    error = Series("error | of [it]", "h", "e", (1.0, 0.5), (1e-2, 2.5e-3), is_logarithmic=True)
    return Outcome(
        (relative("area, m^2", a * a * (1.0 + excess), a * a, 0.3),), (error,), (f"law {law}",)
    )


AREA = Problem("TA1", "Area of a square", area, is_quick=True)


@pytest.fixture
def with_area(monkeypatch):
    """The registry holds the problem TA1 alone."""
    monkeypatch.setattr(registry, "problems", lambda: {"TA1": AREA})


def verify(monkeypatch, *arguments):
    """Run the command in this process; return the exit status."""
    monkeypatch.setattr(sys, "argv", ["screwpile", "verify", *map(str, arguments)])
    with pytest.raises(SystemExit) as stopped:
        cli.main()
    return stopped.value.code


# --- the real problems ----------------------------------------------------------------------------


@pytest.mark.dolfinx
@pytest.mark.gmsh
@pytest.mark.parametrize(
    "name", [name for name, one in PROBLEMS.items() if one.is_quick and one.is_available]
)
def test_quick_problem_is_within_its_tolerance(name):
    result = run_problem(PROBLEMS[name])
    failed = [check for check in result.checks if not check.is_met]
    assert result.is_met, result.failure or failed


@pytest.mark.parametrize("name", PROBLEMS)
def test_every_parameter_has_a_default_of_its_kind(name):
    for parameter in parameters_of(PROBLEMS[name]).values():
        if parameter.kind in (float, int, bool, str):
            assert type(parameter.default) is parameter.kind, parameter
        text = parameter.format(parameter.default)
        if parameter.kind is not float:
            assert read_assignments(PROBLEMS[name], [f"{parameter.name}={text}"])
        else:
            found = read_assignments(PROBLEMS[name], [f"{parameter.name}={text}"])
            assert found[parameter.name] == pytest.approx(parameter.default, rel=1e-4)


@pytest.mark.parametrize("name", PROBLEMS)
def test_every_problem_says_what_it_is(name):
    assert PROBLEMS[name].run.__doc__


def test_list_names_all_problems_with_units_and_defaults(monkeypatch, capsys):
    assert verify(monkeypatch, "--list") == 0
    text = capsys.readouterr().out
    for name, problem in PROBLEMS.items():
        assert re.search(rf"^{name}  {re.escape(problem.title)}", text, flags=re.MULTILINE)
    assert "ks = 1e+07 Pa/m" in text
    assert "phi = 24 deg" in text


def test_problem_without_its_package_is_left_out_or_refused(monkeypatch, capsys):
    missing = replace(AREA, identifier="TA2", needs="no_such_package")
    monkeypatch.setattr(registry, "problems", lambda: {"TA1": AREA, "TA2": missing})
    assert verify(monkeypatch) == 0
    assert "1 of 1 reference problem" in capsys.readouterr().out
    assert verify(monkeypatch, "TA2") == 2
    assert "TA2 needs the package no_such_package" in capsys.readouterr().err


def test_problems_by_name_with_report_and_numbers(monkeypatch, capsys, tmp_path):
    page, numbers = tmp_path / "new" / "page.md", tmp_path / "numbers.json"
    assert verify(monkeypatch, "PA15", "pa11", "--report", page, "--json", numbers) == 0
    assert "2 of 2 reference problems within tolerance" in capsys.readouterr().out
    text = page.read_text(encoding="utf-8")
    links = re.findall(r"\]\(([^)#]+)\)", text)
    assert links == [
        "images/page/pa15.png", "images/page/pa11.png", "images/page/pa11-states.png"
    ]  # fmt: skip
    assert all((page.parent / link).stat().st_size > 1000 for link in links)
    anchors = re.findall(r"\]\(#([^)]+)\)", text)
    assert anchors == re.findall(r'<a id="([^"]+)">', text) == ["pa15", "pa11"]
    document = json.loads(numbers.read_text(encoding="utf-8"))
    assert document["is_met"] is True
    assert [problem["id"] for problem in document["problems"]] == ["PA15", "PA11"]


def test_changed_parameters_move_the_reference_too(monkeypatch, capsys, tmp_path):
    """H = c L + N tan(phi); several values may follow one --set."""
    numbers = tmp_path / "numbers.json"
    status = verify(
        monkeypatch, "PA15", "--json", numbers, "--set", "N=50 kN", "c=0", "--set", "phi=30 deg"
    )
    assert status == 0
    (problem,) = json.loads(numbers.read_text(encoding="utf-8"))["problems"]
    assert problem["inputs"]["N"] == {"value": 50e3, "unit": "N"}
    assert problem["inputs"]["ks"] == {"value": 1e7, "unit": "Pa/m"}
    pull = problem["checks"][0]
    expected = 50e3 * np.tan(np.pi / 6.0)
    assert [pull["computed"], pull["reference"]] == pytest.approx([expected, expected], rel=1e-8)


# --- values from text -----------------------------------------------------------------------------


def test_values_are_read_by_kind_and_unit():
    texts = ["a=25 cm", "p=2.5", "phi=45 deg", "excess=1e-1", "steps=7", "is_rough=no",
             "kinematics=axisymmetric", "law=neo-hookean"]  # fmt: skip
    assert read_assignments(AREA, texts) == {
        "a": 0.25,
        "p": 2.5,
        "phi": pytest.approx(np.pi / 4.0),
        "excess": 0.1,
        "steps": 7,
        "is_rough": False,
        "kinematics": Kinematics.AXISYMMETRIC,
        "law": "neo-hookean",
    }


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("b=2", "TA1 has no parameter 'b'; it has a = 2 m, p = 1000 Pa, phi = 28.6479 deg"),
        ("a=2 kPa", "TA1: a: 'kPa' is a pressure or stress, but a length is needed"),
        ("a=long", "'long' is not a quantity"),
        ("a=nan", "not finite"),
        ("excess=0.3 m", "has no unit"),
        ("steps=2.5", "not a whole number"),
        ("is_rough=maybe", "none of true, yes, on"),
        ("law=linear", "none of hencky, neo-hookean"),
        ("a=0 m", "a: 0 m has no meaning; it has to be above 0 m"),
        ("p=-1 kPa", "p: -1000 Pa has no meaning; it has to be at least 0 Pa"),
        ("phi=95 deg", "has no meaning; it has to be at least 0 rad and below 1.5708 rad"),
        ("steps=0", "steps: 0 has no meaning; it has to be at least 1"),
        ("a=", "write --set key=value"),
        ("a", "write --set key=value"),
    ],
)
def test_unsuitable_values_are_refused_in_a_sentence(text, words):
    with pytest.raises(CaseError, match=re.escape(words)):
        read_assignments(AREA, [text])


# --- the command ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["TA2"], "there is no reference problem 'TA2'; did you mean TA1?"),
        (["zzz"], "`screwpile verify --list`"),
        (["--set", "b=2", "TA1"], "TA1 has no parameter 'b'"),
        (["TA1", "--set", "a=2", "excess=x"], "'x' is not a number"),
    ],
)
def test_bad_input_gives_one_sentence_and_status_2(
    arguments, words, with_area, monkeypatch, capsys, tmp_path
):
    numbers = tmp_path / "numbers.json"
    assert verify(monkeypatch, *arguments, "--json", numbers) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    (line,) = captured.err.splitlines()
    assert words in line
    assert not numbers.exists()


def test_values_need_exactly_one_problem(monkeypatch, capsys):
    for arguments in (["--set", "c=2"], ["PA11", "PA12", "--set", "c=2"]):
        assert verify(monkeypatch, *arguments) == 2
        assert "--set changes one problem; name it" in capsys.readouterr().err


def test_a_file_that_cannot_be_written_is_refused_before_the_run(
    with_area, monkeypatch, capsys, tmp_path
):
    (tmp_path / "file").touch()
    for target in (tmp_path, tmp_path / "file" / "page.md"):
        assert verify(monkeypatch, "TA1", "--report", target) == 2
        assert capsys.readouterr().out == ""


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("excess=0.5", "not met: TA1"),
        ("excess=1", "not solved: excess has to be below 1"),
        ("steps=99", "not solved: KeyError: 'no_steps'"),
    ],
)
def test_status_1_if_a_check_fails_or_a_problem_raises(
    value, words, with_area, monkeypatch, capsys, tmp_path
):
    page, numbers = tmp_path / "page.md", tmp_path / "numbers.json"
    arguments = ["--set", value, "--report", page, "--json", numbers]
    assert verify(monkeypatch, "TA1", *arguments) == 1
    assert words in capsys.readouterr().out
    document = json.loads(numbers.read_text(encoding="utf-8"))
    assert document["is_met"] is False
    assert "**FAILED**" in page.read_text(encoding="utf-8")


def test_the_other_problems_go_on_after_one_that_raises(monkeypatch, capsys):
    def fails() -> Outcome:
        """It fails."""
        raise RuntimeError("no equilibrium")

    both = {"TA0": Problem("TA0", "Fails", fails, is_quick=True), "TA1": AREA}
    monkeypatch.setattr(registry, "problems", lambda: both)
    assert verify(monkeypatch) == 1
    text = capsys.readouterr().out
    assert "TA1  Area of a square: met" in text
    assert "1 of 2 reference problems within tolerance; not met: TA0" in text


def test_quick_leaves_out_the_others(monkeypatch, capsys):
    slow = Problem("TA2", "Slow", area, is_quick=False)
    monkeypatch.setattr(registry, "problems", lambda: {"TA1": AREA, "TA2": slow})
    assert verify(monkeypatch, "--quick") == 0
    assert "1 of 1 reference problem within" in capsys.readouterr().out
    assert verify(monkeypatch, "--quick", "TA2") == 2
    assert "leave out --quick" in capsys.readouterr().err


# --- what is written ------------------------------------------------------------------------------


def test_numbers_for_machines(with_area, monkeypatch, tmp_path):
    numbers = tmp_path / "numbers.json"
    verify(monkeypatch, "--json", numbers)
    document = json.loads(numbers.read_text(encoding="utf-8"))
    assert document.keys() == {"format", "version", "is_met", "problems"}
    (problem,) = document["problems"]
    assert problem.keys() == {
        "id", "title", "case", "is_met", "failure", "seconds", "inputs", "checks", "newton",
        "remarks", "series", "residual_histories",
    }  # fmt: skip
    assert problem["checks"] == [
        {"quantity": "area, m^2", "computed": 5.0, "reference": 4.0, "error": 0.25,
         "tolerance": 0.3, "is_met": True}
    ]  # fmt: skip
    assert problem["inputs"]["kinematics"] == {"value": "plane_strain", "unit": None}
    assert problem["series"][0]["computed"] == [1e-2, 2.5e-3]


def test_a_quantity_without_demand_is_shown_and_fails_nothing():
    row = shown("width, m", 5.0, 4.0)
    assert row.is_met
    assert cells(row) == ("width, m", "5", "4", "+0.25", "none", "shown")


def test_page_is_the_same_each_time_and_old_pictures_go(with_area, monkeypatch, tmp_path):
    page, pictures = tmp_path / "page.md", tmp_path / "images" / "page"
    pictures.mkdir(parents=True)
    (pictures / "old.png").touch()
    verify(monkeypatch, "--report", page)
    first = page.read_bytes(), (pictures / "ta1.png").read_bytes()
    verify(monkeypatch, "--report", page)
    assert (page.read_bytes(), (pictures / "ta1.png").read_bytes()) == first
    assert not (pictures / "old.png").exists()
    text = page.read_text(encoding="utf-8")
    assert "Area of a square, off by excess, `p` aside. (`" in text
    assert "Side." not in text
    assert "| area, m^2 | 5 | 4 | +0.25 | 0.3 | met |" in text
    assert "With a = 2 m, p = 1000 Pa" in text


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (0.0123, "+0.012"), (-2e-5, "-2e-05"), (5.6e-13, "< 1e-12"), (-1e-40, "< 1e-15")],
)
def test_round_off_is_written_by_its_power_of_ten(value, text):
    assert number_text(value, "+.2g", 1e-9) == text


# --- judgement ------------------------------------------------------------------------------------


def outcome_of(*checks, histories=()):
    def run() -> Outcome:
        return Outcome(checks, residual_histories=histories)

    return run_problem(Problem("TA3", "", run, is_quick=True))


def test_a_problem_is_met_if_every_check_is():
    met, missed = Check("", 1.0, 1.0, 0.0, 0.0), Check("", 1.0, 1.0, 2e-3, 1e-3)
    assert outcome_of(met).is_met
    assert not outcome_of(met, missed).is_met
    assert not outcome_of(Check("", np.nan, 1.0, np.nan, 1.0)).is_met
    assert not outcome_of(at_least("order", np.nan, 1.0)).is_met
    assert not outcome_of().is_met


def test_newton_has_to_be_quadratic():
    good, linear = (1e-1, 1e-3, 1e-6), (1e-1, 1e-2, 1e-3)
    check = Check("", 1.0, 1.0, 0.0, 0.0)
    assert not outcome_of(check, histories=(linear,)).is_met
    assert not outcome_of(check, histories=(good, linear, linear)).is_met
    assert outcome_of(check, histories=((1e-1, 1e-3, 1e-7), good[:1])).is_met
    statement = newton_statement([(1e-1, 1e-3, 1e-7), linear, (1e-3,)], 1e-12)
    assert (statement.steps, statement.most_iterations) == (3, 2)
    assert (statement.median_order, statement.smallest_order) == pytest.approx((1.5, 1.0))
    assert statement.quadratic_share == 0.5
    assert "too few" in newton_statement([(1e-3,)], 1e-12).text


def test_newton_without_an_order_has_to_solve_at_once():
    check = Check("", 1.0, 1.0, 0.0, 0.0)
    straight, slow = (1e-1, 1e-13, 1e-14), (1e-13, 1e-13, 1e-13, 1e-14)
    assert outcome_of(check, histories=(straight,)).is_met
    assert not outcome_of(check, histories=(straight, slow)).is_met
    assert "Newton" in outcome_of(check, histories=(straight,)).checks[-1].quantity
    assert len(outcome_of(check).checks) == 1


def test_identifiers_are_unique_and_in_natural_order():
    assert list(PROBLEMS).index("PA15") < list(PROBLEMS).index("PB1")
    keys = sorted(["PA10", "PA2", "PB1", "PB1-FE"], key=registry._natural)
    assert keys == ["PA2", "PA10", "PB1", "PB1-FE"]
