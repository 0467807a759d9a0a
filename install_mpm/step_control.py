"""Size of the load steps: halved when one does not converge, doubled after some that do."""

from __future__ import annotations

import numpy as np

from install_mpm.state_file import StepControl

STEPS_BEFORE_GROWTH = 4
"""Steps that must converge after a cut before the step is doubled again."""


def cut_control(control: StepControl, advance: float) -> StepControl:
    """Return the control for a second try with half the ``advance`` in m that failed."""
    return control._replace(
        step=np.array(advance / 2.0),
        cuts=control.cuts + 1,
        steps_since_cut=np.array(0),
        displacement_per_step=control.displacement_per_step * (advance / 2.0 / control.step),
    )


def accepted_control(
    control: StepControl, displacement: np.ndarray, advance: float, largest: float
) -> StepControl:
    """Return the control after a step of ``advance`` (m) that converged.

    ``displacement`` (n_nodes, dim) in m becomes the first trial of the next step, scaled to its
    size, which is at most ``largest`` in m.
    """
    size, trial = control.step, control.displacement_per_step
    if advance:
        trial = displacement * (float(size) / advance)
    steps_since_cut = control.steps_since_cut + 1
    if steps_since_cut >= STEPS_BEFORE_GROWTH and size < largest:
        grown = np.minimum(2.0 * size, largest)
        trial, size = trial * (grown / size), grown
        steps_since_cut = np.array(0)
    return StepControl(np.array(size), np.array(0), steps_since_cut, trial)
