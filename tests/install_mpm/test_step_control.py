"""Size of the load steps: halved, doubled again, and doubled less often where that fails."""

import numpy as np
import pytest

from install_mpm.state_file import STEPS_BEFORE_GROWTH, StepControl
from install_mpm.step_control import MOST_BEFORE_GROWTH, accepted_control, cut_control

LARGEST = 0.02
TRIAL = np.full((3, 2), 2e-3)


@pytest.fixture
def control():
    wait = np.array(STEPS_BEFORE_GROWTH)
    return StepControl(np.array(LARGEST), np.array(0), wait, wait, TRIAL)


def accepted(control, n=1):
    """After ``n`` steps in which nodes moved a tenth of the step."""
    for _ in range(n):
        moved = np.full_like(TRIAL, 0.1 * float(control.step))
        control = accepted_control(control, moved, float(control.step), LARGEST)
    return control


def test_a_failed_step_is_halved_and_doubled_after_four(control):
    control = cut_control(control, LARGEST)
    assert float(control.step) == LARGEST / 2.0
    np.testing.assert_allclose(control.displacement_per_step, TRIAL / 2.0)
    assert float(accepted(control, 3).step) == LARGEST / 2.0
    grown = accepted(control, 4)
    assert float(grown.step) == LARGEST
    np.testing.assert_allclose(grown.displacement_per_step, 0.1 * LARGEST / 2.0)  # as it was


def test_where_the_doubled_step_fails_again_and_again_it_is_tried_less_often(control):
    control, waits = cut_control(control, LARGEST), []
    for _ in range(6):
        steps = 0
        while float(control.step) < LARGEST:
            control, steps = accepted(control), steps + 1
        waits.append(steps)
        control = cut_control(control, LARGEST)
    assert waits == [4, 8, 16, 32, MOST_BEFORE_GROWTH, MOST_BEFORE_GROWTH]


def test_where_it_succeeds_the_wait_is_forgotten(control):
    control = accepted(cut_control(control, LARGEST), 4)
    control = accepted(cut_control(control, LARGEST), 8)
    assert int(accepted(control, 3).steps_before_growth) == 8
    control = accepted(control, 4)
    assert int(control.steps_before_growth) == STEPS_BEFORE_GROWTH
    again = cut_control(control, LARGEST)
    assert int(again.steps_before_growth) == STEPS_BEFORE_GROWTH


def test_a_step_that_is_halved_twice_counts_once(control):
    control = accepted(cut_control(control, LARGEST), 4)
    twice = cut_control(cut_control(control, LARGEST), LARGEST / 2.0)
    assert int(twice.steps_before_growth) == 8
    assert int(twice.cuts) == 2
    assert float(twice.step) == LARGEST / 4.0
