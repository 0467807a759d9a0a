"""Case files of screw piles: what is read, and what is refused before anything is meshed."""

import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from install_mpm.conventions import Kinematics
from workflows import cli
from workflows.case import case_text, parse_case, read_case
from workflows.errors import CaseError
from workflows.placed import is_end_given
from workflows.screw_case import ScrewCase, check_screw_case
from workflows.stage_table import stage_named, stages_of

CASES = Path(__file__).parents[2] / "cases"
QUICK = CASES / "screwpile_quick.toml"


@pytest.mark.parametrize("path", sorted(CASES.glob("screwpile_*.toml")), ids=lambda p: p.stem)
def test_every_case_is_valid_and_its_text_reads_back(path):
    case, text = read_case(path)
    assert isinstance(case, ScrewCase)
    assert case.kinematics == Kinematics.THREE_D
    assert parse_case(text, "again") == case
    assert case_text(case) == text


def test_a_screw_pile_has_the_stages_of_its_case():
    case, _ = read_case(QUICK)
    assert [stage.name for stage in stages_of(case)] == [
        "install", "hand_off", "serve", "wished", "repeat", "compare", "export", "report"
    ]  # fmt: skip
    unranged = replace(case, comparison=None)
    assert "repeat" not in [stage.name for stage in stages_of(unranged)]
    with pytest.raises(CaseError, match=r"no stage 'repeat' without \[comparison\]"):
        stage_named("repeat", unranged)
    alone = replace(unranged, handoff=None, service=None)
    assert [stage.name for stage in stages_of(alone)] == ["install", "export", "report"]
    with pytest.raises(CaseError, match=r"no stage 'serve' without \[handoff\] and \[service\]"):
        stage_named("serve", alone)
    with pytest.raises(CaseError, match=r"\[service\] is there without \[handoff\]"):
        check_screw_case(replace(case, handoff=None))


