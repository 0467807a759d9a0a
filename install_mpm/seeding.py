"""Seeding of material points in the cells of the undisturbed ground, with its geostatic state."""

from __future__ import annotations

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.cells import ReferenceCell, sub_region_points
from install_mpm.conventions import GRAVITY, Kinematics
from install_mpm.geostatic import undisturbed_state
from install_mpm.ground import GroundProfile, unit_weights
from install_mpm.material_points import MaterialPoints


def seed_points(
    mesh: BackgroundMesh,
    cell: ReferenceCell,
    ground: GroundProfile,
    per_direction: int,
    *,
    kinematics: Kinematics = Kinematics.PLANE_STRAIN,
    is_soil: np.ndarray | None = None,
    gravity: float = GRAVITY,
) -> MaterialPoints:
    """Return the material points of level ground with its K0 stress and the strain to match.

    Each takes the soil of the layer in which it lies.

    ``is_soil`` (n_cells,) says which cells are filled; by default those below z = 0.  The
    logarithmic strain of the initial stress is referred to the initial configuration, so J = 1 at
    the start.  ``gravity`` (m/s^2) is what makes mass of weight.
    """
    coordinates, shares = sub_region_points(cell, per_direction)
    vertices = mesh.nodes[mesh.cell_nodes[:, : cell.n_vertices]]
    cells = np.flatnonzero(vertices[:, :, -1].mean(axis=1) < 0.0 if is_soil is None else is_soil)
    origin, edges = vertices[cells, 0], vertices[cells, 1:] - vertices[cells, :1]
    position = origin[:, None] + np.einsum("qv,cvi->cqi", coordinates, edges)
    cell_volume = np.abs(np.linalg.det(edges)) * cell.reference_volumes.sum()
    position = position.reshape(-1, cell.dim)
    volume = (cell_volume[:, None] * shares).ravel()
    if kinematics == Kinematics.AXISYMMETRIC:
        volume *= 2.0 * np.pi * position[:, 0]
    n_points = len(position)
    state = undisturbed_state(ground, position[:, -1], cell.dim - 1)
    return MaterialPoints(
        position=position,
        displacement=np.zeros_like(position),
        mass=volume * unit_weights(ground)[state.material] / gravity,
        volume=volume,
        volume_ratio=np.ones(n_points),
        elastic_log_strain=state.elastic_strain,
        kirchhoff_stress=state.stress,
        state_variables=state.state_variables,
        material=state.material,
        cell=np.repeat(cells, len(shares)),
        reference_coordinates=np.tile(coordinates, (len(cells), 1)),
    )
