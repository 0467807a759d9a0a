"""Figures of the certificate that tell what the pile feels: resultants, and stress around it."""

from __future__ import annotations

import numpy as np

from handoff.equilibration import EquilibriumProblem
from handoff.fe_state_file import FEInterfacePoints, FEState
from handoff.figure import Figure, relative_difference
from handoff.interface_transfer import forces_on_pile, part_forces
from handoff.options import HandoffOptions
from handoff.placed_pile import PlacedPile
from handoff.shaft_profile import profile_differences, shaft_profiles
from install_mpm.conventions import dimension
from install_mpm.interface import force_on_pile
from install_mpm.pile import WHOLE_PILE
from install_mpm.state_file import InstalledState

STAGES = ("mpm", "transferred", "equilibrated")
MAX_PRESSURE_DIFFERENCE = 0.1
"""Of the contact pressure along the shaft, relative."""


def reaction_figures(
    installed: InstalledState,
    placed: PlacedPile,
    problem: EquilibriumProblem,
    states: tuple[FEState, FEState],
    options: HandoffOptions,
) -> dict[str, Figure]:
    """Return the soil reaction on the pile and its parts in material points and finite elements.

    ``states`` are those before and after the equilibration.
    """
    forces, places = _point_forces(installed, problem, states)
    whole, names = WHOLE_PILE[placed.kinematics], placed.part_names
    parts = {
        stage: whole * part_forces(force, part, len(names))
        for (stage, force), part in zip(
            forces.items(),
            (installed.interface.part, problem.interface_parts, problem.interface_parts),
            strict=True,
        )
    }
    figures = {
        f"pile_{name.replace(' ', '_')}_force_{stage}": Figure(
            float(parts[stage][number, -1]), "N", f"upward soil reaction on the {name}: {stage}"
        )
        for stage in STAGES
        for number, name in enumerate(names)
        if parts["transferred"][number].any()
    }
    total = {stage: of_part.sum(axis=0) for stage, of_part in parts.items()}
    total["mpm"] = whole * np.asarray(installed.pile.reaction)
    figures |= {
        f"pile_reaction_{stage}": Figure(
            float(force[-1]), "N", f"upward soil reaction on the pile: {stage}"
        )
        for stage, force in total.items()
    }
    compared = slice(0 if dimension(placed.kinematics) == 3 else -1, None)  # of a half: vertical
    figures |= _change_figures(
        "reaction",
        {stage: force[compared] for stage, force in total.items()},
        parts["mpm"][:, compared],
        options,
    )
    if dimension(placed.kinematics) == 3:
        figures |= _moment_figures(forces, places, installed.interface.part, options)
        figures |= _shaft_figures(installed, names.index("shaft"), problem, states[1], options)
    return figures


def _shaft_figures(
    installed: InstalledState,
    shaft: int,
    problem: EquilibriumProblem,
    balanced: FEState,
    options: HandoffOptions,
) -> dict[str, Figure]:
    """Return how far contact pressure and shear along the shaft are from the installation's."""
    places = FEInterfacePoints(
        problem.interface_positions,
        problem.interface_normals,
        problem.interface_areas,
        problem.interface_parts,
    )
    traction, size = balanced.interface_traction, options.size_at_pile
    profiles = shaft_profiles(installed.interface, places, traction, shaft, size)
    pressure, shear = profile_differences(profiles)
    what = "along the shaft, means around it, finite elements against material points, relative L2"
    return {
        "shaft_pressure_difference": Figure(
            pressure, "", f"contact pressure {what}", MAX_PRESSURE_DIFFERENCE
        ),
        "shaft_shear_difference": Figure(shear, "", f"shear {what}"),
    }


def _point_forces(
    installed: InstalledState, problem: EquilibriumProblem, states: tuple[FEState, FEState]
) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Return forces (n, dim) in N and places (n, dim) in m of the interface points by stage."""
    place = problem.interface_positions
    on_fe = [
        forces_on_pile(
            state.interface_traction, problem.interface_normals, problem.interface_areas, place
        )
        for state in states
    ]
    forces = dict(zip(STAGES, (force_on_pile(installed.interface), *on_fe), strict=True))
    places = dict(zip(STAGES, (installed.interface.position, place, place), strict=True))
    return forces, places


def _moment_figures(
    forces: dict[str, np.ndarray],
    places: dict[str, np.ndarray],
    part: np.ndarray,
    options: HandoffOptions,
) -> dict[str, Figure]:
    """Return the torque on the pile, and how far its moment is from that in material points."""
    moments = {stage: np.cross(places[stage], force) for stage, force in forces.items()}
    total = {stage: moment.sum(axis=0) for stage, moment in moments.items()}
    scale = part_forces(moments["mpm"], part, int(part.max()) + 1)
    figures = {
        f"pile_torque_{stage}": Figure(
            float(moment[2]), "N m", f"moment of the soil about the pile axis: {stage}"
        )
        for stage, moment in total.items()
    }
    return figures | _change_figures("moment", total, scale, options)


def _change_figures(
    what: str, total: dict[str, np.ndarray], parts: np.ndarray, options: HandoffOptions
) -> dict[str, Figure]:
    """Return how far a resultant on the pile is from that in material points, at last and before.

    It is measured by the sum of the magnitudes of the ``parts`` (n, dim) of the latter.
    """
    meaning = f"{what} of the soil on the pile, finite elements against material points"
    before, after = (_change(total[stage], total["mpm"], parts) for stage in STAGES[1:])
    return {
        f"pile_{what}_change": Figure(
            after, "", f"{meaning}, over the sum of the parts", options.max_reaction_change
        ),
        f"pile_{what}_change_transferred": Figure(before, "", f"the same: {STAGES[1]}"),
    }


def _change(after: np.ndarray, before: np.ndarray, parts: np.ndarray) -> float:
    """Return |after - before| over the sum of the magnitudes of the ``parts`` (n, dim)."""
    scale = float(np.linalg.norm(parts, axis=1).sum())
    change = float(np.linalg.norm(after - before))
    return change / scale if scale else change


def relaxation_figures(
    placed: PlacedPile,
    problem: EquilibriumProblem,
    states: tuple[FEState, FEState],
    options: HandoffOptions,
) -> dict[str, Figure]:
    """Return what the equilibration takes from the stress around the pile (Engin 2013)."""
    is_near = placed.distance(problem.integration_positions) <= placed.width
    weights = problem.integration_volumes * is_near
    pressures = [
        -float(weights @ np.trace(state.cauchy_stress, axis1=1, axis2=2)) / 3.0 / weights.sum()
        for state in states
    ]
    contact = [
        -float(problem.interface_areas @ state.interface_traction[:, -1])
        / float(problem.interface_areas.sum())
        for state in states
    ]
    figures = {}
    for stage, near, on_pile in zip(STAGES[1:], pressures, contact, strict=True):
        what = "mean pressure in the soil within one pile width"
        figures[f"mean_pressure_near_pile_{stage}"] = Figure(near, "Pa", f"{what}: {stage}")
        what = "mean contact pressure on the pile"
        figures[f"contact_pressure_{stage}"] = Figure(on_pile, "Pa", f"{what}: {stage}")
    figures["mean_pressure_relaxation"] = Figure(
        relative_difference(pressures[1], pressures[0]),
        "",
        "change of the mean pressure within one pile width in the equilibration",
        options.max_relaxation,
    )
    return figures
