"""Integration points: where the equilibrium of a step is evaluated, with the state they start from.

The default discretisation lets material points *carry* the state: each integration point of a cell
takes the volume average over the material points of its sub-region (``docs/method.md``).  A scheme
in which the material points are themselves the integration points fills the same record.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class IntegrationPoints(NamedTuple):
    """Integration points sorted by cell, at the start of a step."""

    cell_start: np.ndarray
    """First point of each cell, (n_cells + 1,); cell c owns cell_start[c]:cell_start[c + 1]."""
    reference_coordinates: np.ndarray
    """Position in the reference cell, (n, dim)."""
    shape_values: np.ndarray
    """Shape functions by which the weight of the point acts on the nodes, (n, n_nodes)."""
    shape_gradients: np.ndarray
    """Shape gradients by start-of-step position, (n, n_nodes, dim) in 1/m."""
    hoop_gradients: np.ndarray
    """N_a / r of axisymmetric cells, zero otherwise, (n, n_nodes) in 1/m."""
    volume: np.ndarray
    """Start-of-step volume that the point stands for, (n,) in m^3; zero where the cell is empty."""
    density: np.ndarray
    """Mass over volume, (n,) in kg/m^3."""
    volume_ratio: np.ndarray
    """J at the start of the step, (n,)."""
    elastic_log_strain: np.ndarray
    """Elastic logarithmic strain at the start of the step, (n, 3, 3)."""
    state_variables: np.ndarray
    """State variables of the law at the start of the step, (n, n_state)."""
    material: np.ndarray
    """Row of the soil table, (n,) int64."""


class CellFill(NamedTuple):
    """How full the background cells are at the start of a step."""

    point_order: np.ndarray
    """Material points sorted by cell, (n_points,)."""
    cell_start: np.ndarray
    """First entry of each cell in ``point_order``, (n_cells + 1,)."""
    share: np.ndarray
    """Volume of the material points over cell volume, (n_cells,)."""
    vertex_fill: np.ndarray
    """Soil volume over cell volume around each vertex, (n_nodes,), at least 1 if there is no void
    beside it; zero at other nodes."""
    is_active: np.ndarray
    """The cell holds material points, (n_cells,) bool."""
    is_interior: np.ndarray
    """All vertices are filled: the cell counts with its whole volume, (n_cells,) bool."""
    cell_volume: np.ndarray
    """Volume of the cells, (n_cells,) in m^3."""


class Trial(NamedTuple):
    """State at the integration points for a trial displacement; stored nowhere."""

    elastic_log_strain: np.ndarray
    """(n, 3, 3)"""
    cauchy_stress: np.ndarray
    """(n, 3, 3) in Pa"""
    state_variables: np.ndarray
    """(n, n_state)"""
    volume_ratio: np.ndarray
    """Volume change in the step that the stress belongs to, (n,)."""
    cell_volume_ratio: np.ndarray
    """Mean dilatation of each cell in the step, (n_cells,)."""
    status: np.ndarray
    """0, or the reason why the trial is inadmissible, (n_cells,) int64."""


def empty_trial(points: IntegrationPoints) -> Trial:
    """Return a record for the kernel to fill."""
    n_points, n_cells = len(points.volume), len(points.cell_start) - 1
    return Trial(
        np.zeros((n_points, 3, 3)),
        np.zeros((n_points, 3, 3)),
        np.zeros_like(points.state_variables),
        np.ones(n_points),
        np.ones(n_cells),
        np.zeros(n_cells, dtype=np.int64),
    )
