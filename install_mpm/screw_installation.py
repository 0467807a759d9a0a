"""Installation of a screw pile: geostatic start, load steps along the path, with cutting.

Every step is the one of ``step.py``; what differs from a jacked pile is the way of the pile, the
law of the mesh, and what is recorded.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from install_mpm import screw_surface
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.conventions import rotation_matrix
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import GroundProfile
from install_mpm.history import append
from install_mpm.installation import InstallationProgress, NotConvergedError, Observer
from install_mpm.options import Box, Numerics, ScrewMeshOptions
from install_mpm.pile import PileMotion
from install_mpm.rig_release import RELEASE_STEPS, find_pose
from install_mpm.screw_pile import ScrewPile
from install_mpm.screw_pile_mesh import generate_screw_mesh
from install_mpm.screw_programme import (
    Pose,
    ScrewProgramme,
    next_corner,
    pose_at,
    rim_radius,
    total_travel,
)
from install_mpm.screw_record import history_row
from install_mpm.screw_setup import ScrewInstallation, geostatic_state, move_mesh, set_up
from install_mpm.state_file import InstalledState, PileState
from install_mpm.step import StepResult, step
from install_mpm.step_control import accepted_control, cut_control

GEOSTATIC_RESIDUAL = 1e-2
"""Largest relative out-of-balance force of undisturbed ground.

