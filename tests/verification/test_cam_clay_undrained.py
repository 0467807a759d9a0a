"""PE4: modified Cam clay in undrained compression, published values and other inputs."""

import pytest

from workflows.verification.cam_clay_undrained import pe4


def test_published_digits():
    outcome = pe4()
    assert all(check.is_met for check in outcome.checks)
    values = [check.computed for check in outcome.checks[:6]]
    assert values == pytest.approx([31.371, 50.340, 63.727, 68.586, 34.461, 57.435], rel=1e-3)


@pytest.mark.parametrize(
    "other",
    [{"ocr": 1.5}, {"ocr": 4.0}, {"M": 0.9, "lam": 0.15, "kap": 0.02, "e0": 0.8, "p0": 40e3}],
)
def test_other_clays(other):
    assert all(check.is_met for check in pe4(**other).checks)


def test_strains_converge_with_the_steps():
    errors = [abs(pe4(steps=steps).checks[1].error) for steps in (600, 1200)]
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.1)
    assert not pe4(steps=100).checks[1].is_met
