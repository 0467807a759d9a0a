"""Installation of a screw pile: geostatic start, load steps along the path, with cutting.

Every step is the one of ``step.py``; what differs from a jacked pile is the way of the pile, which
may be found from loads, the law of the mesh, and what is recorded.
"""

from __future__ import annotations

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
from install_mpm.record import StateFileError
from install_mpm.rig import (
    first_displacement,
    has_broken_away,
    loaded_motions,
    motion_to,
    pose_after,
)
from install_mpm.screw_path import START, Target, next_target, way_done
from install_mpm.screw_pile import ScrewPile
from install_mpm.screw_pile_mesh import generate_screw_mesh
from install_mpm.screw_programme import Pose, ScrewProgramme, all_phases, total_length
from install_mpm.screw_record import history_row
from install_mpm.screw_setup import (
    ScrewInstallation,
    geostatic_state,
    lowest_tip,
    move_mesh,
    set_up,
)
from install_mpm.state_file import InstalledState, PileState
from install_mpm.step import StepResult, step
from install_mpm.step_control import accepted_control, cut_control
from install_mpm.winding import winding_change

GEOSTATIC_RESIDUAL = 1e-2
"""Largest relative out-of-balance force of undisturbed ground.

The traction of the ground on a facet grows linearly with depth; the rule of three points does not
integrate it against quadratic functions exactly.  The first step evens out what is left, some 1e-4.
"""


