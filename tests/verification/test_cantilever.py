"""PA2 and AMPLE-BEAM: the tip of a cantilever against the elastica and against AMPLE.

Claimed: extrapolated to depth zero, deflection and shortening agree with the elastica within 2 %;
the cantilever itself misses the 2 % by a little; at AMPLE's depth the tip is within 2 % of AMPLE's;
the supports carry the load, and Newton's method is quadratic.
"""

import numpy as np
import pytest

from install_mpm.newton import convergence_order
from workflows.verification.cantilever import ample_beam, cantilever


def check_all(outcome, *, open_misses=()):
    missed = [check.quantity for check in outcome.checks if not check.is_met]
    assert missed == list(open_misses)
    orders = [convergence_order(np.array(history)) for history in outcome.residual_histories]
    assert np.nanmedian(orders) > 1.8


def test_small_load():
    """A tenth of the load, another material: deflection of the linear range and beyond."""
    check_all(cantilever(P=20e3, E=24e6, nu=0.3, steps=5))


@pytest.mark.slow
def test_full_load():
    """The elastica neither stretches nor shears; at depth d that is 2.7 %, more than is allowed."""
    check_all(cantilever(), open_misses=["deflection w of the tip at depth d [m]"])


@pytest.mark.slow
def test_beam_of_ample():
    check_all(ample_beam(l=20.0, P=50e3))
