"""A screw pile that is moved on in the finite elements takes up the loads of its installation.

Turning on is the motion of the installation, advance and rotation together, and begins where the
rig stopped: when it let go, the pile rose by a few mm, which turning on at the pitch does not give
back, neither here nor in the installation itself (docs/service.md).  Pushing on is asked of a pile
whose installation ends with a push.
"""

import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from install_mpm.screw_history import ScrewHistory
from service_fe.options import Rotate
from workflows.case import case_text, parse_case
from workflows.compare import installation_figures
from workflows.continuity import continuity_figures
from workflows.runner import run_from_case, run_from_files
from workflows.screw_continuity import continuity, continuity_table
from workflows.state_files import read_checked

QUICK = Path(__file__).parents[2] / "cases" / "screwpile_quick.toml"

SERVICE = """[service]
[[service.programmes]]
kind = "resume"

[[service.programmes]]
start = "resumed"
name = "on"
first_step_halvings = 2
"""
INSTALLATIONS = {
    "screwed": (
        "installation.phases=[{name='screw', turns=0.25, advancement_ratio=1.0}]",
        'kind = "rotate"\nrotation = "-6 deg"\nadvance = "5.5 mm"\nstep = "1.2 deg"\n',
    ),
    "pushed": (
        "installation.phases=[{name='push', advance='100 mm'}]",
        'kind = "displace"\ndisplacement = "50 mm"\nstep = "10 mm"\n',
    ),
}
"""The way of the pile, and the same way on in the finite elements.

The crowd force of the installation grows by 2 % over such a way, after a tenth of a turn by 8 %.
"""

STEP = "11 mm"
"""Of the installation: what its volumetric term resists falls with the step."""

SIZES = ("0.2 m", "0.14 m")
"""Of the finite elements at the plate, on two meshes."""


def case_of(name, size):
    way, on = INSTALLATIONS[name]
    text = QUICK.read_text(encoding="utf-8").split("[comparison]")[0] + SERVICE + on
    changed = [way, f"installation.step='{STEP}'", f"handoff.size_at_pile='{size}'"]
    return parse_case(text, "quick case", changed)


@pytest.mark.slow
@pytest.mark.dolfinx
@pytest.mark.parametrize("name", INSTALLATIONS)
def test_loads_of_the_installation_come_back(name, tmp_path):
    """Within 10 % on the finer of two meshes, when the pile has gone on by 0.05 of its width."""
    errors = []
    for number, size in enumerate(SIZES):
        case, directory = case_of(name, size), tmp_path / str(number)
        if number == 0:
            run_from_case("install", case, directory)
        else:
            directory.mkdir()
            (directory / "case.toml").write_text(case_text(case), encoding="utf-8")
            shutil.copy2(tmp_path / "0" / "installed.h5", directory)
        run_from_files("hand_off", directory)
        run_from_files("serve", directory, accept_uncertified=True)
        installation = installation_figures(read_checked(directory, "installed.h5", case))
        service = read_checked(directory, "service.h5", case)
        figures = continuity_figures(case, installation, service)["on"]
        errors.append([value - 1.0 for key, value in figures.items() if key.endswith("0.05_B")])
    assert len(errors[-1]) == (2 if name == "screwed" else 1)
    assert np.abs(errors[-1]).max() <= 0.1


def test_picture_and_table_show_torque_and_force():
    """The rim goes 50 mm in 0.1 rad; the installation is driven by steps of 0.1 rad as well."""
    case = case_of("screwed", SIZES[0])
    steps = 4
    fields = dict.fromkeys(ScrewHistory._fields, np.zeros(steps))
    fields |= {
        "rotation": -0.1 * np.arange(steps),
        "torque": np.full(steps, 8e3),
        "crowd_force": np.full(steps, 40e3),
    }
    installed = SimpleNamespace(history=ScrewHistory(**fields))
    share = np.linspace(0.0, 1.0, 6)
    load = np.zeros((6, 6))
    load[:, 2] = -38e3 * share
    curve = SimpleNamespace(displacement=-0.1 * share, head_load=-7.6e3 * share, load=load)
    programme = Rotate("on", -0.1, 0.02, advance=5.5e-3, start="resumed")
    service = SimpleNamespace(programmes=(SimpleNamespace(programme=programme, curve=curve),))
    torque, force = continuity(case, installed, service).axes
    np.testing.assert_allclose(torque.lines[0].get_xdata(), [-150.0, -100.0, -50.0, 0.0])
    for axes, last in ((torque, 7.6), (force, 38.0)):
        way, loads = axes.lines[1].get_data()
        np.testing.assert_allclose((way[-1], loads[-1]), (50.0, last))

    installation = {"penetration_m": 0.3, "crowd_force_N": 40e3, "torque_N m": 8e3}
    figures = continuity_figures(case, installation, service)
    html = continuity_table({"continuity": figures})
    assert html.count("0.950") == 2
    assert "torque over installation torque at 0.05 B" in html
