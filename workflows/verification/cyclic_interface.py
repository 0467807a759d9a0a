"""PD9: the interface of the service stage under cycles of relative displacement, in space.

A rigid plate slides on a block whose nodes are held, back and forth in an oblique direction in its
plane, so that both tangential components take part.  The work of a cycle is that of the force on
the plate; its steps end at the corners of the loop, where the path of the force bends.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from handoff.fe_mesh import FacetTag
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic
from install_mpm.conventions import Kinematics, Unit
from install_mpm.ground import Ground
from service_fe.problem import ServiceProblem
from service_fe.rigid_pile import PileControl, n_motions
from workflows.errors import CaseError
from workflows.verification.problem import Outcome, Problem, Series, absolute, relative
from workflows.verification.references.cyclic_interface import dissipation_per_cycle, loop_corners
from workflows.verification.solid_boundary import fe_mesh
from workflows.verification.solid_meshes import box_mesh

DIRECTION = np.radians(25.0)
"""Of the motion in the plane of the plate."""

STEPS = 4
"""Steps between two corners of the loop."""

TOLERANCE = 1e-6


def pd9(
    *,
    ks: Annotated[float, Unit("Pa/m")] = 1e7,
    tau_y: Annotated[float, Unit("Pa")] = 10e3,
    u_a: Annotated[float, Unit("m")] = 5e-3,
    cycles: int = 10,
) -> Outcome:
    """A plate moves back and forth by u_a: 4 tau_y (u_a - tau_y / k_s) per cycle and area are lost.

    The loop of an interface with shear stiffness k_s and strength tau_y is closed.
    """
    if u_a <= tau_y / ks:
        raise CaseError("PD9: u_a: the interface does not slip; take more than tau_y / ks")
    corners, stress = loop_corners(amplitude=u_a, shear_stiffness=ks, shear_strength=tau_y)
    path = [_steps_to(0.0, tau_y / ks), _steps_to(tau_y / ks, u_a)]
    for start, end in zip(np.tile(corners, cycles), np.tile(np.roll(corners, -1), cycles),
                          strict=True):  # fmt: skip
        path.append(_steps_to(start, end))
    place = np.concatenate(path)
    shear, residuals = _slide(ks, tau_y, place)
    n_first, n_cycle = 2 * STEPS, 4 * STEPS
    work = 0.5 * (shear[n_first:] + shear[n_first - 1 : -1]) @ np.diff(place[n_first - 1 :])
    exact = dissipation_per_cycle(amplitude=u_a, shear_stiffness=ks, shear_strength=tau_y)
    last = slice(len(place) - n_cycle - 1, None)
    return Outcome(
        (
            relative("work per cycle and area (J/m^2)", float(work / cycles), exact, TOLERANCE),
            absolute("shear stress at the corners / tau_y, largest error",
                     float(np.abs(shear[last][::STEPS] - np.append(stress, stress[0])).max()
                           / tau_y), 0.0, TOLERANCE),
            absolute("opening of the loop in all cycles / tau_y",
                     float((shear[-1] - shear[n_first - 1]) / tau_y), 0.0, TOLERANCE),
        ),
        (Series("Last cycle", "relative displacement (mm)", "shear stress (kPa)",
                tuple(1e3 * place[last]), tuple(1e-3 * shear[last])),),
        residual_histories=residuals,
    )  # fmt: skip


def _steps_to(start: float, end: float) -> np.ndarray:
    return np.linspace(start, end, STEPS + 1)[1:]


def _slide(
    stiffness: float, strength: float, place: np.ndarray
) -> tuple[np.ndarray, tuple[tuple[float, ...], ...]]:
    """Return the shear stress in Pa at each displacement of ``place`` (m), and the residuals."""
    lines = np.linspace(0.0, 1.0, 3)
    block = fe_mesh(box_mesh(lines, lines, lines - 1.0), _tags)
    problem = ServiceProblem(
        block,
        Ground(0.0, 1.0, HenckyElastic(1.0, 0.0)),
        CoulombInterface(10.0 * stiffness, stiffness, cohesion=strength),
        is_fixed=np.ones(block.nodes.shape, dtype=bool),
        kinematics=Kinematics.THREE_D,
        normals=lambda facets: np.tile([0.0, 0.0, 1.0], (len(facets.parts), 1)),
    )
    along = np.zeros(n_motions(3))
    along[:2] = np.cos(DIRECTION), np.sin(DIRECTION)
    state, shear, residuals = problem.wished_in_place_state(), [], []
    for motion in np.diff(place, prepend=0.0):
        prescribed = np.zeros(len(along), dtype=bool)
        step = problem.solve(state, PileControl(prescribed, motion * along, 0.0 * along))
        state = step.state
        shear.append(float(step.pile_load @ along) / problem.interface_areas.sum())
        residuals.append(step.residuals)
    return np.array(shear), tuple(residuals)


def _tags(centres: np.ndarray) -> np.ndarray:
    """Return the tags of the block: the plate lies on its top."""
    tags = np.full(len(centres), int(FacetTag.SIDE))
    tags[np.abs(centres[:, 2]) < 1e-9] = FacetTag.PILE_BASE
    return tags


PROBLEM = Problem("PD9", "Cycles of an interface in space", pd9, is_quick=True)
