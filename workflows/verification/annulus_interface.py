"""PA13: the rigid pile of an annulus turns, and an interface on the inner rim sticks, then slips.

The pile has no nodes: its motion reaches the soil through interface elements on the sides of the
polygon, whose points carry the exact normals of the circle.  The gap of a step is measured in the
frame of its middle, and normals and mesh turn with the pile after each step; therefore the torque
stays flat, however far the pile turns: a quarter of a turn and more after it has begun to slip.
The rim is a surface of revolution: the soil meets the normal of the place where it is, so that the
slip of a step presses nothing.

With the soil of PA13 the shear strain at the rim is 0.13 when the interface slips, and turning then
presses the soil against the pile (Poynting's effect): with friction the plateau lies higher by that
pressure times tan(phi).  The reference is therefore the annulus of finite strain with friction on
its rim.  Without friction the pressure does not count, and in soil a hundred times stiffer, where
the strain is small, there is next to none.
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
from workflows.verification.problem import (
    Check,
    Outcome,
    Problem,
    Series,
    at_least,
    at_most,
    relative,
)
from workflows.verification.references.annulus_energy import hencky
from workflows.verification.references.annulus_interface import (
    AnnulusInterface,
    SlippingAnnulus,
    slipping_annulus,
)
from workflows.verification.references.annulus_interface import (
    annulus_interface as annulus_interface_torque,
)
from workflows.verification.turned_disc import Disc, disc_body, torque, turn_once

SIDES = 72
"""Of both rims: the mesh maps onto itself after 5 degrees."""
STICKING = np.linspace(0.2, 0.8, 4)
"""Rotations before slip, over that at its onset."""
QUARTER_TURN = np.deg2rad(np.append(0.5, np.full(13, 7.2)))
"""Steps after the onset of slip in rad; the mesh takes 14 places on the rim."""
NORMAL_STIFFNESS = 1e3
"""Of the interface, over E / a: the pile is rigid across."""
FLAT = 1e-6
"""Range of the torque while slipping without friction, over the torque."""
MOST_ITERATIONS = 3
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
    """Return the torque before slip, and while slipping over a quarter turn."""
    annulus, stiff_annulus = (a, b, E, nu), (a, b, STIFFER * E, nu)
    rubbing = _run(annulus, k_s, c, phi)
    smooth = _run(annulus, k_s, c, 0.0)
    stiff = _run(stiff_annulus, STIFFER * k_s, c, phi)
    runs = (("with friction", rubbing), ("without friction", smooth), ("stiff soil", stiff))
    turned = np.rad2deg(rubbing.angle[-1] - rubbing.small.slip_onset)
    slipping = smooth.torque[len(STICKING) :]
    return Outcome(
        (
            relative("torque over rotation before slip in N m/rad per metre",
                     rubbing.torque[0] / rubbing.angle[0], rubbing.small.stiffness, TOLERANCE),
            *(_plateau(*run) for run in runs),
            at_most("without friction: range of the torque while slipping, over the torque",
                    np.ptp(slipping) / smooth.finite.torque, FLAT),
            at_least("rotation after the onset of slip in degrees", turned, 90.0),
            *(at_most(f"{name}: Newton iterations of a step from the onset of slip on, largest",
                      _most_iterations(run), MOST_ITERATIONS) for name, run in runs),
        ),
        tuple(
            Series(f"Torque on the inner rim, {name}", "rotation in degrees",
                   "torque in N m per metre", tuple(np.rad2deg(run.angle)), tuple(run.torque),
                   tuple(np.minimum(run.small.stiffness * run.angle, run.finite.torque)))
            for name, run in runs
        ),
        tuple(
            f"{name}: pressure while slipping {run.pressure[len(STICKING) :].mean():.2f} Pa"
            f" (mean), of the reference {run.finite.pressure:.2f} Pa"
            for name, run in runs
        ),
        residual_histories=rubbing.residuals + smooth.residuals,  # the stiff soil is linear
    )  # fmt: skip


def _most_iterations(run: _Run) -> int:
    """Return the most Newton iterations of a step after the onset of slip."""
    return max(len(history) - 1 for history in run.residuals[len(STICKING) :])


def _plateau(name: str, run: _Run) -> Check:
    """Return the check of the torque while slipping, at its worst step."""
    torque, expected = run.torque[len(STICKING) :], run.finite.torque
    worst = int(np.abs(torque - expected).argmax())
    text = f"{name}: torque while slipping, its worst step, in N m per metre"
    return relative(text, float(torque[worst]), expected, TOLERANCE)


class _Run(NamedTuple):
    """Curves of one soil, (n_steps,)."""

    angle: np.ndarray
    torque: np.ndarray
    pressure: np.ndarray
    """Mean normal pressure on the interface in Pa."""
    small: AnnulusInterface
    """The reference of small strain, without pressure."""
    finite: SlippingAnnulus
    """The reference while it slips."""
    residuals: tuple[tuple[float, ...], ...]


def _run(
    annulus: tuple[float, float, float, float],
    shear_stiffness: float,
    cohesion: float,
    friction_angle: float,
) -> _Run:
    """Return the rotation of the pile to the onset of slip and a quarter turn beyond."""
    a, b, youngs_modulus, poissons_ratio = annulus
    soil = {
        "inner_radius": a,
        "outer_radius": b,
        "youngs_modulus": youngs_modulus,
        "poissons_ratio": poissons_ratio,
        "cohesion": cohesion,
        "friction_angle": friction_angle,
    }
    small = annulus_interface_torque(0.0, shear_stiffness=shear_stiffness, **soil)
    finite = slipping_annulus(energy=hencky, **soil)
    law = CoulombInterface(
        NORMAL_STIFFNESS * youngs_modulus / a,
        shear_stiffness,
        cohesion=cohesion,
        friction_angle=friction_angle,
    )
    onset = small.slip_onset
    angles = np.append(onset * STICKING, onset + np.cumsum(QUARTER_TURN))
    disc = Disc(circle(b, SIDES), circle(a, SIDES))
    torques, pressures, residuals = _turn(
        disc, HenckyElastic(youngs_modulus, poissons_ratio), law, angles, onset
    )
    return _Run(angles, torques, pressures, small, finite, residuals)


def _turn(
    disc: Disc, soil: HenckyElastic, law: CoulombInterface, angles: np.ndarray, onset: float
) -> tuple[np.ndarray, np.ndarray, tuple[tuple[float, ...], ...]]:
    """Return torques (n,), mean pressures (n,) in Pa and the residual histories.

    Up to the ``onset`` of slip the pile takes the soil along in the first trial of a step.
    """
    elements, points = _interface(disc_mesh(disc.rim, disc.hole), disc, law)
    body = disc_body(disc, soil, NUMERICS, (elements, points))
    on_rim = nodes_on(body.mesh, disc.rim)
    nobody = np.zeros(0, dtype=np.int64)
    side = 2.0 * np.pi / SIDES
    torques, pressures, residuals = [], [], []
    for angle, step in zip(angles, np.diff(angles, prepend=0.0), strict=True):
        motion = PileMotion(np.zeros(2), step)
        along = float(np.clip(onset - (angle - step), 0.0, step))
        body, result = turn_once(
            body, disc, nobody, angle % side, step, motion=motion, taken_along=along
        )
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
        np.column_stack([ends[cell, facet], middle]),
        cell,
        *facet_rule(3, POINTS_PER_FACET),
        is_swept=np.ones(len(cell) * POINTS_PER_FACET, dtype=bool),
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
