"""Stiffnesses of one step only: the volumetric term, and what holds cells without enough soil."""

from __future__ import annotations

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.constitutive.dispatch import Materials, Model, state_columns
from install_mpm.constitutive.elastic import BULK, SHEAR
from install_mpm.constitutive.pressure_elasticity import bulk_modulus, volumetric_strain
from install_mpm.conventions import Kinematics
from install_mpm.discretisation import Discretisation
from install_mpm.hanging_soil import cells_around_hanging_soil
from install_mpm.integration_points import CellFill, IntegrationPoints
from install_mpm.kernels.cell_records import CellOptions

SHEAR_OVER_YOUNGS = 0.5
"""Shear over Young's modulus of the soft stress, whose Poisson's ratio is zero."""

PRESSURE_DEPENDENT = (Model.MODIFIED_CAM_CLAY, Model.CRITICAL_STATE_SAND)
"""Laws whose stiffness grows with the pressure."""

REFERENCE_PRESSURE = 50e3
"""Pressure in Pa, that in a few metres of depth, at which their stiffness scales soft terms."""

OPENING_PRESSURE = 10e3
"""Mean pressure in Pa under which sand may open in a step, and is held by ``open_stiffness``.

Behind the trailing edge of a screw pile sand opens in the step in which it comes there: what had
opened before is elsewhere.  There the pressure is below this.
"""

SHEAR_OVER_BULK = 0.5
"""Shear over bulk modulus there: a Poisson's ratio of 0.29."""


def youngs_modulus(materials: Materials) -> np.ndarray:
    """Return Young's modulus (n_materials,) in Pa, at ``REFERENCE_PRESSURE`` where it varies."""
    bulk, shear = materials.parameters[:, BULK].copy(), materials.parameters[:, SHEAR].copy()
    for row in np.flatnonzero(np.isin(materials.model, PRESSURE_DEPENDENT)):
        bulk[row] = bulk_modulus(REFERENCE_PRESSURE, materials.parameters[row])
        shear[row] = SHEAR_OVER_BULK * bulk[row]
    modulus: np.ndarray = 9.0 * bulk * shear / (3.0 * bulk + shear)
    return modulus


def cell_options(fill: CellFill, points: IntegrationPoints, model: Discretisation) -> CellOptions:
    """Return the stiffnesses of this step only: volumetric term, and softly held cells.

    These are cells that soil does not fill, and those in which it has opened or may open.
    """
    n_cells, n_per_cell = len(fill.cell_volume), np.diff(points.cell_start)
    first = np.minimum(points.cell_start[:-1], len(points.material) - 1)
    modulus = youngs_modulus(model.materials)[points.material[first]]
    cell = np.repeat(np.arange(n_cells), n_per_cell)
    counted = np.bincount(cell, points.volume, n_cells) / fill.cell_volume
    missing = np.maximum(1.0 - counted, 0.0)  # of the volume, not of the points: they may crowd
    return CellOptions(
        is_finite_strain=model.is_finite_strain,
        has_mean_dilatation=model.has_mean_dilatation and model.is_finite_strain,
        is_axisymmetric=model.kinematics == Kinematics.AXISYMMETRIC,
        has_moment_free_soft_stress=model.compares_resultants,
        volumetric_term=model.numerics.volumetric_term * modulus,
        soft_stiffness=SHEAR_OVER_YOUNGS
        * modulus
        * (
            model.numerics.soft_stiffness * missing
            + model.numerics.open_stiffness * opening_share(points, model.materials)
        )
        * fill.cell_volume
        / np.maximum(n_per_cell, 1),
    )


def opening_share(points: IntegrationPoints, materials: Materials) -> np.ndarray:
    """Return how much of each cell has opened or may open in the step, (n_cells,), 0 to 1.

    An integration point of sand counts with the part that it lacks of the elastic volumetric strain
    under ``OPENING_PRESSURE``; where it carries no pressure it counts in full.
    """
    firm = volumetric_strain_under(OPENING_PRESSURE, materials)[points.material]
    strain = np.trace(points.elastic_log_strain, axis1=1, axis2=2)
    can_open = state_columns(materials, "opening")[points.material] >= 0
    lacking = np.where(can_open, np.clip(1.0 - strain / firm, 0.0, 1.0), 0.0)
    n_per_cell = np.diff(points.cell_start)
    cell = np.repeat(np.arange(len(n_per_cell)), n_per_cell)
    share: np.ndarray = np.bincount(cell, lacking, len(n_per_cell)) / np.maximum(n_per_cell, 1)
    return share


def volumetric_strain_under(pressure: float, materials: Materials) -> np.ndarray:
    """Return the elastic volumetric strain (n_materials,) of each soil under ``pressure`` in Pa."""
    strain: np.ndarray = -pressure / materials.parameters[:, BULK]
    for row in np.flatnonzero(np.isin(materials.model, PRESSURE_DEPENDENT)):
        strain[row] = volumetric_strain(pressure, materials.parameters[row])
    return strain


def softly_held(
    mesh: BackgroundMesh, points: IntegrationPoints, fill: CellFill, options: CellOptions
) -> np.ndarray:
    """Return the cells (n_cells,) bool without soil that the soft stress holds."""
    has_soft_stress = (options.soft_stiffness > 0.0) & (np.diff(points.cell_start) > 0)
    if not has_soft_stress.any():
        return has_soft_stress
    held: np.ndarray = cells_around_hanging_soil(mesh, fill.is_active) & has_soft_stress
    return held
