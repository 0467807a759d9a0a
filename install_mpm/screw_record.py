"""What a load step of a screw pile installation leaves in the history: resultants and work."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm.background_mesh import cell_quality
from install_mpm.edge_resistance import NOT_STATED, edge_resistance
from install_mpm.equilibrium import StepEquilibrium
from install_mpm.far_field import far_field_mismatch
from install_mpm.newton import convergence_order
from install_mpm.pile import rigid_displacement
from install_mpm.screw_path import Target
from install_mpm.screw_pile import Helix, ScrewPile, edge_thickness, part_names
from install_mpm.screw_programme import Pose, advancement_ratio, rim_travel
from install_mpm.screw_setup import ScrewInstallation
from install_mpm.state_file import InstalledState
from install_mpm.step import StepResult
from install_mpm.stress_quality import cells_near, pressure_scatter


class Work(NamedTuple):
    """Terms of the power balance of a step in J, with the forces at its end.

    The rig drives, interface and soil take up, the weight of the soil drives or resists; what is
    left over is the error of the balance.
    """

    rig: float
    interface: float
    soil: float
    weight: float


def work_of_step(state: InstalledState, equilibrium: StepEquilibrium) -> Work:
    """Return the work of a step: forces at its end on the displacements of the step."""
    contact, start = equilibrium.contact, state.interface.position
    pile, soil = rigid_displacement(equilibrium.motion, start), contact.position - start
    return Work(
        rig=-float((contact.force * pile).sum()),
        interface=-float((contact.force * (pile - soil)).sum()),
        soil=float((equilibrium.internal_force * equilibrium.displacement).sum()),
        weight=float((equilibrium.external_force * equilibrium.displacement).sum()),
    )


def history_row(
    problem: ScrewInstallation,
    state: InstalledState,
    result: StepResult,
    target: Target,
    pose: Pose,
) -> dict[str, object]:
    """Return the history of an accepted step to ``target``, which ended at ``pose``."""
    equilibrium, newton = result.equilibrium, result.equilibrium.newton
    work = work_of_step(state, equilibrium)
    moved = Pose(
        pose.advance - float(state.pile.penetration), pose.rotation - float(state.pile.rotation)
    )
    is_release = target.phase == len(problem.programme.phases)
    edges = edge_resistance(problem.pile, problem.ground, problem.law, pose.advance, moved)
    return {
        "travel": float(state.history.travel[-1:].sum()) + rim_travel(problem.pile, moved),
        "penetration": pose.advance,
        "rotation": pose.rotation,
        "advancement_ratio": advancement_ratio(problem.pile, moved),
        "release_share": target.share if is_release else 0.0,
        "phase": target.phase,
        "phase_share": target.share,
        **_resultants(problem, equilibrium, pose),
        **_far_field(state, equilibrium),
        **(NOT_STATED if is_release else edges)._asdict(),
        "rig_work": work.rig,
        "interface_work": work.interface,
        "soil_work": work.soil,
        "weight_work": work.weight,
        "iterations": len(newton.residuals) - 1,
        "residual": newton.residuals[-1],
        "convergence_order": convergence_order(newton.residuals),
        "cuts": int(state.control.cuts),
        "smallest_cell_quality": cell_quality(result.mesh).min(),
        "smallest_volume_ratio": result.points.volume_ratio.min(),
        "largest_volume_ratio": result.points.volume_ratio.max(),
        "pressure_scatter": _scatter(problem, result),
        "residual_history": newton.residuals,
        **result.counts._asdict(),
    }


def _scatter(problem: ScrewInstallation, result: StepResult) -> float:
    """Return the scatter of the pressure in Pa within a diameter of the pile."""
    near = cells_near(result.mesh, result.equilibrium.contact.position, problem.pile.width)
    return pressure_scatter(result.points, near, problem.gradient)


def _resultants(
    problem: ScrewInstallation, equilibrium: StepEquilibrium, pose: Pose
) -> dict[str, object]:
    """Return the six resultants on the pile, torque and vertical force by part."""
    pile, contact = problem.pile, equilibrium.contact
    moment = np.cross(contact.position, contact.force)
    normal_moment = np.cross(contact.position, contact.normal_force)
    part = np.repeat(problem.part, len(problem.model.elements.weights))
    n_parts = len(part_names(pile))

    def by_part(values: np.ndarray) -> np.ndarray:
        return np.bincount(part, values, n_parts)

    crowd_force, torque = rig_loads(pile, equilibrium, pose)
    return {
        "crowd_force": crowd_force,
        "torque": torque,
        "lateral_force": contact.force[:, :2].sum(axis=0),
        "overturning_moment": moment[:, :2].sum(axis=0),
        "part_torque": pile.sense * by_part(moment[:, 2]),
        "part_normal_torque": pile.sense * by_part(normal_moment[:, 2]),
        "part_force": by_part(contact.force[:, 2]),
    }


def rig_loads(pile: ScrewPile, equilibrium: StepEquilibrium, pose: Pose) -> tuple[float, float]:
    """Return crowd force in N and torque in N m that the rig applies at the end of a step."""
    contact = equilibrium.contact
    resistance = float(contact.force[:, 2].sum())
    # soil resists a right-handed pile, which turns by negative angles, with a positive moment
    moment = float(np.cross(contact.position, contact.force)[:, 2].sum())
    return resistance - weight_of(pile, pile.embedment + pose.advance), pile.sense * moment


def _far_field(state: InstalledState, equilibrium: StepEquilibrium) -> dict[str, object]:
    """Return how far the resultants on the pile are from what supports and weight say."""
    end = state.background_mesh.nodes + equilibrium.displacement
    loads = equilibrium.reaction + equilibrium.external_force
    mismatch = far_field_mismatch(equilibrium.contact, end, loads)
    return {"far_force_mismatch": mismatch.force, "far_moment_mismatch": mismatch.moment}


def weight_of(pile: ScrewPile, tip_depth: float) -> float:
    """Return the weight in N of the pile below the surface."""
    shaft = np.pi * pile.shaft_radius**2 * (tip_depth - 2.0 / 3.0 * pile.tip_length)
    return float(pile.unit_weight * (shaft + sum(plate_volume(pile, h) for h in pile.helices)))


def plate_volume(pile: ScrewPile, helix: Helix) -> float:
    """Return the volume in m^3 that the mesh leaves out for a plate outside the shaft.

    That of rounded edges is a series in their thickness, short of terms of fourth order.
    """
    annulus = (helix.radius**2 - pile.shaft_radius**2) / 2.0
    thinned = 0.0
    if helix.edge_thickness is not None:
        thinned = (helix.thickness - helix.edge_thickness) * helix.taper_angle
    noses = 0.0
    if helix.edges == "rounded":
        half, product = edge_thickness(helix) / 2.0, pile.shaft_radius * helix.radius
        width = helix.radius - pile.shaft_radius  # between the cylinders of shaft and rim
        noses = np.pi * half**2 * width * (1.0 + half**2 / (8.0 * product))
    return float(annulus * (helix.meshed_thickness * helix.winding - thinned) + noses)
