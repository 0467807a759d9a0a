"""PC1 on a mesh of tetrahedra that is cut open along the plate: torque and force on its two faces.

A pile whose plate the mesh holds as a surface is screwed in at its pitch, in soil so stiff that it
stays behind, through mesh, interface and steps of an installation.  The closed form is that of the
shear traction; normal traction, of soil that the tip pushes down, is left out.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic
from install_mpm.conventions import Unit
from install_mpm.ground import Ground
from install_mpm.options import Box, Numerics, ScrewMeshOptions
from install_mpm.screw_installation import accept, next_step, step_to
from install_mpm.screw_path import START
from install_mpm.screw_pile import LOWER_FACE, UPPER_FACE, Helix, ScrewPile, first_part
from install_mpm.screw_pile_mesh import generate_screw_mesh
from install_mpm.screw_programme import Phase, ScrewProgramme, phase_motion, rim_travel
from install_mpm.screw_setup import geostatic_state, set_up
from workflows.verification.body import ProblemNotSolvedError
from workflows.verification.problem import Check, Outcome, Problem, at_most
from workflows.verification.thin_helix import closed_form_checks

STEPS, STEP = 2, np.deg2rad(2.5)
MODULUS_OVER_STRENGTH, POISSON = 1e4, 0.3
STICKING_SHARE = 1e-3
"""Slip at which the interface yields, over the travel of the rim in a step."""
NORMAL_OVER_SHEAR = 0.01
"""Stiffness of the interface: see PC1, the chords of the helices close the gap a little."""
THICKNESS = 0.03
"""Over the diameter; of no account, it is not in the mesh."""

Length = Annotated[float, Unit("m")]


def surface_plate(
    *,
    D: Length = 1.0,
    d: Length = 0.5,
    p: Length = 0.33,
    su: Annotated[float, Unit("Pa")] = 10e3,
    alpha: float = 1.0,
) -> Outcome:
    """Return torque and force on both faces at the pitch p and half of it."""
    checks: list[Check] = []
    torques = []
    for pitch in (p, 0.5 * p):
        torque, force = _resistance(Helix(D, pitch, THICKNESS * D, 0.25 * D, plate="surface"),
                                    d, alpha * su)  # fmt: skip
        torques.append(torque)
        checks += closed_form_checks((D, d, pitch), alpha * su, torque, force)
    spread = max(torques) / min(torques) - 1.0
    checks.append(at_most("larger over smaller torque of both pitches, less 1", spread, 0.01))
    return Outcome(tuple(checks))


def _resistance(helix: Helix, shaft: float, strength: float) -> tuple[float, float]:
    """Return torque in N m and upward force in N of shear on both faces after some steps."""
    diameter = helix.diameter
    pile = ScrewPile(shaft, 1.2 * diameter, (helix,), 0.0)
    box = Box(2.75 * diameter, 3.0 * diameter, 0.5 * diameter)
    sizes = ScrewMeshOptions(
        0.12 * diameter, 0.2 * diameter, 0.25 * diameter, 1.2 * diameter, 0.05 * diameter
    )
    stiffness = strength / (STICKING_SHARE * STEP * helix.radius)
    law = CoulombInterface(NORMAL_OVER_SHEAR * stiffness, stiffness, cohesion=strength)
    soil = HenckyElastic(MODULUS_OVER_STRENGTH * strength, POISSON)
    turn = Phase("in", 1.0, 1.0)
    travel = rim_travel(pile, phase_motion(pile, turn))
    programme = ScrewProgramme((turn,), travel * STEP / (2.0 * np.pi))
    mesh = generate_screw_mesh(pile, box, sizes)
    problem = set_up(Ground(0.0, 1.0, soil), pile, law, box, programme, Numerics(), mesh)
    state = geostatic_state(problem, mesh, sizes, "")
    target = START
    for number in range(STEPS + 1):  # the first one moves nothing
        result = step_to(problem, state, target)
        if not result.is_converged:
            raise ProblemNotSolvedError(f"plate as a surface: step {number} does not converge")
        state = accept(problem, state, result, target)
        following = next_step(problem, state)
        assert following is not None  # the turn of the programme is longer than all steps
        target = following
    faces = [first_part(0) + face for face in (LOWER_FACE, UPPER_FACE)]
    contact = result.equilibrium.contact
    on_faces = np.isin(state.interface.part, faces)[:, None]
    shear = np.where(on_faces, contact.force - contact.normal_force, 0.0)
    torque = float(np.cross(contact.position, shear)[:, 2].sum())
    return torque, float(shear[:, 2].sum())


PROBLEM = Problem(
    "PC1-PLATE", "Thin helix in a mesh that is cut open along it", surface_plate, False
)
