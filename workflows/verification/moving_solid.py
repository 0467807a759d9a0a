"""PA4, PA5 and PA6 in space: rigid rotation of a body, and a mesh that moves through soil at rest.

The body of PA4 and PA5 turns about a tilted axis, and its mesh with it.  In PA6 a closed prism is
full of soil under a uniform stress; the mesh inside turns and goes down as with a screw pile,
tapers to the wall and is wound back by whole sides of it.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.constitutive.parameters import HenckyElastic
from install_mpm.conventions import Unit
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import Ground
from install_mpm.material_points import MaterialPoints, cauchy_stress
from install_mpm.mesh_motion import ScrewZones, screw
from install_mpm.options import Numerics
from install_mpm.step import StepResult
from workflows.verification.body import Body, advance, make_body
from workflows.verification.problem import Check, Outcome, Problem, at_most
from workflows.verification.solid_meshes import ring_mesh
from workflows.verification.uniform_stress import with_stress

SIDES = 8
STEP = np.deg2rad(5.0)
AXIS = np.array([1.0, 2.0, 2.0]) / 3.0
DENSITY = 1e-9
"""In kg/m^3, for the statement on mass: the weight is below round-off of the stress."""
UNCHANGED = 1e-8
RIGID = 0.4
"""Height over R, above and below the middle, within which the mesh of PA6 moves as a rigid body."""
TIGHT = Numerics(tolerance=1e-11)

Length = Annotated[float, Unit("m")]
Stress = Annotated[float, Unit("Pa")]


def stress_free_rotation(
    *, R: Length = 1.0, E: Stress = 10e3, nu: float = 0.3, steps: int = 72
) -> Outcome:
    """Return what is left of a rotation by steps of 5 degrees without stress."""
    body = _cylinder(R, HenckyElastic(E, nu))
    start, stress, force = body.points, 0.0, 0.0
    for number in range(1, steps + 1):
        body, result = _turn(body, number, np.ones(len(body.mesh.nodes), dtype=bool))
        stress = max(stress, np.abs(cauchy_stress(body.points)).max())
        force = max(force, np.abs(result.equilibrium.reaction).max())
    drift = body.points.position - start.position @ _rotation(steps).T
    volume = body.points.volume.sum() / start.volume.sum() - 1.0
    return Outcome(
        (
            at_most("largest stress over E", stress / E, 1e-10),
            at_most("largest nodal force over E R^2", force / (E * R**2), 1e-10),
            at_most("largest distance of a material point from its circle over R",
                    np.linalg.norm(drift, axis=1).max() / R, 1e-10),
            at_most("change of volume", abs(volume), 1e-10),
        )
    )  # fmt: skip


def stressed_rotation(
    *,
    R: Length = 1.0,
    E: Stress = 10e6,
    nu: float = 0.3,
    sigma_v: Stress = -100e3,
    sigma_h: Stress = -50e3,
    tau: Stress = 20e3,
    steps: int = 18,
) -> Outcome:
    """Return how far the stress is from the one turned with the body; only its surface is driven.

    sigma_v and sigma_h are the vertical and horizontal stress, tau all three shear stresses.
    """
    soil, stress = HenckyElastic(E, nu), _stress(sigma_v, sigma_h, tau)
    body = with_stress(_cylinder(R, soil), soil, stress)
    residuals, error = [], 0.0
    for number in range(1, steps + 1):
        body, result = _turn(body, number, _is_on_surface(body.mesh))
        residuals.append(tuple(result.equilibrium.newton.residuals))
        exact = _rotation(number) @ stress @ _rotation(number).T
        error = max(error, np.abs(cauchy_stress(body.points) - exact).max())
    quantity = f"largest error of stress up to {5 * steps} degrees over its largest component"
    return Outcome(
        (at_most(quantity, error / np.abs(stress).max(), UNCHANGED),),
        residual_histories=tuple(residuals),
    )


def moving_mesh(
    *,
    R: Length = 2.0,
    E: Stress = 10e6,
    nu: float = 0.3,
    sigma_v: Stress = -100e3,
    sigma_h: Stress = -50e3,
    tau: Stress = 20e3,
    advance_ratio: float = 0.4,
    steps: int = 12,
) -> Outcome:
    """Return what a mesh that turns by 10 degrees a step changes in soil at rest.

    It goes down by ``advance_ratio`` R in all.

    Raises
    ------
    ValueError
        If the mesh above or below its rigid part would fold.
    """
    if abs(advance_ratio) >= 1.0 - RIGID:
        raise ValueError(
            f"advance_ratio {advance_ratio:g} folds the mesh: give less than {1.0 - RIGID:g}, the"
            " height over R of its deforming parts"
        )
    soil, stress = HenckyElastic(E, nu), _stress(sigma_v, sigma_h, tau)
    body = with_stress(_cylinder(R, soil), soil, stress)
    body = body._replace(points=body.points._replace(mass=DENSITY * body.points.volume))
    start, worst, residuals = body.points, _Change(), []
    for number in range(1, steps + 1):
        body, result = _move_mesh(body, R, number / steps * advance_ratio * R, 2.0 * number * STEP)
        worst = worst.and_of(body, result, start, stress)
        residuals.append(tuple(result.equilibrium.newton.residuals))
    return Outcome(worst.checks(R), residual_histories=tuple(residuals))


class _Change(NamedTuple):
    """Largest changes so far."""

    outside: float = 0.0
    motion: float = 0.0
    stress: float = 0.0
    force: float = 0.0
    mass: float = 0.0
    volume: float = 0.0

    def and_of(
        self, body: Body, result: StepResult, start: MaterialPoints, stress: np.ndarray
    ) -> _Change:
        """Return the largest changes with those of a step."""
        points = body.points
        error = np.abs(cauchy_stress(points) - stress).max() / np.abs(stress).max()
        own = (
            result.counts.projected_points,
            np.abs(points.displacement).max(),
            error,
            result.equilibrium.newton.residuals[0],
            abs(points.mass.sum() / start.mass.sum() - 1.0),
            abs(points.volume.sum() / start.volume.sum() - 1.0),
        )
        return _Change(*(float(max(pair)) for pair in zip(self, own, strict=True)))

    def checks(self, radius: float) -> tuple[Check, ...]:
        """Return the checks that nothing has changed."""
        return (
            at_most("points outside the mesh", self.outside, 0.0),
            at_most("motion of the material points over R", self.motion / radius, UNCHANGED),
            at_most("change of stress over its largest component", self.stress, UNCHANGED),
            at_most("out-of-balance force over support forces", self.force, UNCHANGED),
            at_most("relative change of mass", self.mass, UNCHANGED),
            at_most("relative change of volume", self.volume, UNCHANGED),
        )


def _stress(vertical: float, horizontal: float, shear: float) -> np.ndarray:
    stress = np.full((3, 3), shear)
    stress[np.diag_indices(3)] = horizontal, horizontal, vertical
    return stress


def _cylinder(radius: float, soil: HenckyElastic) -> Body:
    """Return a prism full of soil, as high as it is wide."""
    radii, levels = np.linspace(0.0, radius, 3), np.linspace(-radius, radius, 4)
    mesh = ring_mesh(radii, SIDES, levels)
    return make_body(
        mesh, Ground(0.0, 1.0, soil), numerics=TIGHT,
        is_soil=np.ones(len(mesh.cell_nodes), dtype=bool),
    )  # fmt: skip


def _is_on_surface(mesh: BackgroundMesh) -> np.ndarray:
    """Return which nodes (n_nodes,) lie on the surface of the mesh."""
    x, y, z = mesh.reference_nodes.T
    half = np.pi / SIDES
    away = np.hypot(x, y) * np.cos(np.mod(np.arctan2(y, x), 2.0 * half) - half)
    is_on: np.ndarray = np.isclose(away, away.max()) | np.isclose(np.abs(z), z.max())
    return is_on


def _rotation(number: int) -> np.ndarray:
    """Return the rotation (3, 3) by ``number`` steps about the tilted axis."""
    matrix: np.ndarray = Rotation.from_rotvec(number * STEP * AXIS).as_matrix()
    return matrix


def _turn(body: Body, number: int, driven: np.ndarray) -> tuple[Body, StepResult]:
    """Return the body after the step ``number``, which turns the nodes ``driven`` (n_nodes,)."""
    motion = body.mesh.nodes @ (_rotation(1) - np.eye(3)).T
    is_prescribed = np.repeat(driven[:, None], 3, axis=1)
    return advance(
        body._replace(start=motion),
        Prescribed(is_prescribed, np.where(is_prescribed, motion, 0.0)),
        move_mesh=lambda mesh: mesh._replace(nodes=mesh.reference_nodes @ _rotation(number).T),
        name=f"rotation to {5 * number} degrees",
    )


def _move_mesh(body: Body, radius: float, down: float, angle: float) -> tuple[Body, StepResult]:
    """Return a step at rest, after which the mesh has turned to ``angle`` and gone ``down``."""
    side = 2.0 * np.pi / SIDES
    zones = ScrewZones(0.5 * radius, radius, (-RIGID * radius, RIGID * radius), (-radius, radius))
    held = np.repeat(_is_on_surface(body.mesh)[:, None], 3, axis=1)
    return advance(
        body._replace(start=np.zeros_like(body.mesh.nodes)),
        Prescribed(held, np.zeros_like(body.mesh.nodes)),
        move_mesh=lambda mesh: screw(mesh, down, angle, side * np.round(angle / side), zones),
        name="soil at rest",
    )


PROBLEMS: tuple[Problem, ...] = (
    Problem("PA4-3D", "Rigid rotation of a stress-free body about a tilted axis, 72 x 5 degrees",
            stress_free_rotation, is_quick=False),
    Problem("PA5-3D", "Rigid rotation of a stressed body about a tilted axis", stressed_rotation,
            is_quick=True),
    Problem("PA6-3D", "Mesh of a screw pile moving through soil at rest under uniform stress",
            moving_mesh, is_quick=True),
)  # fmt: skip
