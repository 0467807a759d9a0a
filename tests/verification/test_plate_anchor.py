"""PC7: uplift of a circular plate in sand with associated flow; the bound of limit analysis.

Claimed: finite elements approach the limit load from above with an error of first order in their
size at the cone, and at no size they do not exceed the weight of the cone.
"""

import numpy as np
import pytest

from install_mpm.newton import convergence_order
from workflows.verification import plate_anchor
from workflows.verification.plate_anchor import PROBLEM
from workflows.verification.references.bearing_capacity import plate_uplift_bound

pytestmark = [pytest.mark.dolfinx, pytest.mark.gmsh]


def test_bound_is_the_weight_of_the_cone():
    """Of two depths as published; a cone over a plate of no friction is a cylinder."""
    phi = np.deg2rad(30.0)
    assert plate_uplift_bound(depth_ratio=2.0, friction_angle=phi) == pytest.approx(5.087, abs=5e-4)
    assert plate_uplift_bound(depth_ratio=4.0, friction_angle=phi) == pytest.approx(12.73, abs=5e-3)
    assert plate_uplift_bound(depth_ratio=3.0, friction_angle=0.0) == 1.0


def test_load_falls_towards_the_bound_on_coarse_meshes(monkeypatch):
    """Another plate, depth, angle and weight; the finest mesh is left to the slow test."""
    monkeypatch.setattr(plate_anchor, "SIZES", (0.1, 0.05))
    outcome = PROBLEM.run(D=0.6, H=0.9, phi=float(np.deg2rad(35.0)), gamma=17e3, K0=0.45)
    coarse, fine = outcome.series[1].computed
    assert 0.0 < fine < 0.65 * coarse < 0.1
    orders = [convergence_order(np.array(history)) for history in outcome.residual_histories]
    assert np.nanmedian(orders) >= 1.8


@pytest.mark.slow
@pytest.mark.parametrize("depth", [2.0, 4.0])
def test_the_cone_bounds_the_limit_load(depth):
    outcome = PROBLEM.run(H=depth)
    assert [check.quantity for check in outcome.checks if not check.is_met] == []
