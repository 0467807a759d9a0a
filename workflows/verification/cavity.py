"""PA16: large expansion of a cylindrical and a spherical cavity in clay.

The wall is driven, the outer boundary is free of stress, and the mesh follows the wall while the
soil flows outward through it.  The cylinder is a flat ring in axisymmetry, and again a quarter of
an annulus in plane strain; the sphere is a quarter of its meridian plane in axisymmetry.

The references are for Tresca soil, sigma_1 - sigma_3 = 2 s_u.  The von Mises soil here has s_u in
pure shear, as in plane strain; around a sphere two principal stresses are equal, and it yields at
sigma_1 - sigma_3 = sqrt(3) s_u.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Annotated

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.constitutive import dispatch
from install_mpm.constitutive.parameters import SoilParameters, VonMises
from install_mpm.conventions import Kinematics, Unit
from install_mpm.equilibrium import Prescribed
from install_mpm.geostatic import elastic_strain_of
from install_mpm.ground import Ground
from install_mpm.material_points import MaterialPoints
from install_mpm.mesh_motion import expand
from install_mpm.options import Numerics
from install_mpm.step import StepResult
from workflows.verification.body import Body, ProblemNotSolvedError, advance, make_body
from workflows.verification.polar_mesh import polar_mesh
from workflows.verification.problem import Check, Outcome, Problem, Series, relative
from workflows.verification.rectangle import rectangle_mesh
from workflows.verification.references.cylindrical_cavity import (
    cylinder_pressure,
    sphere_pressure,
)

CHECKED_EXPANSIONS = (1.05, 1.2, 1.5, 2.0)
ROUND_OFF, TOLERANCE = 1e-9, 1e-8
"""Relative residuals; the pressure of nearly incompressible soil makes much of round-off."""
MOST_HALVINGS = 4
"""A step that does not converge is cut into at most two to this power."""


@dataclass(frozen=True)
class Cavity:
    """Geometry of a cavity: its mesh, what holds it, and how pressure and wall are related."""

    mesh: BackgroundMesh
    kinematics: Kinematics
    on_wall: np.ndarray
    """(n_nodes,) bool."""
    is_held: np.ndarray
    """Dofs on planes of symmetry, (n_nodes, 2) bool."""
    radial_axes: np.ndarray
    """1 for the coordinates that grow with the cavity, else 0, (2,)."""
    volume_power: int
    """The cavity grows with this power of its radius."""
    volume_per_power: float
    """Volume of the polygonal cavity over the radius to that power."""


def _radii(a: float, outer_ratio: float, size: float) -> np.ndarray:
    """Return the radii of the rings of cells, each the part ``size`` of its radius wide."""
    n_rings = round(np.log(outer_ratio) / np.log1p(size))
    return np.geomspace(a, outer_ratio * a, n_rings + 1)


def cylinder_ring(a: float, outer_ratio: float, size: float) -> Cavity:
    """Return a flat ring around a cylindrical cavity of radius ``a`` (m)."""
    radii = _radii(a, outer_ratio, size)
    height = size * a
    mesh = rectangle_mesh(radii, np.array([0.0, height]), is_crossed=True)
    is_held = np.zeros(mesh.nodes.shape, dtype=bool)
    is_held[:, 1] = True
    on_wall = mesh.nodes[:, 0] == a
    return Cavity(
        mesh, Kinematics.AXISYMMETRIC, on_wall, is_held, np.array([1.0, 0.0]), 2, np.pi * height
    )


def sector(a: float, outer_ratio: float, size: float, kinematics: Kinematics) -> Cavity:
    """Return a quarter of the section through a cavity: a cylinder or, if axisymmetric, a sphere.

    The cavity is a polygon: the volume is that of the triangles from the centre to its facets.
    """
    n_facets = round(0.5 * np.pi / size)
    angles = np.linspace(0.0, 0.5 * np.pi, n_facets + 1)
    mesh, polar = polar_mesh(_radii(a, outer_ratio, size), angles)
    wall = np.column_stack([np.cos(angles), np.sin(angles)])
    area = 0.5 * np.sin(np.diff(angles))
    power, volume = 2, area.sum()
    if kinematics == Kinematics.AXISYMMETRIC:
        power, volume = 3, 2.0 * np.pi * (area * (wall[1:, 0] + wall[:-1, 0]) / 3.0).sum()
    is_held = mesh.nodes == 0.0
    return Cavity(mesh, kinematics, polar[:, 0] == a, is_held, np.ones(2), power, volume)


def expand_cavity(
    cavity: Cavity,
    soil: SoilParameters,
    a: float,
    expansion: np.ndarray,
    initial_pressure: float,
    tolerance: float = TOLERANCE,
) -> tuple[np.ndarray, np.ndarray, tuple[tuple[float, ...], ...]]:
    """Return expansion a / a_0, pressure in Pa and Newton residuals of the steps.

    The pressure is the work of the reactions at the wall over the swept volume.  ``expansion``
    begins with 1; the soil starts under the isotropic ``initial_pressure`` in Pa.
    """
    body = make_body(
        cavity.mesh,
        Ground(0.0, 1.0, soil),
        kinematics=cavity.kinematics,
        numerics=Numerics(tolerance=tolerance),
        is_soil=np.ones(len(cavity.mesh.cell_nodes), dtype=bool),
    )
    body = body._replace(points=_pressed(body.points, soil, initial_pressure))
    pressure: list[float] = []
    histories: tuple[tuple[float, ...], ...] = ()
    for before, after in pairwise(expansion):
        body, result, residuals = _widen(cavity, body, a, before, after)
        wall = body.mesh.nodes * cavity.radial_axes
        work = (result.equilibrium.reaction * wall)[cavity.on_wall].sum()
        volume = cavity.volume_per_power * (a * after) ** cavity.volume_power
        pressure.append(work / (cavity.volume_power * volume))
        histories += residuals
    return expansion[1:], np.array(pressure), histories


def _widen(
    cavity: Cavity, body: Body, a: float, before: float, after: float, halvings: int = 0
) -> tuple[Body, StepResult, tuple[tuple[float, ...], ...]]:
    """Return the body after a step of the wall, or, where that does not converge, after its parts.

    Raises
    ------
    ProblemNotSolvedError
        If the parts do not converge either.
    """
    prescribed = _drive_wall(cavity, body, after / before - 1.0)
    if before == 1.0:
        body = body._replace(start=_without_volume_change(cavity, a, after))
    law, name = _follow_wall(cavity, a, after), f"cavity, a/a0 = {after:.3f}"
    try:
        body, result = advance(body, prescribed, move_mesh=law, name=name)
    except ProblemNotSolvedError:
        if halvings == MOST_HALVINGS:
            raise
    else:
        return body, result, (tuple(result.equilibrium.newton.residuals),)
    middle = float(np.sqrt(before * after))
    histories: tuple[tuple[float, ...], ...] = ()
    body = body._replace(start=0.5 * body.start)
    for start, end in ((before, middle), (middle, after)):
        body, result, residuals = _widen(cavity, body, a, start, end, halvings + 1)
        histories += residuals
    return body, result, histories


def _pressed(points: MaterialPoints, soil: SoilParameters, pressure: float) -> MaterialPoints:
    """Return undeformed points under an isotropic ``pressure`` in Pa."""
    stress = np.tile(-pressure * np.eye(3), (len(points.volume), 1, 1))
    state = dispatch.initial_state(soil, np.zeros(len(stress)), stress)
    return points._replace(
        kirchhoff_stress=stress,
        elastic_log_strain=elastic_strain_of(soil, stress, state),
        state_variables=state,
    )


def _without_volume_change(cavity: Cavity, a: float, expansion: float) -> np.ndarray:
    """Return the displacement (n_nodes, 2) in m of incompressible soil as the cavity expands."""
    outward = cavity.mesh.nodes * cavity.radial_axes
    radius = np.linalg.norm(outward, axis=1)
    power = cavity.volume_power
    moved = (radius**power + a**power * (expansion**power - 1.0)) ** (1.0 / power)
    return (moved / radius - 1.0)[:, None] * outward


def _drive_wall(cavity: Cavity, body: Body, strain: float) -> Prescribed:
    """Return the supports, with the wall scaled by 1 + ``strain``."""
    is_prescribed = cavity.is_held | cavity.on_wall[:, None]
    displacement = strain * body.mesh.nodes * cavity.radial_axes
    return Prescribed(is_prescribed, np.where(cavity.on_wall[:, None], displacement, 0.0))


def _follow_wall(
    cavity: Cavity, a: float, expansion: float
) -> Callable[[BackgroundMesh], BackgroundMesh]:
    """Return the law of mesh motion at ``expansion``: with the wall, the outer boundary at rest."""
    return partial(
        expand,
        growth=(expansion - 1.0) * a,
        inner_radius=a,
        outer_radius=float(cavity.mesh.reference_nodes[:, 0].max()),
        is_radius_horizontal=not cavity.radial_axes[1],
    )


def _compare(
    cavity: Cavity, a: float, su: float, G_over_su: float, nu: float, tolerance: float,
    outer_ratio: float, expansion: float, steps: int,
) -> Outcome:  # fmt: skip
    """Return the outcome of expanding ``cavity`` beside the closed form."""
    shear_modulus = G_over_su * su
    soil = VonMises(2.0 * (1.0 + nu) * shear_modulus, nu, su)
    expansions = np.linspace(1.0, expansion, steps + 1)
    ratio, pressure, histories = expand_cavity(cavity, soil, a, expansions, 0.0)
    is_cylinder = cavity.volume_power == 2
    reference = cylinder_pressure if is_cylinder else sphere_pressure
    exact = reference(
        ratio,
        shear_modulus=shear_modulus,
        undrained_shear_strength=su if is_cylinder else np.sqrt(0.75) * su,
        outer_ratio=outer_ratio,
    )
    values = [value for value in CHECKED_EXPANSIONS if value < expansion] + [expansion]
    checks, curve = beside_exact(ratio, pressure / su, exact / su, "su", values, tolerance)
    return Outcome(tuple(checks), (curve,), residual_histories=histories, round_off=ROUND_OFF)


def beside_exact(
    ratio: np.ndarray,
    pressure: np.ndarray,
    exact: np.ndarray,
    unit: str,
    expansions: Iterable[float],
    tolerance: float,
) -> tuple[list[Check], Series]:
    """Return the checks of the pressure at ``expansions``, and its curve.

    ``pressure`` and ``exact`` (n,) at the expansions ``ratio`` (n,) are over a pressure or strength
    that is called ``unit``.
    """
    checks = []
    for value in expansions:
        at = int(np.argmin(np.abs(ratio - value)))
        quantity = f"cavity pressure / {unit} at a/a0 = {ratio[at]:.3g}"
        checks.append(relative(quantity, pressure[at], exact[at], tolerance))
    curve = Series(
        "Pressure in the cavity", "a / a0 (-)", f"pressure / {unit} (-)",
        tuple(ratio), tuple(pressure), tuple(exact),
    )  # fmt: skip
    return checks, curve


def cylindrical_ring(
    *,
    a: Annotated[float, Unit("m")] = 1.0,
    su: Annotated[float, Unit("Pa")] = 1e3,
    G_over_su: float = 100.0,
    nu: float = 0.495,
    outer_ratio: float = 50.0,
    expansion: float = 2.0,
    size: float = 0.1,
    steps: int = 50,
) -> Outcome:
    """Return the pressure in a cylindrical cavity, axisymmetric.

    ``size`` is that of the cells over their radius.
    """
    cavity = cylinder_ring(a, outer_ratio, size)
    return _compare(cavity, a, su, G_over_su, nu, 0.02, outer_ratio, expansion, steps)


def cylindrical_sector(
    *,
    a: Annotated[float, Unit("m")] = 1.0,
    su: Annotated[float, Unit("Pa")] = 1e3,
    G_over_su: float = 100.0,
    nu: float = 0.495,
    outer_ratio: float = 50.0,
    expansion: float = 2.0,
    size: float = 0.15,
    steps: int = 50,
) -> Outcome:
    """Return the pressure in a cylindrical cavity, plane strain; see ``cylindrical_ring``."""
    cavity = sector(a, outer_ratio, size, Kinematics.PLANE_STRAIN)
    return _compare(cavity, a, su, G_over_su, nu, 0.02, outer_ratio, expansion, steps)


def spherical(
    *,
    a: Annotated[float, Unit("m")] = 1.0,
    su: Annotated[float, Unit("Pa")] = 1e3,
    G_over_su: float = 100.0,
    nu: float = 0.495,
    outer_ratio: float = 20.0,
    expansion: float = 2.0,
    size: float = 0.15,
    steps: int = 50,
) -> Outcome:
    """Return the pressure in a spherical cavity; see ``cylindrical_ring``."""
    cavity = sector(a, outer_ratio, size, Kinematics.AXISYMMETRIC)
    return _compare(cavity, a, su, G_over_su, nu, 0.03, outer_ratio, expansion, steps)


PROBLEMS = (
    Problem("PA16", "Cylindrical cavity, axisymmetric", cylindrical_ring, is_quick=True),
    Problem("PA16-PLANE", "Cylindrical cavity, plane strain", cylindrical_sector, is_quick=False),
    Problem("PA16-SPHERE", "Spherical cavity", spherical, is_quick=False),
)
