"""Every command of the README runs, in the order in which it stands there.

The shell blocks are run as one script in a folder that looks like a clone: the same scripts and
environment, and short cases: both walls are replaced by two steps of the quick one, and the screw
pile makes a few steps and carries two programmes.  Left out is ``script/test``, which runs these
tests.
"""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from workflows.cli import app

ROOT = Path(__file__).parents[2]
LEFT_OUT = ("script/test",)
SHORT_INSTALLATION = ('penetration = "0.3 m"', 'penetration = "0.06 m"')
SHORT_ROTATION = ("turns = 1.0\nadv", "turns = 0.02\nadv")
LOOSE = "max_reaction_change = 1.0\nmax_relaxation = 1.0\n"
SHORT_SERVICE = """
[[service.programmes]]
kind = "lateral"
name = "lateral"
displacement = "5 mm"
step = "5 mm"
first_step_halvings = 0
"""


def shell_commands(markdown):
    """The lines of all shell blocks, without those that only a person can run."""
    blocks = re.findall(r"^```bash\n(.*?)^```", markdown, flags=re.DOTALL | re.MULTILINE)
    lines = [line for block in blocks for line in block.splitlines() if line.strip()]
    return [line for line in lines if not line.startswith(LEFT_OUT)]


def short_screw_pile(case):
    """The case of the demo with a few steps of installation, the release and a lateral load.

    The installation is too short for the limits of its certificate.
    """
    assert SHORT_ROTATION[0] in case
    assert "\n[handoff]\n" in case
    case = case.replace("\n[handoff]\n", f"\n[handoff]\n{LOOSE}")
    tables = case.replace(*SHORT_ROTATION).split("\n[[service.programmes]]")
    return "\n[[service.programmes]]".join(tables[:2]) + SHORT_SERVICE


@pytest.fixture
def clone(tmp_path):
    """A folder like a clone that was set up, with short cases."""
    (tmp_path / "script").mkdir()
    for name in ("demo", "environment"):
        shutil.copy2(ROOT / "script" / name, tmp_path / "script" / name)
    bootstrap = tmp_path / "script" / "bootstrap"
    bootstrap.write_text(f"#!/bin/sh\nexec {ROOT}/script/bootstrap\n")
    bootstrap.chmod(0o755)
    (tmp_path / ".venv").symlink_to(ROOT / ".venv")
    (tmp_path / "docs" / "images").mkdir(parents=True)
    shutil.copytree(ROOT / "cases", tmp_path / "cases")
    quick = (ROOT / "cases" / "jacked_pile_clay_quick.toml").read_text(encoding="utf-8")
    assert SHORT_INSTALLATION[0] in quick
    for name in ("jacked_pile_clay", "jacked_pile_clay_quick"):
        (tmp_path / "cases" / f"{name}.toml").write_text(quick.replace(*SHORT_INSTALLATION))
    screw_pile = tmp_path / "cases" / "screwpile_quick.toml"
    screw_pile.write_text(short_screw_pile(screw_pile.read_text(encoding="utf-8")))
    return tmp_path


def test_every_command_of_the_readme_runs(clone):
    commands = shell_commands((ROOT / "README.md").read_text(encoding="utf-8"))
    assert sum(line.startswith("script/demo") for line in commands) == 2
    result = subprocess.run(
        ["bash", "-euxo", "pipefail", "-c", "\n".join(commands)],
        cwd=clone,
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stderr[-3000:] + result.stdout[-2000:]
    for name in ("screwpile", "wall", "quick"):
        directory = clone / "out" / name
        for file in (
            "installed.h5", "handed_off.h5", "certificate.json", "service.h5", "curves.csv",
            "summary.json", "report.html", "wished_in_place/service.h5", "repeated.json",
        ):  # fmt: skip
            assert (directory / file).stat().st_size > 0
    assert (clone / "docs" / "images" / "jacked_pile_clay.png").read_bytes()[1:4] == b"PNG"


def test_the_readme_shows_every_command():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    shown = "\n".join(shell_commands(readme))
    for command in app.registered_commands:
        name = command.name or command.callback.__name__
        assert f"screwpile {name}" in shown
        assert f"| `screwpile {name}" in readme
