"""Seeding of material points in the cells of the undisturbed ground, with its geostatic state."""

from __future__ import annotations

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.cells import ReferenceCell, sub_region_points
from install_mpm.constitutive import dispatch
from install_mpm.constitutive.mandel import COLUMN, ROW, SCALE
from install_mpm.constitutive.parameters import SoilParameters
from install_mpm.conventions import GRAVITY, Kinematics
from install_mpm.discretisation import GeostaticGradient
from install_mpm.ground import Ground, geostatic_stress
from install_mpm.material_points import MaterialPoints


def seed_points(
    mesh: BackgroundMesh,
    cell: ReferenceCell,
    ground: Ground,
    per_direction: int,
    *,
    kinematics: Kinematics = Kinematics.PLANE_STRAIN,
    is_soil: np.ndarray | None = None,
) -> MaterialPoints:
    """Return the material points of level ground with its K0 stress and the strain to match.

    ``is_soil`` (n_cells,) says which cells are filled; by default those below z = 0.  The
    logarithmic strain of the initial stress is referred to the initial configuration, so J = 1 at
    the start.
    """
    coordinates, shares = sub_region_points(cell, per_direction)
    vertices = mesh.nodes[mesh.cell_nodes[:, : cell.n_vertices]]
    cells = np.flatnonzero(vertices[:, :, -1].mean(axis=1) < 0.0 if is_soil is None else is_soil)
    origin, edges = vertices[cells, 0], vertices[cells, 1:] - vertices[cells, :1]
    position = origin[:, None] + np.einsum("qv,cvi->cqi", coordinates, edges)
    cell_volume = np.abs(np.linalg.det(edges)) / 2.0
    position = position.reshape(-1, cell.dim)
    volume = (cell_volume[:, None] * shares).ravel()
    if kinematics == Kinematics.AXISYMMETRIC:
        volume *= 2.0 * np.pi * position[:, 0]
    n_points = len(position)
    stress = geostatic_stress(ground, position[:, -1], cell.dim - 1)
    state = dispatch.initial_state(ground.soil, -position[:, -1], stress)
    return MaterialPoints(
        position=position,
        displacement=np.zeros_like(position),
        mass=volume * ground.unit_weight / GRAVITY,
        volume=volume,
        volume_ratio=np.ones(n_points),
        elastic_log_strain=elastic_strain_of(ground.soil, stress, state),
        kirchhoff_stress=stress,
        state_variables=state,
        material=np.zeros(n_points, dtype=np.int64),
        cell=np.repeat(cells, len(shares)),
        reference_coordinates=np.tile(coordinates, (len(cells), 1)),
    )


def elastic_strain_of(soil: SoilParameters, stress: np.ndarray, state: np.ndarray) -> np.ndarray:
    """Return the elastic strain (n, 3, 3) of ``soil`` of ``state`` (n, n_state) under ``stress``.

    ``stress`` is (n, 3, 3) in Pa.
    """
    material = np.zeros(len(stress), dtype=np.int64)
    strain = np.empty((len(stress), 6))
    six_vectors = np.ascontiguousarray(stress[:, ROW, COLUMN] * SCALE)
    dispatch.elastic_strain_from_stress_all(
        dispatch.pack([soil]), material, six_vectors, state, strain
    )
    tensor = np.empty_like(stress)
    tensor[:, ROW, COLUMN] = tensor[:, COLUMN, ROW] = strain / SCALE
    return tensor


def geostatic_gradient(ground: Ground, vertical: int) -> GeostaticGradient:
    """Return geostatic stress and strain per metre of height; both are linear in the ground."""
    per_metre = -geostatic_stress(ground, np.array([-1.0]), vertical)
    state = dispatch.initial_state(ground.soil, np.ones(1), -per_metre)
    strain = elastic_strain_of(ground.soil, per_metre, state)
    return GeostaticGradient(strain=strain, stress=per_metre)
