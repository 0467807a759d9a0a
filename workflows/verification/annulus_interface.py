"""PA13: the rigid pile of an annulus turns, and an interface on the inner rim sticks, then slips.

The pile has no nodes: its motion reaches the soil through interface elements on the sides of the
polygon, whose points carry the exact normals of the circle.  The gap of a step is measured in the
frame of its middle, and normals and mesh turn with the pile after each step; therefore the torque
stays flat, however far the pile turns.

The reference is one of small strain.  With the soil of PA13 the shear strain at the rim is 0.13
when the interface slips, and turning then presses the soil against the pile (Poynting's effect):
with friction the plateau lies higher by that pressure times tan(phi).  The plateau is therefore
compared twice: with the computed mean pressure, and in soil that is a hundred times stiffer, where
the strain is small and the plateau is that of the cohesion alone.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.background_mesh import BackgroundMesh, facets_opposite_vertices
from install_mpm.constitutive import coulomb_interface
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic
from install_mpm.conventions import Unit
from install_mpm.interface import InterfaceElements, InterfacePoints, facet_rule
from install_mpm.options import Numerics
from install_mpm.pile import PileMotion
from install_mpm.pile_surface import POINTS_PER_FACET, place_points
from workflows.verification.disc_meshes import circle, disc_mesh, nodes_on
from workflows.verification.problem import Outcome, Problem, Series, relative
from workflows.verification.references.annulus_interface import AnnulusInterface
from workflows.verification.references.annulus_interface import annulus_interface as reference
from workflows.verification.turned_disc import Disc, disc_body, torque, turn_once

SIDES = 72
"""Of both rims: the mesh maps onto itself after 5 degrees."""
STICKING = np.linspace(0.2, 0.8, 4)
"""Rotations before slip, over that at its onset."""
FINE_STEPS, LONG_STEPS = np.deg2rad(np.full(8, 0.25)), np.deg2rad(np.full(20, 0.5))
"""Steps after the onset of slip, in rad: in the soil itself and in the stiff soil."""
STIFFER = 100.0
TOLERANCE = 5e-3
NUMERICS = Numerics(volumetric_term=0.0, tolerance=1e-9)

Length = Annotated[float, Unit("m")]
Modulus = Annotated[float, Unit("Pa")]


def annulus_interface(
    *,
    a: Length = 1.0,
    b: Length = 4.0,
    E: Modulus = 10e3,
    nu: float = 0.3,
    k_s: Annotated[float, Unit("Pa/m")] = 1e7,
    c: Modulus = 500.0,
    phi: Annotated[float, Unit("rad")] = float(np.deg2rad(24.0)),
) -> Outcome:
    """Return the torque before and after slip."""
    own = _run((a, b, E, nu), _law(k_s, c, phi), FINE_STEPS)
    stiff = _run((a, b, STIFFER * E, nu), _law(STIFFER * k_s, c, phi), LONG_STEPS)
    pressed = 2.0 * np.pi * a**2 * (c + own.pressure[-1] * np.tan(phi))
    plateau = stiff.torque[len(STICKING) :]
    worst = float(plateau[np.abs(plateau - stiff.exact.strength).argmax()])
    return Outcome(
        (
            relative("torque over rotation before slip in N m/rad per metre",
                     own.torque[0] / own.angle[0], own.exact.stiffness, TOLERANCE),
            relative("torque while slipping, with the computed pressure, in N m per metre",
                     own.torque[-1], pressed, TOLERANCE),
            relative("stiff soil: torque farthest from the plateau in N m per metre", worst,
                     stiff.exact.strength, TOLERANCE),
        ),
        tuple(
            Series(f"Torque on the inner rim, {name}", "rotation in degrees",
                   "torque in N m per metre", tuple(np.rad2deg(run.angle)), tuple(run.torque),
                   tuple(run.exact.torque))
            for name, run in (("soil as given", own), ("stiff soil", stiff))
        ),
        (
            f"mean pressure on the slipping interface over its cohesion:"
            f" {own.pressure[-1] / c:.3f} in the soil as given,"
            f" {stiff.pressure[-1] / c:.4f} in the stiff soil",
        ),
        residual_histories=own.residuals,  # the stiff soil is linear: nothing to see
    )  # fmt: skip


class _Run(NamedTuple):
    """Curves of one soil, (n_steps,)."""

    angle: np.ndarray
    torque: np.ndarray
    pressure: np.ndarray
    """Mean normal pressure on the interface in Pa."""
    exact: AnnulusInterface
    residuals: tuple[tuple[float, ...], ...]


def _law(shear_stiffness: float, cohesion: float, friction_angle: float) -> CoulombInterface:
    """Return the interface; its normal stiffness is its shear stiffness."""
    return CoulombInterface(
        shear_stiffness, shear_stiffness, cohesion=cohesion, friction_angle=friction_angle
    )


def _run(
    annulus: tuple[float, float, float, float], law: CoulombInterface, steps: np.ndarray
) -> _Run:
    """Return the rotation of the pile to the onset of slip and by ``steps`` (n,) in rad beyond."""
    a, b, youngs_modulus, poissons_ratio = annulus
    disc = Disc(circle(b, SIDES), circle(a, SIDES))
    onset = _reference(0.0, law, annulus).slip_onset
    angles = np.append(onset * STICKING, onset + np.cumsum(steps))
    soil = HenckyElastic(youngs_modulus, poissons_ratio)
    torques, pressures, residuals = _turn(disc, soil, law, angles)
    return _Run(angles, torques, pressures, _reference(angles, law, annulus), residuals)


def _reference(
    angles: np.ndarray | float, law: CoulombInterface, annulus: tuple[float, float, float, float]
) -> AnnulusInterface:
    a, b, youngs_modulus, poissons_ratio = annulus
    return reference(
        angles,
        inner_radius=a,
        outer_radius=b,
        youngs_modulus=youngs_modulus,
        poissons_ratio=poissons_ratio,
        shear_stiffness=law.shear_stiffness,
        cohesion=law.cohesion,
        friction_angle=law.friction_angle,
    )


def _turn(
    disc: Disc, soil: HenckyElastic, law: CoulombInterface, angles: np.ndarray
) -> tuple[np.ndarray, np.ndarray, tuple[tuple[float, ...], ...]]:
    """Return torques (n,), mean pressures (n,) in Pa and the residual histories."""
    elements, points = _interface(disc_mesh(disc.rim, disc.hole), disc, law)
    body = disc_body(disc, soil, NUMERICS, (elements, points))
    on_rim = nodes_on(body.mesh, disc.rim)
    nobody = np.zeros(0, dtype=np.int64)
    side = 2.0 * np.pi / SIDES
    torques, pressures, residuals = [], [], []
    for angle, step in zip(angles, np.diff(angles, prepend=0.0), strict=True):
        motion = PileMotion(np.zeros(2), step)
        body, result = turn_once(body, disc, nobody, angle % side, step, motion=motion)
        position, area = place_points(elements, body.mesh)
        body = body._replace(
            interface=body.interface._replace(
                position=position, area=area, normal=_radial(position)
            )
        )
        torques.append(-torque(body.mesh.nodes[on_rim], result.equilibrium.reaction[on_rim]))
        residuals.append(tuple(result.equilibrium.newton.residuals))
        pressures.append(-np.average(body.interface.traction[:, 1], weights=area))
    return np.array(torques), np.array(pressures), tuple(residuals)


def _interface(
    mesh: BackgroundMesh, disc: Disc, law: CoulombInterface
) -> tuple[InterfaceElements, InterfacePoints]:
    """Return the interface between the sides of the hole and the rigid pile in it."""
    ends = facets_opposite_vertices(mesh.cell_nodes[:, :3])
    is_on_hole = np.isin(ends, nodes_on(mesh, disc.hole)).all(axis=-1)
    cell, facet = np.argwhere((mesh.cell_neighbours < 0) & is_on_hole).T
    middle = mesh.cell_nodes[cell, 3 + (facet + 1) % 3]
    elements = InterfaceElements(
        np.column_stack([ends[cell, facet], middle]), cell, *facet_rule(3, POINTS_PER_FACET)
    )
    position, area = place_points(elements, mesh)
    n = len(position)
    points = InterfacePoints(
        position=position,
        normal=_radial(position),
        area=area,
        traction=np.zeros((n, 2)),
        parameters=coulomb_interface.pack(law, np.zeros(n)),
        part=np.zeros(n, dtype=np.int64),
        covered=np.ones(n),
    )
    return elements, points


def _radial(position: np.ndarray) -> np.ndarray:
    """Return the exact normals of the circle, from soil to pile, (n, 2)."""
    normal: np.ndarray = -position / np.linalg.norm(position, axis=1)[:, None]
    return normal


PROBLEM = Problem(
    "PA13", "Annulus with an interface that slips on its inner rim", annulus_interface, False
)
