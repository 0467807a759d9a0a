"""``screwpile verify --keep``: what is kept, when it is taken in place of a run, and when not."""

import sys

import numpy as np
import pytest

from workflows import cli, sources
from workflows.sources import sources_hash, sources_of
from workflows.verification import registry
from workflows.verification.problem import Outcome, Picture, Problem, Series, relative

CALLS = []


def circle() -> object:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(1.0, 1.0))
    figure.subplots().plot([0.0, 1.0], [0.0, 1.0])
    return figure


def area(*, a: float = 2.0, excess: float = 1.0 / 3.0) -> Outcome:
    """Area of a square, off by excess."""
    CALLS.append(a)
    if excess >= 1.0:
        raise ValueError("excess has to be below 1")
    return Outcome(
        (relative("area", np.float64(a * a * (1.0 + excess)), a * a, 0.5),),
        (Series("error", "h", "e", (1.0, 0.5), (np.float64(1e-2), float("nan"))),),
        ("a remark",),
        ((1e-1, 1e-3, 1e-7),),
        1e-11,
        (Picture("circle", "A circle", circle),),
    )


@pytest.fixture
def with_area(monkeypatch):
    CALLS.clear()
    problem = Problem("TA1", "Area of a square", area, is_quick=True)
    monkeypatch.setattr(registry, "problems", lambda: {"TA1": problem})


def verify(monkeypatch, *arguments):
    monkeypatch.setattr(sys, "argv", ["screwpile", "verify", *map(str, arguments)])
    with pytest.raises(SystemExit) as stopped:
        cli.main()
    return stopped.value.code


def test_page_and_numbers_of_kept_results_are_those_of_the_run(
    with_area, monkeypatch, capsys, tmp_path
):
    written = []
    for _ in range(2):
        assert verify(
            monkeypatch, "--keep", tmp_path / "kept", "--report", tmp_path / "page.md",
            "--json", tmp_path / "numbers.json",
        ) == 0  # fmt: skip
        files = sorted(path for path in tmp_path.rglob("*") if path.is_file())
        written.append({path: path.read_bytes() for path in files})
    assert CALLS == [2.0]
    assert ", kept)" in capsys.readouterr().out
    assert written[0] == written[1]
    assert sum(path.suffix == ".png" for path in written[0]) == 2


def test_other_values_are_another_result(with_area, monkeypatch, tmp_path):
    for value in ("a=3", "a=4", "a=3"):
        assert verify(monkeypatch, "--keep", tmp_path, "--set", value) == 0
    assert CALLS == [3.0, 4.0]


def test_a_problem_that_was_not_solved_runs_again(with_area, monkeypatch, tmp_path):
    for _ in range(2):
        assert verify(monkeypatch, "--keep", tmp_path, "--set", "excess=2") == 1
    assert len(CALLS) == 2
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("text", ["", "{}", '{"checks": 1}', '{"seconds": 1.0, "checks": [[]]}'])
def test_a_damaged_result_is_refused_in_a_sentence(text, with_area, monkeypatch, capsys, tmp_path):
    verify(monkeypatch, "--keep", tmp_path)
    (file,) = tmp_path.iterdir()
    file.write_text(text)
    capsys.readouterr()
    assert verify(monkeypatch, "--keep", tmp_path) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    (line,) = captured.err.splitlines()
    assert f"{file} cannot be read" in line
    assert "delete it" in line


def test_a_file_is_no_folder(with_area, monkeypatch, capsys, tmp_path):
    (tmp_path / "file").touch()
    assert verify(monkeypatch, "--keep", tmp_path / "file") == 2
    assert CALLS == []
    assert "cannot be made a folder" in capsys.readouterr().err


def test_changed_versions_are_another_result(with_area, monkeypatch, tmp_path):
    verify(monkeypatch, "--keep", tmp_path)
    monkeypatch.setattr("workflows.verification_kept.software_versions", lambda: {"numpy": "0.0"})
    verify(monkeypatch, "--keep", tmp_path)
    assert len(CALLS) == 2


# --- the sources of a problem ---------------------------------------------------------------------


def test_sources_are_what_a_problem_imports_and_no_other_problem():
    names = {path.relative_to(sources.ROOT).as_posix()
             for path in sources_of("workflows.verification.annulus")}  # fmt: skip
    assert "workflows/verification/annulus.py" in names
    assert "workflows/verification/references/annulus_torsion.py" in names
    assert "install_mpm/newton.py" in names
    assert "install_mpm/constitutive/neo_hookean.py" in names
    assert "install_mpm/__init__.py" in names
    assert "workflows/verification/cavity.py" not in names


@pytest.fixture
def tree(monkeypatch, tmp_path):
    """A project of two files, the second imported inside a function of the first."""
    package = tmp_path / "workflows"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "one.py").write_text("def f():\n    from workflows import two\n    return two.x\n")
    (package / "two.py").write_text("x = 1\n")
    (package / "three.py").write_text("x = 1\n")
    monkeypatch.setattr(sources, "ROOT", tmp_path)
    sources._imports.cache_clear()
    sources._statements.cache_clear()
    return package


@pytest.mark.parametrize(
    ("file", "text", "is_same"),
    [
        ("two.py", "x = 2\n", False),
        ("two.py", '"""Two."""\n\nx = 1  # one\n', True),
        ("three.py", "x = 2\n", True),
        (
            "one.py",
            'def f():\n    """F."""\n    from workflows import two\n    return two.x\n',
            True,
        ),
        ("one.py", "def f():\n    from workflows import two\n    return -two.x\n", False),
    ],
)
def test_hash_is_of_statements(file, text, is_same, tree):
    before = sources_hash("workflows.one")
    (tree / file).write_text(text)
    sources._statements.cache_clear()
    assert (sources_hash("workflows.one") == before) is is_same
