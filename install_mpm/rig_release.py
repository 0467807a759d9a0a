"""The rig lets go: torque and crowd force of the last step go to zero in steps.

Advance and rotation of the pile are the unknowns; every trial is a whole step of the method, from
the state before, so stick and slip are as true as in any other step.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from install_mpm.installation import NotConvergedError
from install_mpm.screw_programme import Pose, rim_radius
from install_mpm.screw_record import rig_loads
from install_mpm.screw_setup import ScrewInstallation
from install_mpm.step import StepResult

RELEASE_STEPS = 4
"""Equal shares in which the loads are taken off."""

TOLERANCE = 1e-3
"""Of the loads to be taken off, up to which a step is solved."""

PROBE = 1e-3
"""Share of the step size by which the pile is moved to find its stiffness."""

MOST_TRIALS = 12

StepTo = Callable[[Pose], StepResult]


class RigNotReleasedError(NotConvergedError):
    """The loads of the rig could not be taken off; the message says how far it came."""


def loads_at(problem: ScrewInstallation, result: StepResult, pose: Pose) -> np.ndarray:
    """Return the loads (2,) in N: crowd force, and torque over the radius of the rim."""
    crowd, torque = rig_loads(problem.pile, result.equilibrium, pose)
    return np.array([crowd, torque / rim_radius(problem.pile)])


def find_pose(
    problem: ScrewInstallation,
    step_to: StepTo,
    start: Pose,
    target: np.ndarray,
    scale: float,
) -> tuple[Pose, StepResult]:
    """Return the pose at which the rig's loads are ``target`` (2,) in N, and the step to it.

    ``scale`` in N is what the error is measured by.  Newton's method with a stiffness from two
    probes, improved by Broyden's rule.

    Raises
    ------
    RigNotReleasedError
        If the loads are not met.
    """
    radius = rim_radius(problem.pile)

    def pose_of(moved: np.ndarray) -> Pose:
        turn = -problem.pile.sense * moved[1] / radius
        return Pose(start.advance + moved[0], start.rotation + turn)

    def error_of(moved: np.ndarray) -> tuple[np.ndarray, StepResult]:
        result = step_to(pose_of(moved))
        if not result.is_converged:
            raise RigNotReleasedError("installation: a step of the release does not converge")
        return loads_at(problem, result, pose_of(moved)) - target, result

    probe = PROBE * problem.programme.step
    moved = np.zeros(2)
    error, result = error_of(moved)
    stiffness = np.column_stack(
        [(error_of(-probe * unit)[0] - error) / -probe for unit in np.eye(2)]
    )
    for _ in range(MOST_TRIALS):
        if np.linalg.norm(error) <= TOLERANCE * scale:
            return pose_of(moved), result
        change = -np.linalg.solve(stiffness, error)
        moved = moved + change
        before = error
        error, result = error_of(moved)
        surprise = error - before - stiffness @ change
        stiffness = stiffness + np.outer(surprise, change) / (change @ change)
    raise RigNotReleasedError(
        f"installation: the rig's loads are off by {np.linalg.norm(error):.3g} N after "
        f"{MOST_TRIALS} trials of the release; set installation.release = false, or use a finer "
        "background mesh"
    )
