"""Mismatch of the resultants on the pile: forces that balance, and forces that do not."""

import numpy as np
import pytest

from install_mpm.far_field import far_field_mismatch
from install_mpm.interface import Contact


@pytest.fixture
def balanced(rng):
    """Forces on a pile, and loads at nodes with the same six resultants."""
    position, force = rng.normal(size=(2, 30, 3))
    nodes, loads = rng.normal(size=(2, 40, 3))
    wanted = np.concatenate([force.sum(axis=0), np.cross(position, force).sum(axis=0)])
    operator = np.zeros((6, 40, 3))
    for axis, unit in enumerate(np.eye(3)):
        operator[axis, :, axis] = 1.0
        operator[3 + axis] = np.cross(unit, nodes)
    flat = operator.reshape(6, -1)
    loads += np.linalg.lstsq(flat, wanted - flat @ loads.ravel(), rcond=None)[0].reshape(40, 3)
    return Contact(position, force, np.zeros_like(force)), nodes, loads


def test_forces_that_balance_have_no_mismatch(balanced):
    assert max(far_field_mismatch(*balanced)) < 1e-13


@pytest.mark.parametrize("axis", range(3))
def test_a_force_too_much_is_measured_by_the_forces_on_the_pile(axis, balanced):
    contact, nodes, loads = balanced
    size = np.linalg.norm(contact.force, axis=1)
    loads[0, axis] += 0.01 * size.sum()
    mismatch = far_field_mismatch(contact, nodes, loads)
    assert mismatch.force == pytest.approx(0.01)


@pytest.mark.parametrize("axis", range(3))
def test_a_couple_too_much_is_measured_by_force_times_distance_from_the_axis(axis, balanced):
    contact, nodes, loads = balanced
    radius = np.linalg.norm(contact.position[:, :2], axis=1)
    couple = 0.01 * (radius @ np.linalg.norm(contact.force, axis=1))
    first, second = np.eye(3)[[axis - 2, axis - 1]]  # first x second is the axis
    nodes = np.vstack([nodes, first, np.zeros(3)])
    loads = np.vstack([loads, couple * second, -couple * second])
    mismatch = far_field_mismatch(contact, nodes, loads)
    assert mismatch.force < 1e-13
    assert mismatch.moment == pytest.approx(0.01)
