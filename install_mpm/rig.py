"""What the rig does in a step of a screw pile: it moves the pile, or loads it and lets it move."""

from __future__ import annotations

import numpy as np

from install_mpm.loaded_pile import LoadedMotions
from install_mpm.pile import PileMotion
from install_mpm.screw_path import Target, last_motion, last_way
from install_mpm.screw_programme import (
    Pose,
    all_phases,
    phase_motion,
    rim_radius,
    rim_travel,
)
from install_mpm.screw_record import weight_of
from install_mpm.screw_setup import ScrewInstallation
from install_mpm.state_file import InstalledState

STEP_BACK = 1e-3
"""Share of the last motion by which a first trial goes back where the next motion is not known:
there the interface sticks, and its tangent shows that.
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


def first_displacement(
    problem: ScrewInstallation, state: InstalledState, target: Target
) -> np.ndarray:
    """Return the first trial displacement (n_nodes, dim) in m: that of the last step, to scale."""
    last = last_way(problem.pile, problem.programme, state.history)
    share = _share_of_last(problem, state, target) * last / float(state.control.step)
    return share * state.control.displacement_per_step


def _first_motion(problem: ScrewInstallation, state: InstalledState, target: Target) -> Pose:
    """Return the first trial of what is found: as in the last step, to scale, or a little back."""
    share, last = _share_of_last(problem, state, target) or -STEP_BACK, last_motion(state.history)
    return Pose(share * last.advance, share * last.rotation)


def _share_of_last(problem: ScrewInstallation, state: InstalledState, target: Target) -> float:
    """Return how many times the last motion the next one is, as far as it is given.

    Without a given motion it is that of the way, and zero where a phase begins.
    """
    history, last = state.history, last_motion(state.history)
    radius = rim_radius(problem.pile)
    phase = phase_motion(problem.pile, all_phases(problem.programme)[target.phase])
    if rim_travel(problem.pile, phase) == 0.0:
        is_new = not len(history.phase) or history.phase[-1] != target.phase
        way = last_way(problem.pile, problem.programme, history)
        return 0.0 if is_new or way == 0.0 else target.way / way
    given = motion_to(state, target.pose)
    along = radius**2 * given.rotation * last.rotation - float(given.translation[2]) * last.advance
    squared = radius**2 * last.rotation**2 * (target.torque is None) + last.advance**2 * (
        target.crowd_force is None
    )
    return max(along / squared, 0.0) if squared > 0.0 else 0.0


def has_broken_away(problem: ScrewInstallation, target: Target, motion: PileMotion) -> bool:
    """Return whether the loads of a step have taken the pile farther than a step may go."""
    travel = rim_travel(problem.pile, Pose(float(motion.translation[2]), motion.rotation))
    return target.is_loaded and travel > LARGEST_TRAVEL * problem.programme.step
