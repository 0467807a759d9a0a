"""PA18: cavities in sand, small versions; the pressure follows Yu and Houlsby's solution."""

import numpy as np
import pytest

from workflows.verification.cavity import cylindrical_ring
from workflows.verification.sand_cavity import pa18, pa18_sphere


@pytest.mark.parametrize(("phi", "psi", "c"), [(30.0, 0.0, 0.0), (40.0, 10.0, 20e3)])
def test_cylinder(phi, psi, c):
    outcome = pa18(
        phi=np.radians(phi), psi=np.radians(psi), c=c, outer_ratio=1000.0, expansion=2.0, steps=20
    )
    assert len(outcome.checks) >= 2
    for check in outcome.checks:
        assert abs(check.error) < 0.01, check


def test_sphere():
    outcome = pa18_sphere(outer_ratio=50.0, expansion=1.1, steps=12, size=0.2, psi=0.2)
    assert outcome.checks[-1].quantity.startswith("cavity pressure / p0 at a/a0 = 1.1")
    assert abs(outcome.checks[-1].error) < 0.03


def test_clay_is_as_before():
    """The pressure at 1.2 times the radius is 4.42 su."""
    outcome = cylindrical_ring(size=0.2, outer_ratio=20.0, expansion=1.2, steps=10)
    assert outcome.checks[-1].is_met
