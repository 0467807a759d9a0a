"""Size of the load steps: halved when one does not converge, doubled after some that do.

Where a doubled step fails again, twice as many steps have to converge before the next attempt: a
way that has become harder than at its start is then not tried in vain every few steps.
"""

from __future__ import annotations

import numpy as np

from install_mpm.state_file import STEPS_BEFORE_GROWTH, StepControl

MOST_BEFORE_GROWTH = 64
"""Steps after which growth is tried again in any case."""


def cut_control(control: StepControl, advance: float) -> StepControl:
    """Return the control for a second try with half the ``advance`` in m that failed."""
    wait = control.steps_before_growth
    if not control.cuts and control.steps_since_cut < STEPS_BEFORE_GROWTH:  # it had just grown
        wait = np.minimum(2 * wait, MOST_BEFORE_GROWTH)
    return control._replace(
        step=np.array(advance / 2.0),
        cuts=control.cuts + 1,
        steps_since_cut=np.array(0),
        steps_before_growth=np.array(wait),
        displacement_per_step=control.displacement_per_step * (advance / 2.0 / control.step),
    )


def accepted_control(
    control: StepControl, displacement: np.ndarray, advance: float, largest: float
) -> StepControl:
    """Return the control after a step of ``advance`` (m) that converged.

    ``displacement`` (n_nodes, dim) in m becomes the first trial of the next step, whose size is at
    most ``largest`` in m.  If the size grows, it is taken as it is: twice a displacement of
    incompressible soil is not one, by the square of its gradient, and soil is stiff in volume.
    """
    size, trial = control.step, control.displacement_per_step
    if advance:
        trial = displacement * (float(size) / advance)
    steps_since_cut, wait = control.steps_since_cut + 1, control.steps_before_growth
    if size >= largest and steps_since_cut >= STEPS_BEFORE_GROWTH:
        wait = np.array(STEPS_BEFORE_GROWTH)
    if steps_since_cut >= wait and size < largest:
        size, steps_since_cut = np.minimum(2.0 * size, largest), np.array(0)
    return StepControl(np.array(size), np.array(0), steps_since_cut, wait, trial)
