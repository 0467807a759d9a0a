"""UNITS: an installation does not depend on the units of length, mass and time."""

import pytest

from workflows.verification.units import UnitSystem, independence_of_units


def test_units_of_mechanics():
    """Millimetre, gramme, second: stresses keep their numbers."""
    units = UnitSystem(1e-3, 1e-3, 1.0)
    assert units.stress == pytest.approx(1.0)
    assert units.acceleration == pytest.approx(1e-3)
    assert units.line_force == pytest.approx(1e-3)


def test_feet_pounds_and_minutes():
    outcome = independence_of_units(length=0.3048, mass=0.45359237, time=60.0, steps=3)
    assert [check.quantity for check in outcome.checks if not check.is_met] == []


def test_the_weight_matters():
    """Otherwise gravity in wrong units would not show."""
    outcome = independence_of_units(length=1.0, mass=1.0, time=1.0, steps=2, gamma=16e3)
    other = independence_of_units(length=1.0, mass=1.0, time=1.0, steps=2, gamma=18e3)
    stress, heavier = (one.checks[3].computed for one in (outcome, other))
    assert heavier > 1.05 * stress
