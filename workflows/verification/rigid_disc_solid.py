"""Rigid disc on an elastic half space, in space: vertical, horizontal, rocking and torsion.

A quarter of a cylinder of 200 radii is modelled, held at its side and bottom; the disc is a polygon
of the area of the circle.  The horizontal load meets the assumption of its closed form, that the
disc transfers no normal stress to the ground.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic
from install_mpm.conventions import Kinematics, Unit
from install_mpm.ground import Ground
from service_fe.problem import ServiceProblem
from service_fe.rigid_pile import held, rigid_motion
from workflows.verification.problem import Outcome, Problem, relative
from workflows.verification.references.discs import disc_stiffness
from workflows.verification.round_ground import (
    QUARTERS,
    Parity,
    equal_area,
    round_mesh,
    round_solid,
    supports,
    surface_within,
)

SECTORS = 5
RADII = (
    0.0, 0.3, 0.55, 0.75, 0.88, 0.95, 0.985, 1.0, 1.015, 1.05, 1.12, 1.25, 1.5, 2.0, 3.0, 5.0, 10.0,
    25.0, 70.0, 200.0,
)  # fmt: skip
DEPTHS = (0.0, 0.015, 0.05, 0.11, 0.22, 0.4, 0.7, 1.1, 1.8, 3.0, 6.0, 14.0, 45.0, 200.0)
"""Lines of the mesh over the radius of the disc, closest at its edge."""

TOLERANCE = 0.02


class Load(NamedTuple):
    """One way to move the disc."""

    name: str
    motion: int
    """Number of the rigid motion, see ``rigid_pile``."""
    in_x: Parity
    in_y: Parity
    held: tuple[int, ...]
    """Components of displacement that the disc gives to the ground."""


LOADS = (
    Load("V / G R, smooth", 2, "even", "even", (2,)),
    Load("V / G R, bonded", 2, "even", "even", (0, 1, 2)),
    Load("H / G R", 0, "odd", "even", (0, 1)),
    Load("rocking / G R^3", 4, "odd", "even", (2,)),
    Load("torsion / G R^3", 5, "odd", "odd", (0, 1)),
)


def pd1(
    *,
    R: Annotated[float, Unit("m")] = 1.0,
    G: Annotated[float, Unit("Pa")] = 1e6,
    nu: float = 0.3,
) -> Outcome:
    """A rigid disc of radius R is moved on an elastic half space in all its degrees of freedom.

    V = 4 G R / (1 - nu) smooth and 4 G R ln(3 - 4 nu) / (1 - 2 nu) bonded, H = 8 G R / (2 - nu),
    rocking 8 G R^3 / (3 (1 - nu)), torsion 16 G R^3 / 3.  The ground is a cylinder of 200 R by
    200 R.
    """
    exact = disc_stiffness(radius=R, shear_modulus=G, poissons_ratio=nu)
    references = (
        exact.vertical, exact.vertical_bonded, exact.horizontal, exact.rocking, exact.torsional,
    )  # fmt: skip
    polygon = R * equal_area(4 * SECTORS)
    solid = round_solid(polygon * np.array(RADII), R * np.array(DEPTHS), SECTORS)
    mesh = round_mesh(solid)
    on_disc = np.zeros(len(mesh.nodes), dtype=bool)
    on_disc[np.unique(mesh.facet_nodes[surface_within(mesh, polygon)])] = True
    checks, histories = [], []
    for load, reference in zip(LOADS, references, strict=True):
        is_fixed = supports(mesh, load.in_x, load.in_y)
        is_fixed[np.ix_(on_disc, load.held)] = True
        problem = ServiceProblem(
            mesh, Ground(0.0, 1.0, HenckyElastic(2.0 * (1.0 + nu) * G, nu)),
            CoulombInterface(1.0, 1.0), is_fixed=is_fixed, kinematics=Kinematics.THREE_D,
        )  # fmt: skip
        unit = np.where(on_disc[:, None], rigid_motion(mesh.nodes)[:, :, load.motion], 0.0)
        amplitude = 1e-3
        step = problem.solve(
            problem.wished_in_place_state(), held(3), support_motion=amplitude * unit
        )
        stiffness = QUARTERS * float((step.support_reaction * unit).sum()) / amplitude
        scale = G * R if load.motion < 3 else G * R**3
        checks.append(relative(load.name, stiffness / scale, reference / scale, TOLERANCE))
        histories.append(step.residuals)
    return Outcome(tuple(checks), residual_histories=tuple(histories))


PROBLEM = Problem("PD1", "Rigid disc on a half space, in space", pd1, is_quick=False)
