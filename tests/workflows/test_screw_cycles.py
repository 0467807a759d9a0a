"""The report's picture of accumulated rotation: both models, all cycles, still and interactive."""

from types import SimpleNamespace

import numpy as np

from service_fe.options import Cycles, Release
from workflows.screw_cycles import cycles_picture, cycles_plot, cyclic_programmes

PACKET = Cycles("storm", "lateral", amplitude=1.0, cycles=20, steps=1)


def result(model, drift):
    """A pile that tilts by ``drift`` in rad a cycle."""
    rows = 1 + 4 * PACKET.cycles
    motion = np.zeros((rows, 6))
    motion[:, 4] = drift * np.arange(rows) / 4.0
    entry = SimpleNamespace(
        programme=PACKET,
        curve=SimpleNamespace(displacement=2.0 * motion[:, 4], motion=motion),
    )
    programmes = (SimpleNamespace(programme=Release()), entry)
    return SimpleNamespace(model=model, programmes=programmes, programme=lambda _name: entry)


def test_rotation_is_drawn_against_the_number_of_the_cycle():
    service, wished = result("installed", 1e-3), result("wished_in_place", 2e-3)
    assert cyclic_programmes(service) == ["storm"]
    rotation = cycles_picture(service, wished, "storm").axes[0]
    plot = cycles_plot(service, wished, "storm")
    ends = [line for line in rotation.lines if line.get_linestyle() == "-"]
    for line, trace, drift in zip(ends, (plot.data[0], plot.data[3]), (1e-3, 2e-3), strict=True):
        expected = np.degrees(drift) * np.arange(21)
        np.testing.assert_array_equal(line.get_xdata(), np.arange(21))
        np.testing.assert_allclose(line.get_ydata(), expected, atol=1e-12)
        np.testing.assert_allclose(trace.y, expected, rtol=1e-6)
