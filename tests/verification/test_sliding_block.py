"""PA15: block on a rough plane, H = c L + N tan(phi); with dilation it climbs at the angle psi."""

import numpy as np
import pytest

from workflows.verification.sliding_block import sliding_block


@pytest.mark.parametrize("dilation", [0.0, 10.0])
def test_pull_climb_and_normal_force(dilation):
    result = sliding_block(dilation_angle=np.deg2rad(dilation))
    np.testing.assert_allclose(result.force, result.exact, rtol=1e-8)
    np.testing.assert_allclose(result.climb, result.exact_climb, rtol=1e-8, atol=1e-15)
    np.testing.assert_allclose(result.normal_force, 20e3, rtol=1e-8)
    assert result.force[-1] == pytest.approx(10.9046e3, rel=1e-5)


def test_slip_begins_at_strength_over_stiffness():
    onset = 10904.5737 / 1e7
    sticking = sliding_block(displacement=0.999 * onset, steps=1)
    slipping = sliding_block(displacement=1.001 * onset, steps=1)
    assert sticking.force[-1] == pytest.approx(0.999 * 10904.5737, rel=1e-8)
    assert slipping.force[-1] == pytest.approx(10904.5737, rel=1e-8)
