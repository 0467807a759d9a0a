"""PE1, PE2, PE3, PE6, PE7 and PE8: single elements of soil, published values and other inputs."""

import numpy as np
import pytest

from workflows.verification.problem import Outcome
from workflows.verification.soil_elements import pe1, pe2, pe3, pe6, pe7
from workflows.verification.tangent_check import pe8


def computed(outcome: Outcome, quantity: str) -> float:
    """Value of the check whose name begins so, after all checks were found to be met."""
    assert [check for check in outcome.checks if not check.is_met] == []
    return next(c.computed for c in outcome.checks if c.quantity.startswith(quantity))


def test_oedometer():
    outcome = pe1()
    assert computed(outcome, "psi = 0 deg: horizontal") == pytest.approx(1.0 / 3.0, abs=1e-6)
    assert computed(outcome, "psi = 0 deg: modulus") == pytest.approx(0.6, abs=1e-6)
    assert computed(outcome, "psi = 30 deg: modulus") == pytest.approx(0.81818, abs=1e-5)


def test_oedometer_that_stays_elastic():
    outcome = pe1(nu=0.4, phi=np.radians(24.0), psi=0.1)
    assert computed(outcome, "psi = 0 deg: horizontal") == pytest.approx(2.0 / 3.0, abs=1e-6)


@pytest.mark.parametrize("psi", [0.0, 10.0, 30.0])
def test_drained_triaxial(psi):
    outcome = pe2(psi=np.radians(psi))
    assert computed(outcome, "q at the end") == pytest.approx(200e3, rel=1e-6)


@pytest.mark.parametrize(("phi", "ratio"), [(24.0, 0.94106), (30.0, 1.2), (35.0, 1.41833)])
def test_undrained_triaxial(phi, ratio):
    outcome = pe3(phi=np.radians(phi))
    assert computed(outcome, "q at the end") == pytest.approx(100e3 * ratio, rel=1e-5)


@pytest.mark.parametrize(
    ("phi", "psi", "ratio"), [(30.0, 0.0, 0.5), (35.0, 5.0, 0.60146), (40.0, 10.0, 0.71256)]
)
def test_simple_shear(phi, psi, ratio):
    for k0 in (1.0, 0.5):
        outcome = pe6(phi=np.radians(phi), psi=np.radians(psi), K0=k0)
        assert computed(outcome, "tau / sigma") == pytest.approx(ratio, rel=1e-5)


def test_simple_shear_of_a_hencky_solid():
    for nu in (0.0, 0.4):
        assert computed(pe7(nu=nu), "largest tau / G") == pytest.approx(1.32549, abs=1e-5)


@pytest.mark.parametrize("inputs", [{}, {"c": 0.0, "psi": 0.0, "seed": 2}])
def test_tangents(inputs):
    assert computed(pe8(n=60, **inputs), "mohr coulomb, finite") < 1e-6
