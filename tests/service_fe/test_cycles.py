"""What cycles of load leave behind is read at the same load of every cycle."""

from types import SimpleNamespace

import numpy as np
import pytest

from service_fe.cycles import accumulated, peaks
from service_fe.options import Cycles

DIRECTION = np.radians(30.0)


def packet(programme, *, leads_to_mean):
    """A curve whose displacement is 1 mm a cycle plus 5 mm with the load; it tilts 0.1 rad a m."""
    quarter = np.arange(1, programme.steps + 1) / programme.steps
    wave = np.concatenate([quarter, 1.0 - quarter, -quarter, quarter - 1.0])
    share = np.concatenate([[0.0], np.tile(wave, programme.cycles)])
    drift = 1e-3 * np.arange(len(share)) / (4 * programme.steps)
    displacement = drift + 5e-3 * share
    if leads_to_mean:
        displacement = np.concatenate([[0.0], 2e-3 + displacement])
    about = np.array([-np.sin(DIRECTION), np.cos(DIRECTION)])
    motion = np.zeros((len(displacement), 6))
    motion[:, 3:5] = 0.1 * displacement[:, None] * about
    return SimpleNamespace(displacement=displacement, motion=motion)


@pytest.mark.parametrize("steps", [1, 3])
@pytest.mark.parametrize("leads_to_mean", [False, True])
def test_accumulation_is_read_at_the_mean_load(steps, leads_to_mean):
    programme = Cycles("c", "lateral", amplitude=1.0, cycles=4, steps=steps, direction=DIRECTION)
    ends = accumulated(programme, packet(programme, leads_to_mean=leads_to_mean))
    start = 2e-3 if leads_to_mean else 0.0
    np.testing.assert_allclose(ends.displacement, start + 1e-3 * np.arange(5), atol=1e-12)
    np.testing.assert_allclose(ends.rotation, 0.1 * ends.displacement, atol=1e-12)


@pytest.mark.parametrize("steps", [1, 3])
def test_peaks_are_those_of_the_load(steps):
    programme = Cycles("c", "lateral", amplitude=1.0, cycles=4, steps=steps, direction=DIRECTION)
    largest, least = peaks(programme, packet(programme, leads_to_mean=True))
    cycle = np.arange(4)
    np.testing.assert_allclose(largest.displacement, 7e-3 + 1e-3 * (cycle + 0.25), atol=1e-12)
    np.testing.assert_allclose(least.displacement, -3e-3 + 1e-3 * (cycle + 0.75), atol=1e-12)
    np.testing.assert_allclose(least.rotation, 0.1 * least.displacement, atol=1e-12)
