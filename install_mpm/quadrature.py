"""The paper's discretisation: material points are themselves the integration points (section 2.1).

No averaging, no injection, no mean dilatation: what the points feel is what they keep.  In an
interior cell the weights can be scaled so that they add up to the cell volume, which removes the
quadrature error of crowded or thinned cells.
"""

from __future__ import annotations

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.cell_fill import cell_geometry, fill_cells
from install_mpm.cells import ReferenceCell
from install_mpm.conventions import Kinematics
from install_mpm.discretisation import Discretisation, GeostaticGradient, StepStart
from install_mpm.equilibrium import StepEquilibrium
from install_mpm.integration_points import CellFill, IntegrationPoints
from install_mpm.kernels.point_shapes import point_shapes
from install_mpm.material_points import MaterialPoints


def give_state(
    points: MaterialPoints,
    mesh: BackgroundMesh,
    model: Discretisation,
    gradient: GeostaticGradient,
) -> StepStart:
    """Return the material points as integration points; ``gradient`` has no part in this scheme."""
    geometry = cell_geometry(mesh, model.cell, model.kinematics)
    fill = fill_cells(points, mesh, model.cell, geometry, model.numerics.fill_threshold)
    quadrature = integration_points(
        points, mesh, model.cell, fill, model.kinematics, is_cell_weighted=model.is_cell_weighted
    )
    return StepStart(points, fill, quadrature, n_empty=0)


def integration_points(
    points: MaterialPoints,
    mesh: BackgroundMesh,
    cell: ReferenceCell,
    fill: CellFill,
    kinematics: Kinematics,
    *,
    is_cell_weighted: bool,
) -> IntegrationPoints:
    """Return the material points, sorted by cell, as integration points.

    With ``is_cell_weighted`` the volumes of the points of an interior cell are scaled to its
    volume.
    """
    order = fill.point_order
    values, gradients, hoop = shapes(points, mesh, cell, kinematics)
    scale = np.ones(len(mesh.cell_nodes))
    if is_cell_weighted:
        scale = np.where(
            fill.is_interior & fill.is_active, 1.0 / np.maximum(fill.share, 1e-300), 1.0
        )
    return IntegrationPoints(
        cell_start=fill.cell_start,
        reference_coordinates=points.reference_coordinates[order],
        shape_values=values[order],
        shape_gradients=gradients[order],
        hoop_gradients=hoop[order],
        volume=(points.volume * scale[points.cell])[order],
        density=(points.mass / points.volume)[order],
        volume_ratio=points.volume_ratio[order],
        elastic_log_strain=points.elastic_log_strain[order],
        state_variables=points.state_variables[order],
        material=points.material[order],
    )


def take_state(
    points: MaterialPoints,
    mesh: BackgroundMesh,
    fill: CellFill,
    equilibrium: StepEquilibrium,
    model: Discretisation,
    gradient: GeostaticGradient,
) -> tuple[MaterialPoints, bool]:
    """Return the material points with the state of the integration points; all are sound."""
    trial, displacement = equilibrium.trial, equilibrium.displacement
    values, _, _ = shapes(points, mesh, model.cell, model.kinematics)
    motion = np.einsum("pa,pai->pi", values, displacement[mesh.cell_nodes[points.cell]])
    back = np.empty_like(fill.point_order)
    back[fill.point_order] = np.arange(len(back))
    ratio = trial.volume_ratio[back]
    volume_ratio = points.volume_ratio * ratio
    moved = points._replace(
        position=points.position + motion,
        displacement=points.displacement + motion,
        volume=points.volume * ratio,
        volume_ratio=volume_ratio,
        elastic_log_strain=trial.elastic_log_strain[back],
        kirchhoff_stress=trial.cauchy_stress[back] * volume_ratio[:, None, None],
        state_variables=trial.state_variables[back],
        cell=points.cell.copy(),
        reference_coordinates=points.reference_coordinates.copy(),
    )
    return moved, True


def shapes(
    points: MaterialPoints, mesh: BackgroundMesh, cell: ReferenceCell, kinematics: Kinematics
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return shape values, gradients and hoop gradients of all points, see ``point_shapes``."""
    n_points = len(points.cell)
    values = np.empty((n_points, cell.n_nodes))
    gradients = np.empty((n_points, cell.n_nodes, cell.dim))
    hoop = np.empty((n_points, cell.n_nodes))
    point_shapes(
        cell.cell_type, mesh.cell_nodes, mesh.nodes, kinematics == Kinematics.AXISYMMETRIC,
        points.cell, points.reference_coordinates, values, gradients, hoop,
    )  # fmt: skip
    return values, gradients, hoop
