"""What the rig does in a step of a screw pile: it moves the pile, or loads it and lets it move."""

from __future__ import annotations

import numpy as np

from install_mpm.loaded_pile import LoadedMotions
from install_mpm.pile import PileMotion
from install_mpm.screw_path import Target, last_motion, last_way
from install_mpm.screw_programme import Pose, rim_radius, rim_travel
from install_mpm.screw_record import weight_of
from install_mpm.screw_setup import ScrewInstallation
from install_mpm.state_file import InstalledState

STEP_BACK = 1e-3
"""Share of the last step by which the first trial of a new phase goes back: where the interface
sticks again, its tangent shows that.
"""

LARGEST_TRAVEL = 2.0
"""Travel of the rim over the step of the programme beyond which a loaded pile has broken away."""


def motion_to(state: InstalledState, pose: Pose) -> PileMotion:
    """Return the rigid motion from where the pile is to ``pose``."""
    down = pose.advance - float(state.pile.penetration)
    return PileMotion(np.array([0.0, 0.0, -down]), pose.rotation - float(state.pile.rotation))


def pose_after(state: InstalledState, target: Target, motion: PileMotion) -> Pose:
    """Return the pose at the end of a step to ``target`` in which the pile made ``motion``."""
    pose = target.pose
    if target.crowd_force is not None:
        pose = pose._replace(advance=float(state.pile.penetration) - float(motion.translation[2]))
    if target.torque is not None:
        pose = pose._replace(rotation=float(state.pile.rotation) + motion.rotation)
    return pose


def loaded_motions(
    problem: ScrewInstallation, state: InstalledState, target: Target
) -> LoadedMotions | None:
    """Return the motions that the loads of a step find: advance, and travel of the rim round."""
    if not target.is_loaded:
        return None
    pile, depth = problem.pile, float(state.pile.tip_depth)
    trial = _first_motion(problem, state, target)
    radius, weight = rim_radius(pile), weight_of(pile, depth)
    down, around = [], []
    if target.crowd_force is not None:
        by_depth = weight_of(pile, depth + 1.0) - weight
        down = [(-1.0, 0.0, target.crowd_force + weight, by_depth, trial.advance)]
    if target.torque is not None:
        turn = -pile.sense / radius
        around = [(0.0, turn, target.torque / radius, 0.0, trial.rotation / turn)]
    vertical, rotation, load, change, start = np.array(down + around).T
    translation = np.outer(vertical, [0.0, 0.0, 1.0])
    return LoadedMotions(translation, rotation, load, np.diag(change), start)


def goes_on(state: InstalledState, target: Target) -> bool:
    """Return whether the last step was one of the phase of ``target``."""
    history = state.history
    return bool(len(history.phase) and history.phase[-1] == target.phase
                and history.phase_share[-1] > 0.0)  # fmt: skip


def first_displacement(state: InstalledState, target: Target) -> np.ndarray:
    """Return the first trial displacement (n_nodes, dim) in m: that of the last step, to scale."""
    scale = target.way / float(state.control.step) if goes_on(state, target) else 0.0
    return scale * state.control.displacement_per_step


def _first_motion(problem: ScrewInstallation, state: InstalledState, target: Target) -> Pose:
    """Return the first trial of what is found, by the last step as well."""
    history, scale = state.history, -STEP_BACK
    if goes_on(state, target):
        scale = target.way / last_way(problem.pile, problem.programme, history)
    last = last_motion(history)
    return Pose(scale * last.advance, scale * last.rotation)


def has_broken_away(problem: ScrewInstallation, target: Target, motion: PileMotion) -> bool:
    """Return whether the loads of a step have taken the pile farther than a step may go."""
    travel = rim_travel(problem.pile, Pose(float(motion.translation[2]), motion.rotation))
    return target.is_loaded and travel > LARGEST_TRAVEL * problem.programme.step
