"""PA4 and PA5: a disc of soil turns as a rigid body, and the mesh turns with it.

PA4: without stress, once round in steps of 5 degrees; all nodes are driven, because without any
force there is nothing that Newton's method could be measured against.  PA5: with initial stress;
only the rim is driven, and the stress has to turn with the soil.  The first trial of a step is the
rigid motion: it has to be in equilibrium as it is.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from install_mpm.constitutive.parameters import HenckyElastic
from install_mpm.conventions import Unit
from install_mpm.equilibrium import Prescribed
from install_mpm.geostatic import elastic_strain_of
from install_mpm.ground import Ground
from install_mpm.material_points import cauchy_stress
from install_mpm.mesh_motion import rotate, rotate_clockwise
from install_mpm.options import Numerics
from install_mpm.step import StepResult
from workflows.verification.body import Body, advance, make_body
from workflows.verification.disc_meshes import circle, disc_mesh, nodes_on
from workflows.verification.problem import Check, Outcome, Problem, at_most
from workflows.verification.references.rotated_stress import rotated_stress
from workflows.verification.turned_disc import STEP

SIDES = 24
TURN = 72
"""Steps of 5 degrees once round."""

Length = Annotated[float, Unit("m")]
Stress = Annotated[float, Unit("Pa")]


def stress_free_rotation(*, R: Length = 1.0, E: Stress = 10e3, nu: float = 0.3) -> Outcome:
    """Return what is left of a rotation of 72 x 5 degrees without stress (PA4)."""
    body = _disc(R, HenckyElastic(E, nu))
    start, stress, force = body.points.position, 0.0, 0.0
    for number in range(1, TURN + 1):
        body, result = _turn(body, number, np.ones(len(body.mesh.nodes), dtype=bool))
        stress = max(stress, np.abs(cauchy_stress(body.points)).max())
        force = max(force, np.abs(result.equilibrium.reaction).max())
    drift = np.linalg.norm(body.points.position - start, axis=1).max()
    return Outcome(
        (
            at_most("largest stress over E", stress / E, 1e-10),
            at_most("largest nodal force over E R", force / (E * R), 1e-10),
            at_most("largest drift of a material point over R", drift / R, 1e-10),
            at_most("change of area", abs(body.points.volume.sum() / _area(R) - 1.0), 1e-10),
        )
    )


def stressed_rotation(
    *,
    R: Length = 1.0,
    E: Stress = 10e6,
    nu: float = 0.3,
    sigma_xx: Stress = -100e3,
    sigma_yy: Stress = -50e3,
    tau_xy: Stress = 20e3,
) -> Outcome:
    """Return the stress after rotations of 45 and 90 degrees anticlockwise (PA5)."""
    soil = HenckyElastic(E, nu)
    body = with_stress(_disc(R, soil), soil, (sigma_xx, sigma_yy, tau_xy))
    on_rim = np.zeros(len(body.mesh.nodes), dtype=bool)
    on_rim[nodes_on(body.mesh, circle(R, SIDES))] = True
    scale = max(map(abs, (sigma_xx, sigma_yy, tau_xy)))
    checks: list[Check] = []
    residuals = []
    for number in range(1, 19):
        body, result = _turn(body, number, on_rim)
        residuals.append(tuple(result.equilibrium.newton.residuals))
        if number in (9, 18):
            exact = rotated_stress(sigma_xx, sigma_yy, tau_xy, angle=number * STEP)
            checks += _components(body, exact, scale, 5 * number)
    return Outcome(tuple(checks), residual_histories=tuple(residuals))


def _disc(radius: float, soil: HenckyElastic) -> Body:
    mesh = disc_mesh(circle(radius, SIDES))
    return make_body(
        mesh,
        Ground(0.0, 1.0, soil),
        numerics=Numerics(tolerance=1e-11),
        is_soil=np.ones(len(mesh.cell_nodes), dtype=bool),
    )


def _area(radius: float) -> float:
    """Return the area of the polygon in m^2."""
    return float(0.5 * SIDES * radius**2 * np.sin(2.0 * np.pi / SIDES))


def with_stress(body: Body, soil: HenckyElastic, components: tuple[float, float, float]) -> Body:
    """Return the body with a uniform stress (xx, yy, xy) in plane strain, in Pa."""
    xx, yy, xy = components
    zz = soil.poissons_ratio * (xx + yy)
    stress = np.array([[xx, xy, 0.0], [xy, yy, 0.0], [0.0, 0.0, zz]])
    stresses = np.repeat(stress[None], len(body.points.mass), axis=0)
    points = body.points._replace(
        kirchhoff_stress=stresses,
        elastic_log_strain=elastic_strain_of(soil, stresses, body.points.state_variables),
    )
    return body._replace(points=points)


def _turn(body: Body, number: int, driven: np.ndarray) -> tuple[Body, StepResult]:
    """Return the body after the step ``number``, which turns the nodes ``driven`` by 5 degrees."""
    motion = rotate_clockwise(body.mesh.nodes, -STEP) - body.mesh.nodes
    is_prescribed = np.repeat(driven[:, None], 2, axis=1)
    return advance(
        body._replace(start=motion),
        Prescribed(is_prescribed, np.where(is_prescribed, motion, 0.0)),
        move_mesh=lambda mesh: rotate(mesh, number * STEP),
        name=f"rotation to {5 * number} degrees",
    )


def _components(body: Body, exact: np.ndarray, scale: float, degrees: int) -> list[Check]:
    """Return one check per component of the stress, at the material point that is farthest off."""
    stress = cauchy_stress(body.points)
    checks = []
    for name, (i, j), value in zip(
        ("xx", "yy", "xy"), ((0, 0), (1, 1), (0, 1)), exact, strict=True
    ):
        own = stress[:, i, j]
        worst = float(own[np.abs(own - value).argmax()])
        text = f"stress {name} at {degrees} degrees in Pa (error over the largest component)"
        checks.append(Check(text, worst, float(value), (worst - value) / scale, 1e-8))
    return checks


PROBLEMS = (
    Problem("PA4", "Rigid rotation of a stress-free disc, 72 x 5 degrees", stress_free_rotation,
            is_quick=True),
    Problem("PA5", "Rigid rotation of a stressed disc to 90 degrees", stressed_rotation,
            is_quick=True),
)  # fmt: skip
