"""Rigid shafts and a disc turn in a closed box, with an interface that slips all over them (3D).

The soil hardly moves, so the torque is that of the interface alone: adhesion or friction times area
times lever arm.  What is checked is geometry in motion: exact normals, gap and slip of a step, and
a mesh whose polygon turns with the body through soil that stays behind.  A gap that is measured
against the wrong normal closes a little in every step; with friction the torque then drifts.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.constitutive.parameters import (
    CoulombInterface,
    MohrCoulomb,
    SoilParameters,
    VonMises,
)
from install_mpm.conventions import Unit
from install_mpm.ground import Ground
from install_mpm.interface import InterfaceElements
from install_mpm.options import Numerics
from workflows.verification.body import Body, make_body
from workflows.verification.problem import Check, Outcome, Problem, Series, relative
from workflows.verification.references.rotating_bodies import disc_torque, shaft_torque
from workflows.verification.references.screw_pile import shaft_resistance
from workflows.verification.solid_meshes import extruded, quadratic_mesh, ring, ring_mesh
from workflows.verification.solid_surfaces import (
    Normals,
    inward,
    rigid_surface,
    surface_elements,
)
from workflows.verification.turned_solid import ON_PLANE, Driven, Prism, Screwed, screw_once
from workflows.verification.uniform_stress import with_stress

SHAFT_SIDES, DISC_SIDES = 32, 32
STEP = np.deg2rad(2.5)
NUMERICS = Numerics(tolerance=1e-7)
INTERFACE_STIFFNESS = 50.0
"""Normal stiffness of the interface over Young's modulus per metre; the shear one is a tenth."""
MODULUS_OVER_STRENGTH, POISSON = 200.0, 0.49
SAND_MODULUS, SAND_POISSON = 20e6, 0.3

Length = Annotated[float, Unit("m")]
Stress = Annotated[float, Unit("Pa")]


class Turning(NamedTuple):
    """Steps of a rotation, (n_steps,)."""

    angle: np.ndarray
    """In rad."""
    torque: np.ndarray
    """In N m."""
    force: np.ndarray
    """On the body along the axis in N."""
    pressure: np.ndarray
    """Mean on the interface in Pa."""
    residuals: tuple[tuple[float, ...], ...]


def shaft_in_clay(
    *,
    a: Length = 0.25,
    L: Length = 0.6,
    su: Stress = 10e3,
    turned: Annotated[float, Unit("rad")] = float(np.deg2rad(20.0)),
) -> Outcome:
    """Return the torque on a shaft in clay with adhesion factors 0.5 and 1."""
    prism = _prism(a, L)
    full = shaft_torque(radius=a, length=L, shear_strength=su)
    return _torques_in_clay(prism, shaft_mesh(prism), inward, su, turned, full)


def disc_in_clay(
    *,
    R: Length = 0.5,
    t: Length = 0.1,
    su: Stress = 10e3,
    turned: Annotated[float, Unit("rad")] = float(np.deg2rad(10.0)),
) -> Outcome:
    """Return the torque on a disc in clay with adhesion factors 0.5 and 1."""
    prism = Prism(R, 2.5 * R, DISC_SIDES, (-R - 0.5 * t, R + 0.5 * t))

    def normals(position: np.ndarray) -> np.ndarray:
        is_rim = np.abs(position[:, 2]) < 0.5 * t - ON_PLANE
        upright = np.column_stack([np.zeros((len(position), 2)), -np.sign(position[:, 2])])
        return np.where(is_rim[:, None], inward(position), upright)

    full = disc_torque(radius=R, thickness=t, shear_strength=su)
    return _torques_in_clay(prism, disc_mesh(prism, t), normals, su, turned, full)


def _torques_in_clay(
    prism: Prism, mesh: BackgroundMesh, normals: Normals, su: float, turned: float, full: float
) -> Outcome:
    """Return the torques with adhesion factors 0.5 and 1; ``full`` (N m) is that with factor 1."""
    checks: list[Check] = []
    residuals: list[tuple[float, ...]] = []
    for alpha in (0.5, 1.0):
        body = _body(mesh, prism, normals, _clay(su), _adhesive(su, alpha), su)
        turning = turn(body, prism, normals, _steps(turned))
        text = f"torque after {np.degrees(turned):g} degrees in N m, adhesion factor {alpha:g}"
        checks.append(relative(text, turning.torque[-1], alpha * full, 0.02))
        residuals += turning.residuals
    return Outcome(tuple(checks), residual_histories=tuple(residuals))


