"""The pile of a case at its place in the ground, and its finite-element model."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from handoff.placed_pile import PlacedFlatPile, PlacedPile, PlacedScrewPile
from install_mpm.screw_history import driven
from install_mpm.screw_programme import corners, is_loaded
from workflows.case import AnyCase
from workflows.ranks import on_first
from workflows.screw_case import ScrewCase

if TYPE_CHECKING:
    from handoff.fe_mesh import FEMesh
    from handoff.fe_state_file import FEState
    from install_mpm.state_file import InstalledState
    from service_fe.problem import ServiceProblem


def placed_pile(case: AnyCase, tip_depth: float, rotation: float) -> PlacedPile:
    """Return the pile with its tip ``tip_depth`` m deep, turned by ``rotation`` in rad."""
    if isinstance(case, ScrewCase):
        return PlacedScrewPile(replace(case.pile, embedment=tip_depth), rotation)
    return PlacedFlatPile(case.pile, tip_depth, case.kinematics)


def is_end_given(case: AnyCase) -> bool:
    """Return whether the case alone tells where the installation ends, and not loads in it."""
    return not isinstance(case, ScrewCase) or not any(map(is_loaded, case.installation.phases))


def pile_at_end(case: AnyCase) -> PlacedPile:
    """Return the pile at the end of the programme of its installation, where that is given.

    When the rig lets go of a screw pile it springs back a little from there.
    """
    if not isinstance(case, ScrewCase):
        return placed_pile(case, case.final_tip_depth, 0.0)
    end = corners(case.pile, case.installation)[-1]
    return placed_pile(case, case.pile.embedment + end.advance, end.rotation)


def pile_where_rig_stopped(case: ScrewCase, installed: InstalledState) -> PlacedPile:
    """Return the pile at the end of the programme, as the installation found it."""
    history = driven(installed.history)
    depth = case.pile.embedment + float(history.penetration[-1])
    return placed_pile(case, depth, float(history.rotation[-1]))


def loaded_in_service(
    case: AnyCase, placed: PlacedPile, problem: ServiceProblem, state: FEState
) -> tuple[ServiceProblem, FEState]:
    """Return model and state of the pile in service: rigid as handed over, or deformable.

    ``problem`` and ``state`` are those of the rigid pile.

    Raises
    ------
    MeshError
        If a deformable pile cannot be meshed.
    """
    from handoff.pile_mesh import mesh_of_pile
    from service_fe.deformable_pile import deformable_model

    assert case.service is not None
    if case.service.pile is None:
        return problem, state
    inside = on_first(lambda: mesh_of_pile(problem.mesh))
    model = deformable_model(
        problem.mesh, inside, case.service.pile, case.ground, case.interface,
        placed.weight(case.ground.water_table), kinematics=placed.kinematics,
        normals=placed.normals, strength_share=placed.strength_share,
        numerics=case.service.numerics,
    )  # fmt: skip
    return model.problem, model.start(state)


def service_problem(case: AnyCase, placed: PlacedPile, mesh: FEMesh) -> ServiceProblem:
    """Return the finite-element model of the pile on a ``mesh`` of the soil around it."""
    from service_fe.problem import ServiceProblem

    assert case.service is not None
    return ServiceProblem(
        mesh, case.ground, case.interface, placed.weight(case.ground.water_table),
        case.service.numerics, kinematics=placed.kinematics, normals=placed.normals,
        strength_share=placed.strength_share,
    )  # fmt: skip
