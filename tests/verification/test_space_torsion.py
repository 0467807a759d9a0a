"""Torsion, shafts, a disc and a helix in space.

Claimed: torque and force are those of the closed forms to their tolerance, for other sizes and
strengths as well, and Newton's method converges quadratically.
"""

import numpy as np
import pytest

from install_mpm.newton import convergence_order
from workflows.verification.annulus_slab import (
    hencky_torsion,
    neo_hookean_torsion,
    small_torsion,
)
from workflows.verification.rotating_shaft import (
    advancing_shaft,
    disc_in_clay,
    shaft_in_clay,
    shaft_in_sand,
)
from workflows.verification.thin_helix import thin_helix

FEW = {"turned": np.radians(5.0)}


def assert_met(outcome):
    assert all(check.is_met for check in outcome.checks), outcome.checks


@pytest.mark.parametrize("parameters", [{}, {"a": 2.0, "b": 3.0, "E": 1e6, "nu": 0.3}])
def test_small_torsion(parameters):
    assert_met(small_torsion(**parameters))


@pytest.mark.parametrize("parameters", [{}, {"nu": 0.3, "b": 3.0}])
def test_hencky_torsion(parameters):
    outcome = hencky_torsion(**parameters)
    assert_met(outcome)
    orders = [convergence_order(np.array(history)) for history in outcome.residual_histories]
    assert np.median(orders) > 1.7


@pytest.mark.slow
@pytest.mark.parametrize("parameters", [{}, {"nu": 0.3}])
def test_neo_hookean_torsion(parameters):
    assert_met(neo_hookean_torsion(**parameters))


@pytest.mark.parametrize("parameters", [{}, {"a": 0.5, "L": 0.4, "su": 40e3}])
def test_shaft_in_clay(parameters):
    outcome = shaft_in_clay(**FEW, **parameters)
    assert_met(outcome)
    orders = [convergence_order(np.array(history)) for history in outcome.residual_histories]
    assert np.median(orders) > 1.8  # the traction turns with the soil, in the tangent as well


@pytest.mark.parametrize("parameters", [{}, {"R": 1.0, "t": 0.3, "su": 40e3}])
def test_disc_in_clay(parameters):
    assert_met(disc_in_clay(**FEW, **parameters))


@pytest.mark.parametrize(
    "parameters", [{}, {"a": 0.4, "p0": 50e3, "phi": np.radians(40.0), "delta": np.radians(18.0)}]
)
def test_shaft_in_sand(parameters):
    turned = {"turned": np.radians(20.0), "turned_wrong": np.radians(10.0)}
    assert_met(shaft_in_sand(**turned, **parameters))


@pytest.mark.parametrize("parameters", [{}, {"a": 0.25, "p": 0.3, "su": 30e3, "alpha": 0.4}])
def test_advancing_shaft(parameters):
    assert_met(advancing_shaft(**FEW, **parameters))


@pytest.mark.parametrize("parameters", [{}, {"D": 1.7, "d": 0.88, "p": 0.56, "alpha": 0.5}])
def test_thin_helix(parameters):
    assert_met(thin_helix(**parameters))
