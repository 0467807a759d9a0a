"""Loads on a pile that is moved on, over those of the installation: senses, ways, what counts."""

from types import SimpleNamespace

import numpy as np
import pytest

from install_mpm.screw_pile import Helix, ScrewPile
from service_fe.options import Displace, Rotate
from workflows.continuity import continuity_figures, is_moved_on

INSTALLATION = {"penetration_m": 0.3, "crowd_force_N": 40e3, "torque_N m": 8e3}


def screw_case(hand):
    helix = Helix(1.0, 0.33, 0.12, 0.25)
    return SimpleNamespace(pile=ScrewPile(0.5, 1.2, (helix,), 18e3, hand=hand))


def entry(programme, displacement, head_load, force=0.0):
    """A curve that grows in proportion to the way, in ten steps."""
    share = np.linspace(0.0, 1.0, 11)
    load = np.zeros((11, 6))
    load[:, 2] = -force * share
    curve = SimpleNamespace(
        displacement=displacement * share, head_load=head_load * share, load=load
    )
    return SimpleNamespace(programme=programme, curve=curve)


@pytest.mark.parametrize(("hand", "sense"), [("right", -1.0), ("left", 1.0)])
def test_a_pile_that_is_screwed_on_has_torque_and_force(hand, sense):
    """The rim goes 50 mm in 0.1 rad: 0.05 of the diameter."""
    programme = Rotate("on", 0.1 * sense, 0.01, advance=5e-3, start="equilibrated")
    service = SimpleNamespace(programmes=(entry(programme, 0.1 * sense, 8e3 * sense, 20e3),))
    figures = continuity_figures(screw_case(hand), INSTALLATION, service)["on"]
    assert figures == pytest.approx(
        {
            "torque_over_installation_torque_at_0.02_B": 0.4,
            "torque_over_installation_torque_at_0.05_B": 1.0,
            "head_load_over_crowd_force_at_0.02_B": 0.2,
            "head_load_over_crowd_force_at_0.05_B": 0.5,
        }
    )


def test_a_vertical_load_that_is_kept_is_no_answer():
    programme = Rotate("on", -0.05, 0.01, start="equilibrated")
    service = SimpleNamespace(programmes=(entry(programme, -0.05, -8e3),))
    figures = continuity_figures(screw_case("right"), INSTALLATION, service)["on"]
    assert set(figures) == {"torque_over_installation_torque_at_0.02_B"}


def test_what_does_not_go_on_is_left_out():
    back = Rotate("back", 0.1, 0.01, start="equilibrated")
    pull = Displace("pull", -0.1, 0.01, start="equilibrated")
    assert not is_moved_on(Displace("later", 0.1, 0.01))
    assert is_moved_on(Rotate("on", -0.1, 0.01, start="resumed"))
    assert is_moved_on(Displace("on", 0.1, 0.01, start="resumed"))
    assert not is_moved_on(Rotate("tilt", 0.1, 0.01, about="horizontal", start="equilibrated"))
    service = SimpleNamespace(programmes=(entry(back, 0.1, 8e3), entry(pull, -0.1, -8e3)))
    assert continuity_figures(screw_case("right"), INSTALLATION, service) == {}
    still = {"penetration_m": 0.0, "crowd_force_N": 10e3}
    push = SimpleNamespace(
        programmes=(entry(Displace("on", 0.1, 0.01, start="equilibrated"), 0.1, 10e3),)
    )
    assert continuity_figures(screw_case("right"), still, push) == {}