class PileLostError(NotConvergedError):
    """The loads take the pile where it cannot go; the message says where."""


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
    PileLostError
        If the ground cannot carry the loads that are given.
    """
    if resume_from is None:
        mesh = generate_screw_mesh(pile, box, mesh_options)
    else:
        mesh = resume_from.background_mesh
    problem = set_up(ground, pile, law, box, programme, numerics, mesh)
    if resume_from is None:
        state = geostatic_state(problem, mesh, mesh_options, case_text)
        state, accepted = advance_pile(problem, state, START)
        _check_start(state, accepted)
        observe(state, _progress(problem, state))
    else:
        state = _resumable(resume_from)
    while (target := next_step(problem, state)) is not None:
        state, accepted = advance_pile(problem, state, target)
        if accepted:
            observe(state, _progress(problem, state))
    return state


def next_step(problem: ScrewInstallation, state: InstalledState) -> Target | None:
    """Return where the next step goes; None at the end of the programme."""
    size = float(state.control.step)
    return next_target(problem.pile, problem.programme, state.history, size)


def _resumable(state: InstalledState) -> InstalledState:
    """Return a state to go on from.

    Raises
    ------
    StateFileError
        If it is from before phases were recorded.
    """
    if (state.history.phase < 0).any():
        raise StateFileError(
            "the checkpoint does not tell the phase of the installation; it is of an older version "
            "of screwpile: remove it and start again"
        )
    return state


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
    problem: ScrewInstallation, state: InstalledState, target: Target
) -> tuple[InstalledState, bool]:
    """Try one step to ``target``.

    Return the new state, or the old one with half the step size; and whether it was accepted.

    Raises
    ------
    NotConvergedError, PileLostError
        If the step was halved too often already, or the pile leaves the place it can be in.
    """
    result = step_to(problem, state, target)
    is_lost = has_broken_away(problem, target, result.equilibrium.motion)
    if result.is_converged and not is_lost:
        return accept(problem, state, result, target), True
    if int(state.control.cuts) >= problem.numerics.max_cuts:
        if is_lost:
            raise PileLostError(_where_lost(problem, target, result.equilibrium.motion))
        raise NotConvergedError(_why(state, target, result))
    return state._replace(control=cut_control(state.control, target.way)), False


def step_to(problem: ScrewInstallation, state: InstalledState, target: Target) -> StepResult:
    """Return the step that takes the pile to ``target``."""
    return step(
        state.material_points,
        state.background_mesh,
        state.interface,
        motion_to(state, target.pose),
        Prescribed(problem.supports, np.zeros_like(state.background_mesh.nodes)),
        start=first_displacement(problem, state, target),
        move_mesh=lambda mesh, motion: move_mesh(problem, mesh, pose_after(state, target, motion)),
        model=problem.model,
        gradient=problem.gradient,
        loaded=loaded_motions(problem, state, target),
    )


def _why(state: InstalledState, target: Target, result: StepResult) -> str:
    """Return the sentence for a step that does not converge."""
    pose, newton = target.pose, result.equilibrium.newton
    loads = "loads that the ground can carry, " if target.is_loaded else ""
    return (
        f"installation: the step to a rotation of {np.degrees(pose.rotation):.2f} deg and a "
        f"penetration of {pose.advance:.4f} m does not converge after "
        f"{int(state.control.cuts)} halvings (last relative residual "
        f"{newton.residuals[-1]:.1e}, resultants on the pile off by {newton.mismatch:.1e}); use "
        f"{loads}a smaller installation.step or a finer background mesh"
    )


def _where_lost(problem: ScrewInstallation, target: Target, motion: PileMotion) -> str:
    """Return the sentence for a pile that the ground cannot hold."""
    loads = [
        f"{name} of {value / 1e3:.4g} {unit}"
        for name, value, unit in (
            ("crowd force", target.crowd_force, "kN"), ("torque", target.torque, "kN m")
        )
        if value is not None
    ]  # fmt: skip
    return (
        f"installation: the ground cannot carry the {' and '.join(loads)} of phase "
        f"{all_phases(problem.programme)[target.phase].name!r}: the pile would go "
        f"{-motion.translation[2]:.3g} m down and turn by {np.degrees(motion.rotation):.3g} deg "
        "in a step; give less, or more steps in which it rises"
    )


def accept(
    problem: ScrewInstallation, state: InstalledState, result: StepResult, target: Target
) -> InstalledState:
    """Return the state after a converged step to ``target``, with its row of the history.

    Raises
    ------
    PileLostError
        If the loads have taken the pile too near to the bottom of the box or to the surface.
    """
    motion = result.equilibrium.motion
    pose = pose_after(state, target, motion)
    _check_place(problem, target, pose)
    interface = screw_surface.follow(
        result.interface, problem.model.elements, problem.normals, pose.rotation, result.mesh,
        problem.ground, problem.law, problem.strength_share,
    )  # fmt: skip
    displaced = result.equilibrium.displacement @ rotation_matrix(motion.rotation, 3).T
    row = history_row(problem, state, result, target, pose)
    row |= winding_change(
        problem, result.points, result.mesh, interface, float(state.pile.rotation), pose
    )._asdict()
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
        control=accepted_control(state.control, displaced, target.way, problem.programme.step),
        case_text=state.case_text,
        kinematics=state.kinematics,
    )


def _check_place(problem: ScrewInstallation, target: Target, pose: Pose) -> None:
    """Check the place of a loaded pile; that of a driven one is checked with the case.

    Raises
    ------
    PileLostError
        If the pile is too near to the bottom of the box or to the surface.
    """
    pile, depth = problem.pile, problem.pile.embedment + pose.advance
    if not target.is_loaded or pile.highest_plate < depth < lowest_tip(pile, problem.box):
        return
    raise PileLostError(
        f"installation: the loads of phase {all_phases(problem.programme)[target.phase].name!r} "
        f"take the tip to {depth:.3g} m, but it has to stay between {pile.highest_plate:.3g} m "
        f"(uppermost helix in the ground) and {lowest_tip(pile, problem.box):.3g} m (a diameter "
        "above the bottom of the box); make the phase shorter, or change the load or the box"
    )


def _progress(problem: ScrewInstallation, state: InstalledState) -> InstallationProgress:
    """Return what the observer is told of the last step."""
    history = state.history
    return InstallationProgress(
        load_step=len(history.travel) - 1,
        travel=way_done(problem.pile, problem.programme, history),
        target=total_length(problem.pile, problem.programme),
        penetration=float(history.penetration[-1]),
        crowd_force=float(history.crowd_force[-1]),
        iterations=int(history.iterations[-1]),
        cuts=int(history.cuts[-1]),
    )
