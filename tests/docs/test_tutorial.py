"""The tutorial is followed as it stands, and what it prints is what its commands print."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SET_UP = "script/bootstrap"
"""What only a person can run."""


def blocks(language):
    """The blocks of code of the page in a language."""
    page = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", page, flags=re.DOTALL | re.MULTILINE)


def numbers(line):
    return [float(text) for text in re.findall(r"\d+\.\d+", line)]


@pytest.mark.dolfinx
def test_the_tutorial_is_followed_and_gives_its_numbers(tmp_path):
    (case,), (shown,) = blocks("toml"), blocks("text")
    (tmp_path / "pile.toml").write_text(case, encoding="utf-8")
    commands = [block for block in blocks("bash") if not block.startswith(SET_UP)]
    (tmp_path / "screwpile").write_text(
        f'#!/bin/sh\nexec {sys.executable} -m workflows.cli "$@"\n', encoding="utf-8"
    )
    (tmp_path / "screwpile").chmod(0o755)
    search = [str(tmp_path), str(Path(sys.executable).parent), os.environ["PATH"]]
    ended = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", "".join(commands)],
        cwd=tmp_path,
        env={**os.environ, "PATH": os.pathsep.join(search), "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr[-3000:] + ended.stdout[-2000:]
    assert ended.stdout.count("up to date") == 8
    assert (tmp_path / "out" / "report.html").stat().st_size > 0
    printed = ended.stdout.splitlines()[-2:]
    for line, expected in zip(printed, shown.splitlines(), strict=True):
        assert line.split(":")[0] == expected.split(":")[0]
        assert numbers(line)[:3] == pytest.approx(numbers(expected)[:3], rel=5e-3)
        assert numbers(line)[3] == pytest.approx(numbers(expected)[3], abs=5e-3)