REFUSED = {
    "finite elements larger than the plate can hold": (
        ["handoff.size_at_pile='0.5 m'"], "take at most 0.25 m"
    ),
    "programme that starts from nothing": (
        ["service.programmes.lateral.start='push'"], "which is not before it"
    ),
    "plate thinner than the mesh can hold": (
        ["pile.helices=[{diameter='1 m', pitch='0.33 m', thickness='20 mm', height='0.25 m'}]"],
        "cannot hold a plate 0.02 m thick",
    ),
    "surface handed over to finite elements": (
        ["pile.helices=[{diameter='1 m', pitch='0.33 m', thickness='20 mm', height='0.25 m', "
         "plate='surface'}]", "background_mesh.size_at_plate='0.3 m'"],
        "cannot be handed over to finite elements",
    ),
    "rounded edges of a surface": (
        ["pile.helices=[{diameter='1 m', pitch='0.33 m', thickness='20 mm', height='0.25 m', "
         "plate='surface', edges='rounded'}]"],
        'edges is "rounded", but a mesh that holds the plate as a surface has no edges',
    ),
    "tapered surface": (
        ["pile.helices=[{diameter='1 m', pitch='0.33 m', thickness='20 mm', height='0.25 m', "
         "plate='surface', edge_thickness='10 mm'}]"],
        "edge_thickness is 0.01 m, but",
    ),
    "cells wider than a surface": (
        ["pile.helices=[{diameter='1 m', pitch='0.33 m', thickness='20 mm', height='0.25 m', "
         "plate='surface'}]", "background_mesh.size_at_plate='0.5 m'"],
        "size_at_plate 0.5 m is too coarse for a plate that stands out by 0.25 m; take at most "
        "0.4 m",
    ),
    "rounded edges that one facet would cut off": (
        ["pile.helices=[{diameter='1 m', pitch='0.33 m', thickness='0.12 m', height='0.25 m', "
         "edges='rounded'}]"],
        r"size_at_edges 0.2 m cannot hold .* at its rounded edges.; take at most 0.12 m",
    ),
    "second mesh that is the first": (["comparison.size_factor=1.0"], "is no second mesh"),
    "second transfer that is the first": (
        ["handoff.transfer='nearest'"], "comparison.transfer is 'nearest', as handoff.transfer"
    ),
    "second mesh that the plate cannot hold": (
        ["comparison.size_factor=1.5"],
        r"\[comparison\], repeat with finite elements 1.5 times as large: handoff.size_at_pile",
    ),
    "pile deeper than the box": (["box.depth='2.4 m'"], "make box.depth at least"),
    "pitch smaller than the plate": (
        ["pile.helices=[{diameter='1 m', pitch='0.1 m', thickness='0.12 m', height='0.25 m'}]"],
        "pitch 0.1 m is not larger than its thickness",
    ),
    "step beyond the rule at the edges": (["installation.step='0.1 m'"], "take at most"),
    "start above ground": (["pile.embedment='0.5 m'"], "out of the ground; start deeper"),
    "friction without normal stiffness": (["interface.normal_stiffness='0 Pa/m'"], "must be > 0"),
    "plate no wider than the shaft": (["pile.shaft_diameter='1.2 m'"], "is not larger than"),
    "box too narrow": (["box.width='2 m'"], "make it at least 2.5 m"),
    "shaft too coarse": (["background_mesh.size_at_shaft='0.6 m'"], "too coarse for a shaft"),
    "reset angle between the sides": (["installation.reset_angle='20 deg'"], "take a multiple"),
    "phase without a way": (
        ["installation.phases=[{name='in', turns=1.0}]"], "does not say how far the pile goes"
    ),
    "advance and the force that finds it": (
        ["installation.phases=[{name='in', turns=1.0, advance='0.1 m', crowd_force='5 kN'}]"],
        "gives both advance and crowd_force; give one of them",
    ),
    "turns and the torque that finds them": (
        ["installation.phases=[{name='in', turns=1.0, advance='0.1 m', torque='5 kN m'}]"],
        "gives both turns and torque; give one of them",
    ),
    "ratio without turns": (
        ["installation.phases=[{name='in', advancement_ratio=1.0}]"],
        "an advancement_ratio without turns",
    ),
    "no phases": (["installation.phases=[]"], "installation.phases is empty"),
    "pulled out of the ground": (
        ["installation.phases=[{name='up', advance='-0.8 m'}]"], "leaves the ground"
    ),
    "adhesion beside sand": (
        ["ground.soil={model='mohr_coulomb', youngs_modulus='20 MPa', poissons_ratio=0.25, "
         "cohesion='1 kPa', friction_angle='35 deg'}", "ground.k0='jaky'"],
        "has no undrained shear strength",
    ),
    "kinematics of a plane": (["kinematics='plane_strain'"], "leave the key out"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_is_refused_in_one_sentence(name):
    overrides, said = REFUSED[name]
    with pytest.raises(CaseError, match=said) as caught:
        read_case(QUICK, overrides)
    assert "\n" not in str(caught.value)


def test_a_given_crowd_force_is_read_and_forecast(monkeypatch, capsys):
    path = CASES / "screwpile_crowd.toml"
    case, _ = read_case(path)
    screwed, rest = case.installation.phases
    assert screwed.crowd_force == 10e3
    assert screwed.advance is screwed.advancement_ratio is screwed.torque is None
    assert rest.advance == 0.0
    assert not is_end_given(case)
    assert is_end_given(read_case(QUICK)[0])
    monkeypatch.setattr(sys, "argv", ["screwpile", "check", str(path)])
    with pytest.raises(SystemExit) as stopped:
        cli.main()
    assert stopped.value.code == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "Screw pile in clay, given crowd force: the case is valid" in said
    steps = int(np.ceil(2.0 * np.pi * 0.06 * 0.5 / 0.028)) + 1
    assert re.search(rf"load steps\W+{steps}\b", said)


def test_the_wished_pile_waits_for_an_installation_that_finds_its_depth():
    case, _ = read_case(QUICK)
    assert stage_named("wished", case).reads == ()
    phases = (replace(case.installation.phases[0], advancement_ratio=None, crowd_force=10e3),)
    loaded = replace(case, installation=replace(case.installation, phases=phases))
    assert stage_named("wished", loaded).reads == ("installed.h5",)


def test_angles_and_lengths_have_units():
    case, _ = read_case(QUICK, ["installation.reset_angle='45 deg'", "pile.hand='left'"])
    assert case.installation.reset_angle == pytest.approx(np.pi / 4.0)
    assert case.pile.sense == -1.0
