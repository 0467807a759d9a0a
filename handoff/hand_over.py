"""Stage 2 on one page: the ground that the installation left becomes a finite-element model."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from handoff.admissible import admissible_state
from handoff.equilibration import EquilibriumProblem, equilibrate
from handoff.fe_mesh import FEMesh
from handoff.fe_state_file import (
    FEIntegrationPoints,
    FEInterfacePoints,
    FEState,
    HandedOffPile,
    HandedOffState,
)
from handoff.geostatic import geostatic_state
from handoff.interface_transfer import forces_on_pile
from handoff.options import HandoffOptions
from handoff.placed_pile import PlacedPile
from handoff.quality import Certificate, Evidence, as_json, certify
from handoff.state_transfer import state_map_onto, surface_of, transfer_state
from handoff.surface import surface_profile
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.ground import GroundProfile, boundary_depths
from install_mpm.options import Box
from install_mpm.state_file import InstalledState


def hand_over(
    installed: InstalledState,
    ground: GroundProfile,
    placed: PlacedPile,
    box: Box,
    interface: CoulombInterface,
    options: HandoffOptions,
    make_problem: Callable[[FEMesh], EquilibriumProblem],
    observe: Callable[[str], None],
    once: Callable[[Callable[[], FEMesh]], FEMesh] = lambda make: make(),
) -> tuple[HandedOffState, Certificate]:
    """Return the finite-element model of the installed pile, in equilibrium, and its certificate.

    ``placed`` is the pile at its installed place, ``make_problem`` makes the finite-element problem
    on a mesh; ``observe`` is told what begins.  ``once`` calls what it is given, on one rank alone
    if MPI has several.  The certificate may hold figures beyond their limits
    (``quality.failed_checks``).

    Raises
    ------
    MeshError
        If the mesh cannot follow the ground surface.
    EquilibrationError
        If the transferred state cannot be brought to equilibrium.
    ValueError
        If the material points are too few, or no soil touches a part of the pile.
    """
    points = installed.material_points

    observe("mesh")
    surface = surface_profile(points, placed.half_width, options.size_at_pile, placed.kinematics)
    mesh = once(lambda: placed.mesh(box, options, surface, boundary_depths(ground)))
    problem = make_problem(mesh)

    observe("transfer")
    chart = state_map_onto(problem, points, placed, options)
    raw = transfer_state(installed, ground, placed, problem, chart)

    observe("admissibility")
    places, share = problem.interface_positions, problem.interface_strength_share
    transferred, corrections = admissible_state(ground, interface, places, share, raw)

    observe("equilibration")
    balanced, report = equilibrate(problem, transferred, options, placed.carried(installed))

    observe("certificate")
    evidence = Evidence(
        installed=installed,
        ground=ground,
        placed=placed,
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


def wished_in_place(
    ground: GroundProfile,
    interface: CoulombInterface,
    problem: EquilibriumProblem,
    options: HandoffOptions,
) -> FEState:
    """Return the state of a pile wished in place: admissible and balanced, as a handed-off one is.

    Undisturbed ground balances gravity.  Its traction on the plane facets of a curved surface can
    exceed the slip limit, though, because it has a part along the exact surface.

    Raises
    ------
    EquilibrationError
        If what the slip limit takes away cannot be brought to equilibrium.
    """
    places, share = problem.interface_positions, problem.interface_strength_share
    undisturbed = geostatic_state(
        ground,
        problem.integration_positions,
        places,
        problem.interface_normals,
        problem.interface_facet_normals,
    )
    state, _ = admissible_state(ground, interface, places, share, undisturbed)
    return equilibrate(problem, state, options)[0]


def _handed_off(evidence: Evidence, mesh: FEMesh, certificate: Certificate) -> HandedOffState:
    """Return the record of everything that the service stage starts from."""
    problem, state, placed = evidence.problem, evidence.balanced, evidence.placed
    surface = surface_of(problem)
    forces = forces_on_pile(
        state.interface_traction, surface.normals, surface.areas, surface.positions
    )
    head_load = float(forces[:, -1].sum()) - placed.weight(evidence.ground.water_table)
    return HandedOffState(
        mesh=mesh,
        state=state,
        integration=FEIntegrationPoints(problem.integration_positions, problem.integration_volumes),
        interface=FEInterfacePoints(
            surface.positions, surface.normals, surface.areas, surface.parts
        ),
        pile=HandedOffPile(
            np.array(placed.tip_depth),
            np.array(evidence.installed.pile.rotation),
            np.array(head_load),
            *(np.array(part) for part in placed.rebound(evidence.installed)),
        ),
        certificate=as_json(certificate),
        case_text=evidence.installed.case_text,
    )
