"""A block of Mohr-Coulomb soil under its own weight, between rollers: every step converges.

A published open implementation of the material point method does not get through this problem: with
Mohr-Coulomb soil its iterations stall, and elements are inverted.  The block is as high as wide,
supported on its base and sides, and its gravity grows in equal steps.  Its cross section cannot
change, so the vertical Cauchy stress is - rho g (H - Y), Y the original height, whatever the soil;
with nu / (1 - nu) below the ratio K_a the soil yields below the depth at which cohesion ends.

Both horizontal stresses are then K_a times the vertical one: the state is on an edge.  There, with
the modulus M of one-dimensional compression and the tangent G_t of shear, soil without dilation has
the acoustic determinant

    det Q(n) = M G_t (K_a n_x^2 - n_y^2) (n_x^2 - n_y^2) ,

negative for n_y^2 between K_a n_x^2 and n_x^2: the equations are not elliptic, and any disturbance
of the one-dimensional state grows from step to step until neighbouring points leave the edge in
turn and the iterations stall.  So the discretisation must not disturb it.  Squares that are cut by
both diagonals into linear triangles have all their nodes on planes of symmetry, where nothing is
left but round-off: n = 50 takes three iterations a step with c = 5 kPa and with 1 kPa.  Linear
triangles with one diagonal a square, the mesh of that implementation, load the two upper corners
differently.  With n = 10 every step converges on it too, in at most five iterations (six with c = 1
kPa), but with n = 50 it stalls in step 6 (4): lost ellipticity has no length, and the finer the
mesh the shorter and faster the waves that grow.  Quadratic triangles integrate the kink of the
horizontal stress at the depth of first yield with an error.  A body of revolution has no planes of
symmetry; there the mesh is quadratic.  c = 5 kPa takes at most six iterations with n = 50; c = 1
kPa, which yields nearly everywhere in the first step, with n = 30 in 20 steps, but ten with n = 50
in 10 steps, however the line search is done.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from install_mpm.constitutive.frictional import PLASTIC_SHEAR
from install_mpm.constitutive.parameters import MohrCoulomb
from install_mpm.conventions import GRAVITY, Kinematics, Unit
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import Ground
from install_mpm.options import Numerics
from workflows.verification.body import Body, advance, make_body
from workflows.verification.gravity import with_weight_of_points
from workflows.verification.problem import (
    Check,
    Outcome,
    Problem,
    Series,
    at_most,
    relative,
)
from workflows.verification.rectangle import rectangle_mesh

Stress = Annotated[float, Unit("Pa")]
Angle = Annotated[float, Unit("rad")]
DEGREES_30 = float(np.deg2rad(30.0))
TOLERANCE = 1e-9
MOST_ITERATIONS = 6


def weight_block(
    soil: MohrCoulomb, height: float, weight: float, n: int, steps: int, kinematics: Kinematics
) -> tuple[Body, np.ndarray, tuple[tuple[float, ...], ...]]:
    """Return the loaded block, the reaction (n_nodes, 2) in N of its supports, and residuals.

    Parameters
    ----------
    height
        Height and width (in axisymmetry radius) in m.
    weight
        Unit weight in N/m^3 of the undeformed soil.
    n
        Distances of nodes per side, even in axisymmetry: a quadratic triangle has two.

    Raises
    ------
    ProblemNotSolvedError
        If a step does not converge; none is repeated or cut.
    """
    is_plane = kinematics == Kinematics.PLANE_STRAIN
    lines = np.linspace(0.0, height, (n if is_plane else n // 2) + 1)
    mesh = rectangle_mesh(lines, lines, is_crossed=is_plane, is_quadratic=not is_plane)
    is_soil = np.ones(len(mesh.cell_nodes), dtype=bool)
    body = with_weight_of_points(
        make_body(mesh, Ground(0.0, 1.0, soil), kinematics=kinematics, is_soil=is_soil,
                  numerics=Numerics(tolerance=TOLERANCE))
    )  # fmt: skip
    x, y = mesh.nodes.T
    supports = np.column_stack([(x == 0.0) | (x == height), y == 0.0])
    prescribed = Prescribed(supports, np.zeros_like(mesh.nodes))
    reaction, histories = np.zeros_like(mesh.nodes), []
    for number in range(1, steps + 1):
        # the step knows one strength of gravity, so the points become heavier instead
        mass = body.points.volume / body.points.volume_ratio * weight / GRAVITY * number / steps
        body = body._replace(points=body.points._replace(mass=mass))
        body, result = advance(body, prescribed, name=f"block, step {number}")
        reaction = result.equilibrium.reaction
        histories.append(tuple(result.equilibrium.newton.residuals))
    return body, reaction, tuple(histories)


def _outcome(
    soil: MohrCoulomb, height: float, weight: float, n: int, steps: int, kinematics: Kinematics
) -> Outcome:
    body, reaction, histories = weight_block(soil, height, weight, n, steps, kinematics)
    points = body.points
    original = (points.position - points.displacement)[:, 1]
    stress = points.kirchhoff_stress[:, 1, 1] / points.volume_ratio
    exact = -weight * (height - original)
    mass = points.mass
    error = float((np.abs(stress - exact) * mass).sum() / mass.sum() / (weight * height))
    on_base = body.mesh.nodes[:, 1] == 0.0
    carried = float(reaction[on_base, 1].sum())
    order = np.argsort(original)[:: max(1, len(original) // 400)]
    iterations = max(len(history) - 1 for history in histories)
    checks: list[Check] = [
        at_most(f"Newton iterations of a step, largest of {steps} steps", iterations,
                MOST_ITERATIONS),
        relative("reaction of the base, N", carried, mass.sum() * GRAVITY, 1e-8),
        at_most("mean error of the vertical stress over rho g H", error, 2.0 / n),
    ]  # fmt: skip
    curve = Series(
        "vertical stress", "height of the original place, m", "Cauchy stress, Pa",
        tuple(original[order]), tuple(stress[order]), tuple(exact[order]),
    )  # fmt: skip
    remark = f"{_share_that_yielded(body):.0%} of the points have yielded"
    return Outcome(tuple(checks), (curve,), (remark,), histories)


def _share_that_yielded(body: Body) -> float:
    return float((body.points.state_variables[:, PLASTIC_SHEAR] > 0.0).mean())


def kratos_block(
    *,
    H: Annotated[float, Unit("m")] = 10.0,
    rho_g: Annotated[float, Unit("N/m^3")] = 20e3,
    E: Stress = 10e6,
    nu: float = 0.2,
    c: Stress = 5e3,
    phi: Angle = DEGREES_30,
    psi: Angle = 0.0,
    n: int = 50,
    steps: int = 10,
) -> Outcome:
    """A block of Mohr-Coulomb soil settles under its own weight, in plane strain.

    ``n`` distances of nodes per side; no step may be repeated or cut.
    """
    soil = MohrCoulomb(E, nu, c, phi, psi)
    return _outcome(soil, H, rho_g, n, steps, Kinematics.PLANE_STRAIN)


def kratos_cylinder(
    *,
    H: Annotated[float, Unit("m")] = 10.0,
    rho_g: Annotated[float, Unit("N/m^3")] = 20e3,
    E: Stress = 10e6,
    nu: float = 0.2,
    c: Stress = 5e3,
    phi: Angle = DEGREES_30,
    psi: Angle = 0.0,
    n: int = 50,
    steps: int = 10,
) -> Outcome:
    """A cylinder of Mohr-Coulomb soil settles under its own weight; see ``kratos_block``."""
    soil = MohrCoulomb(E, nu, c, phi, psi)
    return _outcome(soil, H, rho_g, n, steps, Kinematics.AXISYMMETRIC)


PROBLEMS = (
    Problem("KRATOS-BLOCK", "Block of sand under its weight", kratos_block, is_quick=False),
    Problem(
        "KRATOS-BLOCK-ROUND", "Cylinder of sand under its weight", kratos_cylinder, is_quick=False
    ),
)
