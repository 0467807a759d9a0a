"""The whole line in axisymmetry: forces of a whole round pile, in words and units too."""

import json
from pathlib import Path

import numpy as np
import pytest

from handoff.fe_state_file import read_handed_off_state
from install_mpm.conventions import Kinematics
from install_mpm.state_file import read_installed_state
from workflows.case import read_case
from workflows.errors import CaseError
from workflows.runner import run_case

ROUND = Path(__file__).parents[2] / "cases" / "jacked_pile_round.toml"
SMALL = (
    "background_mesh.size_at_pile=0.25 m",
    "background_mesh.size_far=1.2 m",
    "installation.penetration=0.1 m",
    "handoff.size_at_pile=0.25 m",
    "handoff.size_far=1.2 m",
    "handoff.equilibration_steps=2",
    "service.programmes.compression.step=50 mm",
    "service.programmes.uplift.step=50 mm",
    "service.programmes.push_on.step=25 mm",
)


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    directory = tmp_path_factory.mktemp("round")
    case, _ = read_case(ROUND, SMALL)
    run_case(case, directory)
    return directory


@pytest.mark.dolfinx
def test_certificate_is_within_its_bounds(results):
    figures = json.loads((results / "certificate.json").read_text(encoding="utf-8"))
    assert not [name for name, figure in figures.items() if not figure["is_met"]]
    volume = np.pi * (5.0**2 * 6.0 - 0.5**2 * 2.1)
    assert figures["volume_fe"]["value"] == pytest.approx(volume, rel=0.01)
    assert figures["volume_mpm"]["value"] == pytest.approx(volume, rel=0.01)


@pytest.mark.dolfinx
def test_forces_are_those_of_the_whole_round_pile(results):
    """Adhesion over the circumference; the head load is the reaction less the pile's weight."""
    installed = read_installed_state(results / "installed.h5")
    assert installed.kinematics is Kinematics.AXISYMMETRIC
    history = installed.history
    assert history.residual_history[0, 0] < 1e-10
    assert history.shaft_force[-1] == pytest.approx(2.0 * np.pi * 0.5 * 10e3 * 2.1, rel=0.1)
    weight = np.pi * 0.5**2 * 2.1 * 18e3
    total = history.base_force[-1] + history.shaft_force[-1]
    assert history.crowd_force[-1] == pytest.approx(total - weight, rel=1e-12)
    head_load = float(read_handed_off_state(results / "handed_off.h5").pile.head_load)
    assert head_load == pytest.approx(history.crowd_force[-1], rel=0.05)
    figures = json.loads((results / "summary.json").read_text(encoding="utf-8"))["results"]
    released = figures["service"]["release"]["installed"]["head_load_before_N"]
    assert released == pytest.approx(head_load, rel=1e-9)
    wished = figures["service"]["release"]["wished_in_place"]["head_load_before_N"]
    assert abs(wished) < 1e-6 * weight  # of the soil's unit weight, so it floats


@pytest.mark.dolfinx
def test_report_speaks_of_a_round_pile_and_not_of_metres_run(results):
    page = (results / "report.html").read_text(encoding="utf-8")
    assert "axisymmetric" in page
    assert "A round pile 1.00 m in diameter" in page
    assert "kN/mm" in page
    for words in ("per metre run", "Plane strain", "kN/m per mm", "m³/m"):
        assert words not in page


def test_kinematics_is_one_of_two():
    with pytest.raises(CaseError, match='must be one of "plane_strain", "axisymmetric"'):
        read_case(ROUND, ["kinematics=round"])
    with pytest.raises(CaseError, match="two-dimensional"):
        read_case(ROUND, ["kinematics=three_d"])


def test_plane_strain_is_the_default():
    case, text = read_case(ROUND.with_name("jacked_pile_clay_quick.toml"))
    assert case.kinematics is Kinematics.PLANE_STRAIN
    assert 'kinematics = "plane_strain"' in text
