"""A deformable screw pile: stiff it is the rigid one, of steel it goes through all stages."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from service_fe.loading import ALONG, TILT
from service_fe.result_file import read_service_result
from workflows import cli
from workflows.case import read_case
from workflows.directory import REPORT, SERVICE, WISHED_SERVICE
from workflows.runner import run_from_case

pytestmark = [pytest.mark.dolfinx, pytest.mark.gmsh]

CASE = Path(__file__).parent / "tiny_screw.toml"
STEEL = 200e9


def pile_of(modulus, contact="interface"):
    return f"service.pile={{youngs_modulus='{modulus:g} Pa', contact='{contact}'}}"


def assert_bends_under_its_load(entry):
    """A lateral load: shear and moment at the head are its own, the largest moment is below."""
    load = entry.curve.load[-1] - entry.curve.load[0]
    shear, moment = (
        (values[-1] - values[0])[:, 0]
        for values in (entry.along.shear_force, entry.along.bending_moment)
    )
    assert 0.0 < shear[-1] < load[ALONG]
    assert moment.min() < -load[TILT]  # tension on the side of the load
    assert abs(moment[0]) < 0.5 * abs(moment.min())  # the tip


@pytest.fixture(scope="module")
def wished_curves(tmp_path_factory):
    """Curves of the rigid pile wished in place, and of one ten times as stiff as steel.

    That is a million times as stiff as the clay.
    """
    curves = []
    for overrides in ((), (pile_of(10.0 * STEEL),)):
        directory = tmp_path_factory.mktemp("stiff") / "results"
        case, _ = read_case(CASE, overrides)
        run_from_case("wished", case, directory)
        result = read_service_result(directory / WISHED_SERVICE)
        curves.append({entry.programme.name: entry.curve for entry in result.programmes})
    return curves


@pytest.mark.slow
@pytest.mark.parametrize("name", ["compression", "uplift", "lateral"])
def test_stiff_pile_is_the_rigid_one(wished_curves, name):
    """Head load, the six loads and the six motions to 1 % of the largest."""
    rigid, stiff = (curves[name] for curves in wished_curves)
    for field in ("head_load", "load", "motion"):
        reference = getattr(rigid, field)
        error = np.abs(getattr(stiff, field) - reference).max()
        assert error < 0.01 * np.abs(reference).max(), field


@pytest.mark.slow
@pytest.mark.parametrize("contact", ["interface", "bonded"])
def test_pile_of_steel_goes_through_all_stages(installed_screw, contact, tmp_path, monkeypatch):
    directory = Path(shutil.copytree(installed_screw, tmp_path / "results"))
    command = ["run", str(CASE), "-o", str(directory), "--set", pile_of(STEEL, contact)]
    monkeypatch.setattr("sys.argv", ["screwpile", *command])
    with pytest.raises(SystemExit) as stopped:
        cli.main()
    assert stopped.value.code == 0
    assert 'id="along-lateral"' in (directory / REPORT).read_text(encoding="utf-8")
    for file in (SERVICE, WISHED_SERVICE):
        entry = read_service_result(directory / file).programme("lateral")
        assert_bends_under_its_load(entry)
        assert np.isfinite(entry.along.reaction).all() == (contact == "interface")
