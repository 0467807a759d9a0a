"""Installation of a pile: geostatic start, load steps with cutting, observers."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from install_mpm import pile_surface
from install_mpm.background_mesh import cell_quality
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.conventions import Kinematics
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import GroundProfile, boundary_depths
from install_mpm.history import append
from install_mpm.installation_setup import (
    DEFAULT_DISCRETISATION,
    ON_BOUNDARY,
    Installation,
    cell_type_of,
    geostatic_state,
    set_up,
    set_up_at,
)
from install_mpm.interface import reaction
from install_mpm.mesh_generation import generate_background_mesh
from install_mpm.mesh_motion import translate
from install_mpm.newton import convergence_order
from install_mpm.options import (
    BackgroundMeshOptions,
    Box,
    DiscretisationOptions,
    InstallationProgramme,
    Numerics,
)
from install_mpm.pile import WHOLE_PILE, Pile, PileMotion, PilePart, buried_weight
from install_mpm.remeshing import is_worn, on_new_mesh, with_changes
from install_mpm.state_file import InstalledState, PileState, StepControl
from install_mpm.step import StepResult, step
from install_mpm.step_control import accepted_control, cut_control

GEOSTATIC_RESIDUAL = 1e-8
"""Largest relative out-of-balance force of undisturbed ground; round-off leaves about 1e-12."""


class NotConvergedError(RuntimeError):
    """A step did not converge even after the last permitted cut; the message says where."""


class InstallationProgress(NamedTuple):
    """What an observer is told after each accepted step."""

    load_step: int
    travel: float
    """What the target is measured by: the penetration, or the way of a screw pile's rim."""
    target: float
    penetration: float
    crowd_force: float
    iterations: int
    cuts: int


Observer = Callable[[InstalledState, InstallationProgress], None]


def install(
    ground: GroundProfile,
    pile: Pile,
    law: CoulombInterface,
    box: Box,
    mesh_options: BackgroundMeshOptions,
    programme: InstallationProgramme,
    numerics: Numerics,
    case_text: str,
    *,
    kinematics: Kinematics = Kinematics.PLANE_STRAIN,
    discretisation: DiscretisationOptions = DEFAULT_DISCRETISATION,
    resume_from: InstalledState | None = None,
    observe: Observer = lambda state, progress: None,
) -> InstalledState:
    """Return the ground and the pile after installation.

    The first step moves nothing: it shows that the geostatic start is in equilibrium.
    Under axisymmetric ``kinematics`` the pile is round and its forces are those of all of it.
    ``resume_from`` is a state of the same case that an observer was given; the result is then
    bit-equal to that of an uninterrupted run.

    Raises
    ------
    NotConvergedError
        If a step does not converge after ``numerics.max_cuts`` halvings, or the undisturbed ground
        is not in equilibrium.
    """
    if resume_from is None:
        mesh = generate_background_mesh(
            pile, box, mesh_options, boundary_depths(ground), cell_type_of(discretisation)
        )
    else:
        mesh, kinematics = resume_from.background_mesh, resume_from.kinematics
    problem = set_up(
        ground, pile, law, box, mesh_options, programme, numerics, mesh, kinematics, discretisation
    )
    if resume_from is None:
        state = geostatic_state(problem, mesh, mesh_options.points_per_direction, case_text)
        state, accepted = advance_pile(problem, state, 0.0)
        _check_start(state, accepted)
        observe(state, _progress(problem, state))
    else:
        state = resume_from
    while float(state.pile.penetration) < programme.penetration - ON_BOUNDARY:
        if is_worn(state.background_mesh, mesh_options.smallest_quality):
            problem, state = renew_mesh(problem, state)
            observe(state, _progress(problem, state))
        state, accepted = advance_pile(problem, state, _next_step(problem, state))
        if accepted:
            observe(state, _progress(problem, state))
    return state