def shaft_in_sand(
    *,
    a: Length = 0.25,
    L: Length = 0.6,
    p0: Stress = 20e3,
    phi: Annotated[float, Unit("rad")] = float(np.deg2rad(35.0)),
    delta: Annotated[float, Unit("rad")] = float(np.deg2rad(24.0)),
    turned: Annotated[float, Unit("rad")] = float(np.deg2rad(360.0)),
    turned_wrong: Annotated[float, Unit("rad")] = float(np.deg2rad(30.0)),
) -> Outcome:
    """Return the torque on a shaft with friction under a uniform pressure p0, once round.

    ``turned_wrong`` is the rotation of the same shaft with its normals turning with it, for the
    statement on drift.
    """
    exact = shaft_torque(radius=a, length=L, shear_strength=p0 * np.tan(delta))
    turning = _turn_in_sand((a, L), p0, phi, delta, turned)
    slipping = turning.torque[len(turning.torque) // 8 :]
    worst = float(slipping[np.abs(slipping - exact).argmax()])
    wrong = _turn_in_sand((a, L), p0, phi, delta, turned_wrong, is_swept=False)
    curve = Series(
        "Torque on the shaft", "rotation in degrees", "torque in N m",
        tuple(np.degrees(turning.angle)), tuple(turning.torque), (exact,) * len(turning.angle),
    )  # fmt: skip
    return Outcome(
        (
            relative(f"torque after {np.degrees(turned):g} degrees in N m", turning.torque[-1],
                     exact, 0.02),
            relative("torque farthest from it after an eighth of that, in N m", worst, exact, 0.02),
            relative("mean normal pressure at the end in Pa", turning.pressure[-1], p0, 0.02),
        ),
        (curve,),
        (
            f"with normals that turn with the shaft, as on a surface that is not swept, the torque"
            f" is {wrong.torque[-1] / exact:.3f} times the exact one after"
            f" {np.degrees(turned_wrong):g} degrees, the pressure"
            f" {wrong.pressure[-1] / p0:.3f} times",
        ),
        turning.residuals,
    )  # fmt: skip


def advancing_shaft(
    *, a: Length = 0.44, L: Length = 1.0, p: Length = 0.56, su: Stress = 10e3, alpha: float = 1.0,
    turned: Annotated[float, Unit("rad")] = float(np.deg2rad(20.0)),
) -> Outcome:  # fmt: skip
    """Return torque and force on a shaft that turns and goes down at AR = 1 and 0.5 (PC3)."""
    checks: list[Check] = []
    residuals: list[tuple[float, ...]] = []
    for ratio in (1.0, 0.5):
        prism = _prism(a, L)
        body = _body(shaft_mesh(prism), prism, inward, _clay(su), _adhesive(su, alpha), su)
        turning = turn(body, prism, inward, _steps(-turned), lift_per_turn=ratio * p)
        exact = shaft_resistance(
            radius=a, length=L, pitch=p, advancement_ratio=ratio, shear_strength=alpha * su
        )
        checks += [
            relative(f"torque at AR = {ratio:g} in N m", turning.torque[-1], exact.torque, 0.01),
            relative(f"upward force at AR = {ratio:g} in N", turning.force[-1], exact.force, 0.01),
        ]
        residuals += turning.residuals
    return Outcome(tuple(checks), residual_histories=tuple(residuals))


def turn(
    body: Body, prism: Prism, normals: Normals, angles: np.ndarray, lift_per_turn: float = 0.0
) -> Turning:
    """Return the rotation of the body to all ``angles`` (n,) in rad, one step each."""
    rows: list[Screwed] = []
    for angle, step in zip(angles, np.diff(angles, prepend=0.0), strict=True):
        lift = lift_per_turn * step / (2.0 * np.pi)
        rows.append(screw_once(body, prism, Driven(normals), angle, step, lift))
        body = rows[-1].body
    return Turning(
        angles,
        np.array([row.torque for row in rows]),
        np.array([row.force for row in rows]),
        np.array([row.pressure for row in rows]),
        tuple(tuple(row.result.equilibrium.newton.residuals) for row in rows),
    )


def shaft_mesh(prism: Prism) -> BackgroundMesh:
    """Return the mesh between a shaft and the wall of its box."""
    radii = np.geomspace(prism.inner_radius, prism.outer_radius, 4)
    return ring_mesh(radii, prism.sides, np.array(prism.levels))


def disc_mesh(prism: Prism, thickness: float) -> BackgroundMesh:
    """Return the mesh around a disc in the middle of its box."""
    R, half = prism.inner_radius, 0.5 * thickness
    radii = np.array([0.0, 0.5 * R, R, 1.5 * R, prism.outer_radius])
    levels = np.array([prism.levels[0], -half, half, prism.levels[1]])
    solid = extruded(ring(radii, prism.sides), levels)
    x, y, z = solid.centroids.T
    is_beside = np.hypot(x, y) > R * np.cos(np.pi / prism.sides)
    return quadratic_mesh(solid, is_beside | (np.abs(z) > half))


def _prism(radius: float, length: float) -> Prism:
    return Prism(radius, 4.0 * radius, SHAFT_SIDES, (0.0, length))


def _steps(angle: float) -> np.ndarray:
    """Return the rotations (n,) in rad at the ends of steps of 2.5 degrees or less."""
    n_steps = int(np.ceil(abs(angle) / STEP - 1e-9))
    steps: np.ndarray = angle / n_steps * np.arange(1, n_steps + 1)
    return steps


def _clay(strength: float) -> VonMises:
    return VonMises(MODULUS_OVER_STRENGTH * strength, POISSON, strength)


def _adhesive(strength: float, alpha: float) -> CoulombInterface:
    stiffness = INTERFACE_STIFFNESS * MODULUS_OVER_STRENGTH * strength
    return CoulombInterface(stiffness, stiffness / 10.0, adhesion_factor=alpha)


def _turn_in_sand(
    size: tuple[float, float], pressure: float, phi: float, delta: float, angle: float, *,
    is_swept: bool = True,
) -> Turning:  # fmt: skip
    """Return the rotation of a shaft of ``size`` (radius, length) in sand."""
    prism, soil = _prism(*size), MohrCoulomb(SAND_MODULUS, SAND_POISSON, 0.0, phi)
    stiffness = INTERFACE_STIFFNESS * SAND_MODULUS
    law = CoulombInterface(stiffness, stiffness / 10.0, friction_angle=delta)
    body = _body(
        shaft_mesh(prism), prism, inward, soil, law, 0.0, pressure=pressure, is_swept=is_swept
    )
    return turn(body, prism, inward, _steps(angle))


def _body(
    mesh: BackgroundMesh, prism: Prism, normals: Normals, soil: SoilParameters,
    law: CoulombInterface, strength: float, *, pressure: float = 0.0, is_swept: bool = True,
) -> Body:  # fmt: skip
    """Return weightless soil under an all-round ``pressure`` (Pa) around a rigid body."""
    elements = surface_of(mesh, prism, is_swept=is_swept)
    body = make_body(
        mesh,
        Ground(0.0, 1.0, soil),
        numerics=NUMERICS,
        is_soil=np.ones(len(mesh.cell_nodes), dtype=bool),
        interface=(elements, rigid_surface(mesh, elements, normals, law, strength, pressure)),
    )
    return with_stress(body, soil, -pressure * np.eye(3)) if pressure else body


def surface_of(mesh: BackgroundMesh, prism: Prism, *, is_swept: bool) -> InterfaceElements:
    """Return the interface elements on the rigid body: all boundary facets not of the box."""
    x, y, z = mesh.nodes.T
    bottom, top = prism.levels
    is_near = np.hypot(x, y) < prism.inner_radius + ON_PLANE
    elements = surface_elements(mesh, is_near, is_swept=is_swept)
    level = z[elements.nodes[:, :3]]
    is_box = (level < bottom + ON_PLANE).all(axis=1) | (level > top - ON_PLANE).all(axis=1)
    return elements._replace(
        nodes=elements.nodes[~is_box],
        cell=elements.cell[~is_box],
        is_swept=np.full(3 * np.count_nonzero(~is_box), is_swept),
    )


PROBLEMS = (
    Problem("SHAFT-CLAY", "Shaft turning in clay, in space", shaft_in_clay, is_quick=True),
    Problem("DISC-CLAY", "Disc turning in clay, in space", disc_in_clay, is_quick=False),
    Problem("SHAFT-SAND", "Shaft with friction turning once round, in space", shaft_in_sand,
            is_quick=False),
    Problem("PC3", "Shaft turning and advancing: one direction of slip", advancing_shaft,
            is_quick=True),
)  # fmt: skip
