"""An elastic column that its own weight squeezes to half its height (PA1, AMPLE's column).

The column is one square wide and *rows* squares high; each square is cut into four quadratic
triangles.  The background mesh follows the column in one of three ways: with every node (points
keep their places in their cells), stretched uniformly to the height of the column (points cross
cells inside it), or not at all (the column shrinks through the cells and leaves the upper half of
them empty, as in AMPLE).
"""

from __future__ import annotations

from enum import Enum
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from handoff.transfer import transfer_least_squares
from install_mpm.background_mesh import straightened
from install_mpm.constitutive.parameters import HenckyElastic
from install_mpm.equilibrium import Prescribed
from install_mpm.geostatic import geostatic_gradient
from install_mpm.ground import Ground
from install_mpm.material_points import cauchy_stress
from install_mpm.mesh_motion import stretch
from install_mpm.step import StepResult
from workflows.verification.body import Body, make_body
from workflows.verification.gravity import load_gravity, mesh_to, with_weight_of_points
from workflows.verification.problem import (
    Series,
)
from workflows.verification.rectangle import rectangle_mesh
from workflows.verification.references.ample import ColumnInput
from workflows.verification.references.column import Column, column


class MeshLaw(Enum):
    """How the background mesh follows the column."""

    NODES = "mesh follows every node"
    STRETCH = "mesh stretches with the height"
    STAY = "mesh stays"


class Resolution(NamedTuple):
    """Cells, points and the recovery of the stress field."""

    rows: int
    per_direction: int = 2
    """Points per sub-region and direction; a triangle has three sub-regions."""
    neighbours: int = 32
    """Of the recovery by least squares; the hand-over has 32."""
    has_gradient: bool = True
    """Points give their state with the geostatic gradient, as in level ground."""
    is_crossed: bool = True
    """Squares are cut into four triangles, otherwise into two."""


SIXTY_POINTS = Resolution(rows=5, per_direction=1, neighbours=8, has_gradient=False)
"""No more points than AMPLE has; 8 neighbours reach as far as 32 do with four times the points."""


FEWEST_POINTS = Resolution(rows=16, per_direction=1, neighbours=8, is_crossed=False)
"""96 points: two quadratic triangles per square and one point per integration point.

AMPLE's 64 points would be two per triangle: fewer than the cells have modes, and without
equilibrium.
"""


class Squeezed(NamedTuple):
    """The column under its full weight."""

    original_height: np.ndarray
    """Of the points, (n_points,) in m."""
    displacement: np.ndarray
    """Vertical, (n_points,) in m."""
    stress: np.ndarray
    """Vertical Cauchy stress, (n_points,) in Pa."""
    recovered: np.ndarray
    """The same of the field that is handed over, at the points."""
    exact: Column
    raw_error: float
    """Volume mean of the error of ``stress`` over rho g L0: AMPLE's norm."""
    recovered_error: float
    """The same of ``recovered``."""
    reaction: float
    """Of the base, in N."""
    weight: float
    """In N."""
    histories: tuple[tuple[float, ...], ...]


def squeeze(data: ColumnInput, law: MeshLaw, resolution: Resolution) -> Squeezed:
    """Return the column after gravity has grown in equal steps."""
    soil = HenckyElastic(data.youngs_modulus, data.poissons_ratio)
    unit_weight = data.density * data.gravity
    k0 = data.poissons_ratio / (1.0 - data.poissons_ratio)
    body, prescribed = _column(data, soil, resolution)
    histories: tuple[tuple[float, ...], ...] = ()
    for shares in pairwise(np.linspace(0.0, 1.0, data.steps + 1)):
        if resolution.has_gradient:
            ground = Ground(unit_weight * shares[1], k0, soil)
            body = body._replace(gradient=geostatic_gradient(ground, vertical=1))
        name = f"column, {resolution.rows} rows, {shares[1]:.3f} of its weight"
        body, result, residuals = load_gravity(body, unit_weight, shares, prescribed, name=name)
        body = _follow(body, result, law)
        histories += residuals
    return _squeezed(data, body, result, resolution, histories)


def _column(
    data: ColumnInput, soil: HenckyElastic, resolution: Resolution
) -> tuple[Body, Prescribed]:
    """Return the weightless column on rollers."""
    rows, width = resolution.rows, data.height / resolution.rows
    mesh = rectangle_mesh(
        np.array([0.0, width]),
        np.linspace(0.0, data.height, rows + 1),
        is_crossed=resolution.is_crossed,
    )
    body = make_body(
        mesh,
        Ground(0.0, 1.0, soil),
        per_direction=resolution.per_direction,
        is_soil=np.ones(len(mesh.cell_nodes), dtype=bool),
    )
    on_rollers = np.abs(mesh.nodes - [0.0, 0.0]) < 1e-9 * width
    on_rollers[:, 0] |= np.abs(mesh.nodes[:, 0] - width) < 1e-9 * width
    return with_weight_of_points(body), Prescribed(on_rollers, np.zeros_like(mesh.nodes))


def _follow(body: Body, result: StepResult, law: MeshLaw) -> Body:
    """Return the body with the mesh that has followed the displacement of the step."""
    if law == MeshLaw.STAY:
        return body
    mesh = body.mesh
    moved = mesh.nodes + result.equilibrium.displacement
    if law == MeshLaw.NODES:
        return mesh_to(body, straightened(mesh._replace(nodes=moved)))
    height = mesh.reference_nodes[:, 1]
    on_top = height > (1.0 - 1e-9) * height.max()
    return mesh_to(body, stretch(mesh, (1.0, moved[on_top, 1].mean() / height.max())))


def _squeezed(
    data: ColumnInput,
    body: Body,
    result: StepResult,
    resolution: Resolution,
    histories: tuple[tuple[float, ...], ...],
) -> Squeezed:
    """Return stress and errors of the loaded column."""
    points = body.points
    original_height = points.position[:, 1] - points.displacement[:, 1]
    exact = column(
        original_height,
        length=data.height,
        youngs_modulus=data.youngs_modulus,
        poissons_ratio=data.poissons_ratio,
        density=data.density,
        gravity=data.gravity,
    )
    stress = cauchy_stress(points)[:, 1, 1]
    recovered = transfer_least_squares(
        points.position, points.volume, stress, points.position, resolution.neighbours
    )
    initial_volume = points.volume / points.volume_ratio
    base_stress = data.density * data.gravity * data.height
    share = initial_volume / (initial_volume.sum() * base_stress)
    raw_error, recovered_error = (
        float(np.abs(field - exact.vertical_stress) @ share) for field in (stress, recovered)
    )
    return Squeezed(
        original_height,
        points.displacement[:, 1],
        stress,
        recovered,
        exact,
        raw_error,
        recovered_error,
        float(result.equilibrium.reaction[:, 1].sum()),
        base_stress * data.height / resolution.rows,
        histories,
    )


def stress_curve(run: Squeezed) -> Series:
    """Return the recovered vertical stress over the original height."""
    order = np.argsort(run.original_height)
    return Series(
        "Vertical stress of the column, recovered",
        "original height [m]",
        "Cauchy stress [Pa]",
        tuple(run.original_height[order]),
        tuple(run.recovered[order]),
        tuple(run.exact.vertical_stress[order]),
    )
