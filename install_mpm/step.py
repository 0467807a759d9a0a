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

from install_mpm import carriers, quadrature
from install_mpm.background_mesh import BackgroundMesh
from install_mpm.discretisation import Discretisation, GeostaticGradient, Scheme, StepStart
from install_mpm.equilibrium import Prescribed, StepEquilibrium, find_equilibrium
from install_mpm.integration_points import CellFill
from install_mpm.interface import InterfacePoints
from install_mpm.loaded_pile import LoadedMotions
from install_mpm.location import locate
from install_mpm.material_points import MaterialPoints
from install_mpm.pile import PileMotion
from install_mpm.timing import measured

SCHEMES = {Scheme.CARRIERS: carriers, Scheme.QUADRATURE: quadrature}

LEVEL_FILL = 0.4
"""Fill of a vertex above which its facets count as covered; about 1/2 at a level surface."""


class StepCounts(NamedTuple):
    """Irregularities of a step that were treated and are reported."""

    empty_cells: int
    partly_filled_cells: int
    empty_integration_points: int
    injected_points: int
    merged_points: int
    projected_points: int
    mass_error: float
    """Relative change of the mass of all points by merging and splitting."""
    volume_error: float
    """The same of their volume."""
    closed_volume: float
    """Volume in m3 of the openings of sand that closed beside sand under pressure."""


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
    move_mesh: Callable[[BackgroundMesh, PileMotion], BackgroundMesh],
    model: Discretisation,
    gradient: GeostaticGradient,
    loaded: LoadedMotions | None = None,
) -> StepResult:
    """Return the state after the pile has moved by ``motion``, and as far as it is ``loaded``.

    ``start`` (n_nodes, dim) is the first trial displacement in m; ``move_mesh`` is the law by which
    the mesh follows the motion of the pile. Nothing that is passed in is changed, so a step that
    does not converge needs no undo.
    """
    scheme = SCHEMES[model.scheme]
    with measured("transfer"):
        given = scheme.give_state(points, mesh, model, gradient)
    interface = switch_on(interface, given.fill, model)

    equilibrium = find_equilibrium(
        mesh, given.quadrature, given.fill, interface, motion, prescribed, start, model, loaded
    )
    counts = count(points, given)
    if not equilibrium.newton.is_converged:
        return StepResult(False, equilibrium, points, interface, mesh, counts)

    with measured("transfer"):
        carried, is_sound = scheme.take_state(
            given.points, mesh, given.fill, equilibrium, model, gradient
        )
    moved_mesh = move_mesh(mesh, equilibrium.motion)
    with measured("location"):
        n_projected = locate(carried, moved_mesh) if is_sound else 0
    return StepResult(
        is_sound,
        equilibrium,
        carried,
        interface._replace(traction=equilibrium.traction),
        moved_mesh,
        counts._replace(projected_points=n_projected),
    )


def count(points: MaterialPoints, given: StepStart) -> StepCounts:
    """Return the irregularities at the start of a step; ``points`` are those before injection."""
    is_active, is_interior = given.fill.is_active, given.fill.is_interior
    return StepCounts(
        empty_cells=int(np.count_nonzero(is_interior & ~is_active)),
        partly_filled_cells=int(np.count_nonzero(is_active & ~is_interior)),
        empty_integration_points=given.n_empty,
        injected_points=given.n_injected,
        merged_points=given.n_merged,
        projected_points=0,
        mass_error=_relative_change(points.mass.sum(), given.points.mass.sum()),
        volume_error=_relative_change(
            points.volume.sum(), given.points.volume.sum() + given.closed_volume
        ),
        closed_volume=given.closed_volume,
    )


def _relative_change(before: float, after: float) -> float:
    """Return the change of a sum over its size before, zero if it is zero (soil without weight)."""
    return float(abs(after - before) / (before or 1.0))


def switch_on(interface: InterfacePoints, fill: CellFill, model: Discretisation) -> InterfacePoints:
    """Return the interface with the points active that lie beside soil; others lose their traction.

    A facet at the ground surface counts with the share of it that soil covers, judged by its
    emptier vertex.
    """
    elements = model.elements
    vertices = elements.nodes[:, : interface.position.shape[1]]
    covered = np.minimum(fill.vertex_fill[vertices].min(axis=1, initial=1.0) / LEVEL_FILL, 1.0)
    covered = np.repeat(
        np.where(fill.is_active[elements.cell], covered, 0.0), len(elements.weights)
    )
    return interface._replace(
        covered=covered, traction=np.where(covered[:, None] > 0.0, interface.traction, 0.0)
    )
