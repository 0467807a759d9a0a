"""A screw pile installation with friction that is killed and resumed gives the same file."""

import importlib.util
import random
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from install_mpm.constitutive.coulomb_interface import TAN_FRICTION
from install_mpm.state_file import read_installed_state

FOLDER = Path(__file__).parent

specification = importlib.util.spec_from_file_location("interrupted", FOLDER / "interrupted.py")
interrupted = importlib.util.module_from_spec(specification)
specification.loader.exec_module(interrupted)

TINY = """
title = "Screw pile with friction, tiny"

[ground]
unit_weight = "18 kN/m^3"
k0 = 1.0

[ground.soil]
model = "von_mises"
youngs_modulus = "2 MPa"
poissons_ratio = 0.45
undrained_shear_strength = "20 kPa"

[pile]
model = "screw_pile"
shaft_diameter = "0.5 m"
embedment = "1 m"
unit_weight = "18 kN/m^3"

[[pile.helices]]
diameter = "0.8 m"
pitch = "0.4 m"
thickness = "0.16 m"
height = "0.2 m"
turns = 0.75

[interface]
normal_stiffness = "100 MPa/m"
shear_stiffness = "10 MPa/m"
friction_angle = "20 deg"
smoothing_stress = "1 kPa"

[box]
width = "2 m"
depth = "2.2 m"
headroom = "0.3 m"

[background_mesh]
size_at_edges = "0.4 m"
edge_reach = "0.1 m"
size_at_plate = "0.5 m"
size_at_shaft = "0.5 m"
size_far = "1.2 m"
points_per_direction = 1

[installation]
step = "28 mm"
reset_angle = "15 deg"
release = false

[[installation.phases]]
name = "screw in"
turns = 0.05
advancement_ratio = 1.0

[[installation.phases]]
name = "by force"
turns = 0.01
crowd_force = "20 kN"

[[installation.phases]]
name = "rest"
advance = "0 m"
steps = 1

[numerics]
tolerance = 1e-6
checkpoint_every = 1
"""
"""Four steps of four degrees; the mesh is wound back in the second and in the fourth."""

KILLED_IN_A_WINDING = """
import os, signal, sys
import install_mpm.screw_setup as setup

screw = setup.screw

def killed(mesh, advance, angle, reset_angle, zones):
    moved = screw(mesh, advance, angle, reset_angle, zones)
    if reset_angle != 0.0:
        os.kill(os.getpid(), signal.SIGKILL)
    return moved

setup.screw = killed
from workflows.cli import main
main()
"""


@pytest.fixture(scope="module")
def tiny(tmp_path_factory):
    """The case file, the results of an uninterrupted run, and how long that took."""
    folder = tmp_path_factory.mktemp("screw")
    case = folder / "tiny.toml"
    case.write_text(TINY)
    interrupted.wait_for(interrupted.start_install(case, folder / "compiles"))
    duration = interrupted.wait_for(interrupted.start_install(case, folder / "whole"))
    return case, folder / "whole" / "installed.h5", duration


@pytest.mark.dolfinx
def test_killed_while_the_mesh_is_wound_back(tiny, tmp_path):
    case, whole, _ = tiny
    broken = tmp_path / "broken"
    process = subprocess.run(
        [sys.executable, "-c", KILLED_IN_A_WINDING, "install", str(case), "-o", str(broken)],
        capture_output=True,
    )
    assert process.returncode == -signal.SIGKILL, process.stderr.decode()
    assert sorted(path.name for path in broken.glob("*.h5*")) == ["installed.checkpoint.h5"]
    interrupted.wait_for(interrupted.start_install(case, broken, "--resume"))
    assert interrupted.differences(whole, broken / "installed.h5") == []


@pytest.mark.slow
@pytest.mark.dolfinx
def test_killed_at_random_moments(tiny, tmp_path):
    case, whole, duration = tiny
    broken = tmp_path / "broken"
    moments = interrupted.install_with_kills(case, broken, 5, duration, random.Random(7))
    assert len(moments) == 5
    assert interrupted.differences(whole, broken / "installed.h5") == []


@pytest.mark.dolfinx
def test_the_tiny_case_slips_and_winds_back(tiny):
    state = read_installed_state(tiny[1])
    rotation = np.abs(np.degrees(state.history.rotation))
    assert np.flatnonzero(np.diff(np.round(rotation / 15.0))).tolist() == [1]
    history = state.history
    assert np.flatnonzero(np.isfinite(history.winding_stress_change)).tolist() == [2]
    assert 0.0 < history.winding_stress_change[2] < 0.5
    assert history.crowd_force[history.phase == 1][-1] == pytest.approx(20e3, rel=1e-3)
    assert history.penetration[-1] == history.penetration[-2]  # it rests
    traction, touches = state.interface.traction, state.interface.covered > 0.0
    shear = np.linalg.norm(traction[touches, :2], axis=1)
    tan_friction = state.interface.parameters[touches, TAN_FRICTION]
    assert tan_friction.mean() > np.tan(np.radians(20.0))  # that of exact patches
    strength = tan_friction * np.maximum(-traction[touches, 2], 0.0)
    assert (shear <= strength + 1.0).all()  # 1 Pa
    assert np.count_nonzero(shear > 0.999 * strength) > 0.3 * len(shear)
