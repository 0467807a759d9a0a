"""PA2 and AMPLE-BEAM: the tip of a cantilever against beams of depth and none, and against AMPLE.

Claimed: deflection and shortening agree with the geometrically exact beam within 2 % at two depths,
and extrapolated to depth zero with the elastica; the tip is within 2 % of AMPLE's; the supports
carry the load, and Newton's method is quadratic.
"""

import numpy as np
import pytest

from install_mpm.newton import convergence_order
from workflows.verification.ample_beam import ample_beam
from workflows.verification.cantilever import cantilever


def check_all(outcome):
    assert [check.quantity for check in outcome.checks if not check.is_met] == []
    orders = [convergence_order(np.array(history)) for history in outcome.residual_histories]
    assert np.nanmedian(orders) > 1.8


def test_small_load():
    """A tenth of the load, another material: deflection of the linear range and beyond."""
    check_all(cantilever(P=20e3, E=24e6, nu=0.3, steps=5))


@pytest.mark.slow
def test_full_load():
    """At depth d the solid is not the elastica, and the exact beam says by how much."""
    outcome = cantilever()
    check_all(outcome)
    deviation = {row.quantity: row.error for row in outcome.checks if row.tolerance is None}
    beside = "w of the tip at depth d, {} beside the elastica [m]"
    assert deviation[beside.format("solid")] == pytest.approx(0.027, abs=5e-4)
    assert deviation[beside.format("exact beam")] == pytest.approx(0.0207, abs=5e-4)
    assert "the exact beam of that depth is +2.07%" in outcome.remarks[0]


@pytest.mark.slow
def test_beam_of_ample():
    check_all(ample_beam(l=20.0, P=50e3))


@pytest.mark.parametrize("problem", [cantilever, ample_beam])
@pytest.mark.parametrize("cells", [1, 3])
def test_an_odd_number_of_cells_is_refused(problem, cells):
    with pytest.raises(ValueError, match=f"{cells} cells lie over the depth"):
        problem(cells=cells)