The traction of the ground on a facet grows linearly with depth; the rule of three points does not
integrate it against quadratic functions exactly.  The first step evens out what is left, some 1e-4.
"""


def install_screw_pile(
    ground: GroundProfile,
    pile: ScrewPile,
    law: CoulombInterface,
    box: Box,
    mesh_options: ScrewMeshOptions,
    programme: ScrewProgramme,
    numerics: Numerics,
    case_text: str,
    *,
    resume_from: InstalledState | None = None,
    observe: Observer = lambda state, progress: None,
) -> InstalledState:
    """Return the ground and the pile after installation.

    The first step moves nothing: it shows that the geostatic start is in equilibrium.
    ``resume_from`` is a state of the same case that an observer was given; the result is then
    bit-equal to that of an uninterrupted run.

    Raises
    ------
    NotConvergedError
        If a step does not converge after ``numerics.max_cuts`` halvings, or the undisturbed ground
        is not in equilibrium.
    """
    if resume_from is None:
        mesh = generate_screw_mesh(pile, box, mesh_options)
    else:
        mesh = resume_from.background_mesh
    problem = set_up(ground, pile, law, box, programme, numerics, mesh)
    end = total_travel(pile, programme)
    if resume_from is None:
        state = geostatic_state(problem, mesh, mesh_options, case_text)
        state, accepted = advance_pile(problem, state, 0.0)
        _check_start(state, accepted)
        observe(state, _progress(state, end))
    else:
        state = resume_from
    while travelled(state) < end * (1.0 - 1e-12):
        state, accepted = advance_pile(problem, state, _next_step(problem, state))
        if accepted:
            observe(state, _progress(state, end))
    if programme.release:
        state = release_rig(problem, state, lambda moved: observe(moved, _progress(moved, end)))
    return state


def release_rig(
    problem: ScrewInstallation, state: InstalledState, observe: Callable[[InstalledState], None]
) -> InstalledState:
    """Return the state after the rig has taken off its loads in equal shares.

    Raises
    ------
    NotConvergedError
        If the loads cannot be taken off.
    """
    history = state.history
    done = round(float(history.release_share[-1]) * RELEASE_STEPS)
    last = history.travel.size - 1 - done  # the last step before the release
    loads = np.array([history.crowd_force[last], history.torque[last] / rim_radius(problem.pile)])
    for n in range(done + 1, RELEASE_STEPS + 1):
        share = n / RELEASE_STEPS
        here = Pose(float(state.pile.penetration), float(state.pile.rotation))
        pose, result = find_pose(
            problem,
            lambda tried, state=state: step_to(problem, state, tried, 0.0),  # type: ignore[misc]
            here,
            (1.0 - share) * loads,
            float(np.linalg.norm(loads)),
        )
        state = accept(problem, state, result, pose, travelled(state), share)
        observe(state)
    return state


def travelled(state: InstalledState) -> float:
    """Return the travel of the rim so far in m."""
    travel = state.history.travel
    return float(travel[-1]) if len(travel) else 0.0


def _next_step(problem: ScrewInstallation, state: InstalledState) -> float:
    """Return the travel of the next step in m: the step size, or what is left of the phase."""
    travel = travelled(state)
    left = next_corner(problem.pile, problem.programme, travel) - travel
    size = float(state.control.step)
    return left if left < size * (1.0 + 1e-9) else size


def _check_start(state: InstalledState, accepted: bool) -> None:
    """Check that the first step had next to nothing to do.

    Raises
    ------
    NotConvergedError
        If the geostatic stress was not in equilibrium.
    """
    if not accepted or state.history.residual_history[0, 0] > GEOSTATIC_RESIDUAL:
        raise NotConvergedError(
            "installation: the undisturbed ground is not in equilibrium, because its K0 stress "
            "exceeds its strength; use ground.k0 nearer to 1 or a stronger soil"
        )


def advance_pile(
    problem: ScrewInstallation, state: InstalledState, travel: float
) -> tuple[InstalledState, bool]:
    """Try one step of ``travel`` of the rim in m.

    Return the new state, or the old one with half the step size; and whether it was accepted.
    """
    end = travelled(state) + travel
    pose = pose_at(problem.pile, problem.programme, end)
    result = step_to(problem, state, pose, travel / float(state.control.step))
    if not result.is_converged:
        if int(state.control.cuts) >= problem.numerics.max_cuts:
            raise NotConvergedError(_why(state, pose, result))
        return state._replace(control=cut_control(state.control, travel)), False
    return accept(problem, state, result, pose, end), True


def step_to(
    problem: ScrewInstallation, state: InstalledState, pose: Pose, warm_start: float
) -> StepResult:
    """Return the step that takes the pile to ``pose``.

    ``warm_start`` is the share of the last displacement that is tried first.
    """
    return step(
        state.material_points,
        state.background_mesh,
        state.interface,
        motion_to(state, pose),
        Prescribed(problem.supports, np.zeros_like(state.background_mesh.nodes)),
        start=warm_start * state.control.displacement_per_step,
        move_mesh=lambda mesh: move_mesh(problem, mesh, pose),
        model=problem.model,
        gradient=problem.gradient,
    )


def motion_to(state: InstalledState, pose: Pose) -> PileMotion:
    """Return the rigid motion from where the pile is to ``pose``."""
    down = pose.advance - float(state.pile.penetration)
    return PileMotion(np.array([0.0, 0.0, -down]), pose.rotation - float(state.pile.rotation))


def _why(state: InstalledState, pose: Pose, result: StepResult) -> str:
    """Return the sentence for a step that does not converge."""
    newton = result.equilibrium.newton
    return (
        f"installation: the step to a rotation of {np.degrees(pose.rotation):.2f} deg and a "
        f"penetration of {pose.advance:.4f} m does not converge after "
        f"{int(state.control.cuts)} halvings (last relative residual "
        f"{newton.residuals[-1]:.1e}, resultants on the pile off by {newton.mismatch:.1e}); use a "
        "smaller installation.step or a finer background mesh"
    )


def accept(
    problem: ScrewInstallation,
    state: InstalledState,
    result: StepResult,
    pose: Pose,
    travel: float,
    release_share: float = 0.0,
) -> InstalledState:
    """Return the state after a converged step, with its row of the history.

    ``travel`` is that of the rim at its end in m.
    """
    motion = motion_to(state, pose)
    interface = screw_surface.follow(
        result.interface, problem.model.elements, problem.normals, pose.rotation, result.mesh,
        problem.ground, problem.law,
    )  # fmt: skip
    turn = rotation_matrix(motion.rotation, 3)
    row = history_row(problem, state, result, motion, pose, travel)
    row["release_share"] = release_share
    return InstalledState(
        material_points=result.points,
        background_mesh=result.mesh,
        interface=interface,
        pile=PileState(
            np.array(pose.advance),
            np.array(pose.rotation),
            np.array(problem.pile.embedment + pose.advance),
            result.equilibrium.contact.force.sum(axis=0),
        ),
        history=append(state.history, row),
        control=accepted_control(
            state.control,
            result.equilibrium.displacement @ turn.T,
            travel - travelled(state),
            problem.programme.step,
        ),
        case_text=state.case_text,
        kinematics=state.kinematics,
    )


def _progress(state: InstalledState, end: float) -> InstallationProgress:
    """Return what the observer is told of the last step."""
    history = state.history
    return InstallationProgress(
        load_step=len(history.travel) - 1,
        travel=float(history.travel[-1]),
        target=end,
        penetration=float(history.penetration[-1]),
        crowd_force=float(history.crowd_force[-1]),
        iterations=int(history.iterations[-1]),
        cuts=int(history.cuts[-1]),
    )