def _check_start(state: InstalledState, accepted: bool) -> None:
    """Check that the first step had nothing to do.

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


def renew_mesh(problem: Installation, state: InstalledState) -> tuple[Installation, InstalledState]:
    """Return problem and state on a mesh made at the pile's place, in equilibrium at rest.

    Raises
    ------
    NotConvergedError
        If the new mesh is no better, or its first step does not converge.
    """
    depth = float(state.pile.tip_depth)
    renewed, mesh, interface = set_up_at(problem, depth)
    if is_worn(mesh, problem.mesh_options.smallest_quality):
        raise NotConvergedError(
            f"installation: the mesh made anew at tip depth {depth:.3f} m has a cell of quality "
            f"{cell_quality(mesh).min():.2f}; use a background_mesh.smallest_quality below that"
        )
    resting, accepted = advance_pile(renewed, on_new_mesh(state, mesh, interface), 0.0)
    if not accepted:
        raise NotConvergedError(
            f"installation: no equilibrium on the mesh made anew at a tip depth of {depth:.4f} m; "
            "use another background_mesh.smallest_quality, or a finer mesh"
        )
    return renewed, with_changes(state, resting)


def _next_step(problem: Installation, state: InstalledState) -> float:
    """Return the advance of the next step in m: the current step size, or what is left."""
    left = problem.programme.penetration - float(state.pile.penetration)
    size = float(state.control.step)
    return left if left < size * (1.0 + 1e-9) else size


def advance_pile(
    problem: Installation, state: InstalledState, advance: float
) -> tuple[InstalledState, bool]:
    """Try one step of ``advance`` in m, negative upward.

    Return the new state, or the old one with half the step size; and whether it was accepted.
    """
    control = state.control
    penetration = float(state.pile.penetration) + advance
    scale = advance / float(control.step) if advance else 0.0
    result = step(
        state.material_points,
        state.background_mesh,
        state.interface,
        PileMotion(np.array([0.0, -advance])),
        Prescribed(problem.supports, np.zeros_like(state.background_mesh.nodes)),
        start=scale * control.displacement_per_step,
        move_mesh=lambda mesh, _: translate(
            mesh,
            penetration - (problem.reference_depth - problem.pile.embedment),
            -problem.reference_depth,
            (-problem.box.depth, problem.box.headroom),
            problem.mesh_options.rigid_zone,
        ),
        model=problem.model,
        gradient=problem.gradient,
    )
    if not result.is_converged:
        return state._replace(control=_cut(problem, state, advance, result)), False
    return _accept(problem, state, advance, result), True


def _cut(
    problem: Installation, state: InstalledState, advance: float, result: StepResult
) -> StepControl:
    """Return the control for a second try with half the ``advance`` in m that failed.

    Raises
    ------
    NotConvergedError
        If the step was halved too often already.
    """
    control = state.control
    if int(control.cuts) >= problem.numerics.max_cuts:
        penetration = float(state.pile.penetration) + advance
        raise NotConvergedError(
            f"installation: the step to penetration {penetration:.4f} m does not converge after "
            f"{int(control.cuts)} halvings (last relative residual "
            f"{result.equilibrium.newton.residuals[-1]:.1e}); use a smaller installation.step "
            "or a finer background mesh"
        )
    return cut_control(control, advance)


def _accept(
    problem: Installation, state: InstalledState, advance: float, result: StepResult
) -> InstalledState:
    """Return the state after a converged step, with its row of the history."""
    interface = pile_surface.follow(
        result.interface, problem.model.elements, result.mesh, problem.ground, problem.law,
        problem.model.kinematics,
    )  # fmt: skip
    penetration = float(state.pile.penetration) + advance
    tip_depth = problem.pile.embedment + penetration
    force = reaction(result.interface)
    return InstalledState(
        material_points=result.points,
        background_mesh=result.mesh,
        interface=interface,
        pile=PileState(np.array(penetration), np.array(0.0), np.array(tip_depth), force),
        history=append(state.history, _history_row(problem, state, result, penetration, tip_depth)),
        control=accepted_control(
            state.control, result.equilibrium.displacement, advance, problem.programme.step
        ),
        case_text=state.case_text,
        kinematics=state.kinematics,
    )


def _history_row(
    problem: Installation,
    state: InstalledState,
    result: StepResult,
    penetration: float,
    tip_depth: float,
) -> dict[str, object]:
    """Return the history of an accepted step; forces are for the whole pile."""
    newton = result.equilibrium.newton
    on_base = result.interface.part == PilePart.BASE
    base = reaction(result.interface, on_base)[1]
    shaft = reaction(result.interface, ~on_base)[1]
    kinematics = problem.model.kinematics
    whole = WHOLE_PILE[kinematics]
    weight = buried_weight(problem.pile, tip_depth, kinematics, problem.ground.water_table)
    return {
        "penetration": penetration,
        "crowd_force": whole * (base + shaft - weight),
        "base_force": whole * base,
        "shaft_force": whole * shaft,
        "iterations": len(newton.residuals) - 1,
        "residual": newton.residuals[-1],
        "convergence_order": convergence_order(newton.residuals),
        "cuts": int(state.control.cuts),
        "smallest_cell_quality": cell_quality(result.mesh).min(),
        "remesh_stress_change": np.nan,
        "remesh_force_change": np.nan,
        "residual_history": newton.residuals,
        **result.counts._asdict(),
    }


def _progress(problem: Installation, state: InstalledState) -> InstallationProgress:
    """Return what the observer is told of the last step."""
    history = state.history
    return InstallationProgress(
        load_step=len(history.penetration) - 1,
        travel=float(state.pile.penetration),
        target=problem.programme.penetration,
        penetration=float(state.pile.penetration),
        crowd_force=float(history.crowd_force[-1]),
        iterations=int(history.iterations[-1]),
        cuts=int(history.cuts[-1]),
    )
