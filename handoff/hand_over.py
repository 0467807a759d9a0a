"""Stage 2 on one page: the ground that the installation left becomes a finite-element model."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from handoff.admissible import admissible_state
from handoff.equilibration import EquilibriumProblem, equilibrate
from handoff.fe_mesh import FEMesh, make_mesh
from handoff.fe_state_file import (
    FEIntegrationPoints,
    FEInterfacePoints,
    HandedOffPile,
    HandedOffState,
)
from handoff.interface_transfer import pile_forces
from handoff.options import HandoffOptions
from handoff.quality import Certificate, Evidence, as_json, certify
from handoff.state_transfer import state_map, transfer_state
from handoff.surface import surface_profile
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.ground import GroundProfile, boundary_depths
from install_mpm.options import Box
from install_mpm.pile import WHOLE_PILE, Pile, buried_weight
from install_mpm.state_file import InstalledState


def hand_over(
    installed: InstalledState,
    ground: GroundProfile,
    pile: Pile,
    box: Box,
    interface: CoulombInterface,
    options: HandoffOptions,
    make_problem: Callable[[FEMesh], EquilibriumProblem],
    observe: Callable[[str], None],
) -> tuple[HandedOffState, Certificate]:
    """Return the finite-element model of the installed pile, in equilibrium, and its certificate.

    ``make_problem`` makes the finite-element problem on a mesh; ``observe`` is told what begins.
    The certificate may hold figures beyond their limits (``quality.failed_checks``).

    Raises
    ------
    MeshError
        If the mesh cannot follow the ground surface.
    EquilibrationError
        If the transferred state cannot be brought to equilibrium.
    ValueError
        If the material points are too few, or no soil touches a part of the pile.
    """
    tip_depth, points = float(installed.pile.tip_depth), installed.material_points
    kinematics = installed.kinematics

    observe("mesh")
    surface = surface_profile(points, pile.half_width, options.size_at_pile, kinematics)
    mesh = make_mesh(pile, tip_depth, box, options, surface, boundary_depths(ground))
    problem = make_problem(mesh)

    observe("transfer")
    targets = problem.integration_positions
    chart = state_map(points, pile, tip_depth, targets, options.neighbours, kinematics)
    raw = transfer_state(installed, ground, problem, chart)

    observe("admissibility")
    places = problem.interface_positions
    transferred, corrections = admissible_state(ground, interface, places, raw)

    observe("equilibration")
    balanced, report = equilibrate(problem, transferred, options)

    observe("certificate")
    evidence = Evidence(
        installed=installed,
        ground=ground,
        pile=pile,
        problem=problem,
        options=options,
        state_map=chart,
        corrections=corrections,
        transferred=transferred,
        balanced=balanced,
        report=report,
    )
    certificate = certify(evidence)
    return _handed_off(evidence, mesh, certificate), certificate


def _handed_off(evidence: Evidence, mesh: FEMesh, certificate: Certificate) -> HandedOffState:
    """Return the record of everything that the service stage starts from."""
    problem, state, installed = evidence.problem, evidence.balanced, evidence.installed
    interface = FEInterfacePoints(
        problem.interface_positions,
        problem.interface_normals,
        problem.interface_areas,
        problem.interface_parts,
    )
    kinematics = installed.kinematics
    forces = pile_forces(
        state.interface_traction, interface.normal, interface.area, interface.part, kinematics
    )
    weight = buried_weight(
        evidence.pile, float(installed.pile.tip_depth), kinematics, evidence.ground.water_table
    )
    head_load = sum(forces.values()) / WHOLE_PILE[kinematics] - weight
    return HandedOffState(
        mesh=mesh,
        state=state,
        integration=FEIntegrationPoints(problem.integration_positions, problem.integration_volumes),
        interface=interface,
        pile=HandedOffPile(np.array(installed.pile.tip_depth), np.array(head_load)),
        certificate=as_json(certificate),
        case_text=installed.case_text,
    )
