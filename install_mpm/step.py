"""One installation step: the method on a page.

(i)    material points give their state to the integration points of the mesh (ii)   the pile moves,
and the mesh finds the displacement at which soil and interface are in equilibrium (iii)  material
points take that displacement: they move, strain and return to the yield surface (iv)   the mesh
follows the pile, and every material point is located in it again
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.carriers import (
    GeostaticGradient,
    cell_geometry,
    fill_cells,
    inject,
    integration_points,
)
from install_mpm.equilibrium import Discretisation, Prescribed, StepEquilibrium, find_equilibrium
from install_mpm.integration_points import CellFill
from install_mpm.interface import InterfacePoints
from install_mpm.kernels.carry import carry_points
from install_mpm.kernels.locate import PROJECTED, locate_points
from install_mpm.material_points import MaterialPoints
from install_mpm.pile import PileMotion

LEVEL_FILL = 0.4
"""Fill of a vertex above which its facets count as covered; about 1/2 at a level surface."""


class StepCounts(NamedTuple):
    """Irregularities of a step that were treated and are reported."""

    empty_cells: int
    partly_filled_cells: int
    empty_integration_points: int
    injected_points: int
    projected_points: int


class StepResult(NamedTuple):
    """State after a step; ``points`` and ``interface`` are of use only if ``is_converged``."""

    is_converged: bool
    equilibrium: StepEquilibrium
    points: MaterialPoints
    interface: InterfacePoints
    mesh: BackgroundMesh
    counts: StepCounts


def step(
    points: MaterialPoints,
    mesh: BackgroundMesh,
    interface: InterfacePoints,
    motion: PileMotion,
    prescribed: Prescribed,
    start: np.ndarray,
    move_mesh: Callable[[BackgroundMesh], BackgroundMesh],
    model: Discretisation,
    gradient: GeostaticGradient,
) -> StepResult:
    """Return the state after the pile has moved by ``motion``.

    ``start`` (n_nodes, dim) is the first trial displacement in m; ``move_mesh`` is the law by which
    the mesh follows. Nothing that is passed in is changed, so a step that does not converge needs
    no undo.
    """
    geometry = cell_geometry(mesh, model.cell)
    fill = fill_cells(points, mesh, model.cell, geometry, model.numerics.fill_threshold)
    enriched = inject(points, mesh, model.cell, geometry, fill, gradient)
    if len(enriched.mass) > len(points.mass):
        fill = fill_cells(enriched, mesh, model.cell, geometry, model.numerics.fill_threshold)
    quadrature, is_empty = integration_points(enriched, model.cell, geometry, fill, gradient)
    interface = switch_on(interface, fill, model)

    equilibrium = find_equilibrium(
        mesh, quadrature, fill, interface, motion, prescribed, start, model
    )
    counts = StepCounts(
        empty_cells=int(np.count_nonzero(fill.is_interior & ~fill.is_active)),
        partly_filled_cells=int(np.count_nonzero(fill.is_active & ~fill.is_interior)),
        empty_integration_points=int(np.count_nonzero(is_empty)),
        injected_points=len(enriched.mass) - len(points.mass),
        projected_points=0,
    )
    if not equilibrium.newton.is_converged:
        return StepResult(False, equilibrium, points, interface, mesh, counts)

    carried, is_sound = carry(enriched, mesh, fill, equilibrium, model, gradient)
    moved_mesh = move_mesh(mesh)
    n_projected = locate(carried, moved_mesh) if is_sound else 0
    return StepResult(
        is_sound,
        equilibrium,
        carried,
        interface._replace(traction=equilibrium.traction),
        moved_mesh,
        counts._replace(projected_points=n_projected),
    )


def switch_on(interface: InterfacePoints, fill: CellFill, model: Discretisation) -> InterfacePoints:
    """Return the interface with the points active that lie beside soil; others lose their traction.

    A facet at the ground surface counts with the share of it that soil covers, judged by its
    emptier vertex.
    """
    elements = model.elements
    ends = elements.nodes[:, : min(2, elements.nodes.shape[1])]
    covered = np.minimum(fill.vertex_fill[ends].min(axis=1, initial=1.0) / LEVEL_FILL, 1.0)
    covered = np.repeat(
        np.where(fill.is_active[elements.cell], covered, 0.0), len(elements.weights)
    )
    return interface._replace(
        covered=covered, traction=np.where(covered[:, None] > 0.0, interface.traction, 0.0)
    )


def carry(
    points: MaterialPoints,
    mesh: BackgroundMesh,
    fill: CellFill,
    equilibrium: StepEquilibrium,
    model: Discretisation,
    gradient: GeostaticGradient,
) -> tuple[MaterialPoints, bool]:
    """Return the material points after the step, and whether all of them are sound."""
    updated = MaterialPoints(*(np.array(field) for field in points))
    status = np.zeros(len(mesh.cell_nodes), dtype=np.int64)
    carry_points(
        model.cell.cell_type, mesh.cell_nodes, mesh.nodes, equilibrium.displacement,
        equilibrium.trial.cell_volume_ratio, fill.point_order, fill.cell_start, points,
        model.materials, gradient.strain, model.has_mean_dilatation, updated, status,
    )  # fmt: skip
    return updated, not status.any()


def locate(points: MaterialPoints, mesh: BackgroundMesh) -> int:
    """Find the cell of every point, in place; return how many were brought back into the mesh."""
    status, before = np.zeros(len(points.cell), dtype=np.int64), points.position.copy()
    locate_points(
        mesh.nodes, mesh.cell_nodes, mesh.cell_neighbours, points.position, points.cell,
        points.reference_coordinates, status, np.empty(3),
    )  # fmt: skip
    points.displacement[:] += points.position - before
    return int(np.count_nonzero(status == PROJECTED))
