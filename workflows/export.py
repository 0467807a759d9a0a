"""Views of the results for ParaView: VTU files of material points, background mesh and FE models.

An export, not a state file: nothing reads it back.  Coordinates are (x, z, 0), so what ParaView
calls XX, YY, ZZ is horizontal, vertical and out of plane.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import meshio
import numpy as np

from install_mpm.ground import GroundProfile, hydrostatic_pressure
from install_mpm.material_points import cauchy_stress, plane_area
from install_mpm.state_file import InstalledState
from service_fe.results import ServiceResult

VTK_NAMES = {3: "triangle", 6: "triangle6"}
"""Names of cells by their number of nodes."""

PARAVIEW_ORDER = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))


def export_material_points(path: Path, installed: InstalledState, ground: GroundProfile) -> None:
    """Write the material points as vertices with stress and displacement.

    Stresses are those in excess of the hydrostatic pressure, which stands beside them.
    """
    points = installed.material_points
    data = {
        "displacement": _in_3d(points.displacement),
        "cauchy_stress": _six(cauchy_stress(points)),
        "mean_pressure": _mean_pressure(cauchy_stress(points)),
        "hydrostatic_pressure": hydrostatic_pressure(ground, points.position[:, -1]),
        "volume_ratio": points.volume_ratio,
        "volume": points.volume,
        "material": points.material,
    }
    for k in range(points.state_variables.shape[1]):
        data[f"state_variable_{k}"] = points.state_variables[:, k]
    vertices = np.arange(len(points.position))[:, None]
    _write(path, meshio.Mesh(_in_3d(points.position), [("vertex", vertices)], point_data=data))


def export_background_mesh(path: Path, installed: InstalledState) -> None:
    """Write the background mesh at the end of the installation, with the fill of its cells."""
    mesh, points = installed.background_mesh, installed.material_points
    corners = mesh.nodes[mesh.cell_nodes[:, :3]]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = 0.5 * np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    soil = plane_area(points, installed.kinematics)
    filled = np.bincount(points.cell, weights=soil, minlength=len(area))
    data = {"fill": [filled / area]}
    moved = {"displacement": _in_3d(mesh.nodes - mesh.reference_nodes)}
    cells = [(VTK_NAMES[mesh.cell_nodes.shape[1]], mesh.cell_nodes)]
    _write(path, meshio.Mesh(_in_3d(mesh.nodes), cells, point_data=moved, cell_data=data))


def export_service(path: Path, result: ServiceResult) -> None:
    """Write the FE mesh with displacement and stress (mean of each cell) of every programme."""
    mesh = result.mesh
    point_data, cell_data = {}, {}
    for entry in result.programmes:
        name = entry.programme.name
        stress = _cell_means(
            entry.state.cauchy_stress, result.integration.volume, len(mesh.cell_nodes)
        )
        point_data[f"displacement_{name}"] = _in_3d(entry.soil.displacement)
        cell_data[f"cauchy_stress_{name}"] = [_six(stress)]
        cell_data[f"mean_pressure_{name}"] = [_mean_pressure(stress)]
    cells = [("triangle6", mesh.cell_nodes)]
    _write(path, meshio.Mesh(_in_3d(mesh.nodes), cells, point_data=point_data, cell_data=cell_data))


def _cell_means(values: np.ndarray, volumes: np.ndarray, n_cells: int) -> np.ndarray:
    """Return volume-weighted means (cell, 3, 3) of values that are stored cell by cell."""
    weights = volumes.reshape(n_cells, -1)
    per_cell = values.reshape(n_cells, -1, 3, 3)
    means: np.ndarray = np.einsum("cq,cqij->cij", weights, per_cell)
    return means / weights.sum(axis=1)[:, None, None]


def _mean_pressure(stress: np.ndarray) -> np.ndarray:
    pressure: np.ndarray = -np.trace(stress, axis1=1, axis2=2) / 3.0
    return pressure


def _six(tensor: np.ndarray) -> np.ndarray:
    return np.stack([tensor[:, i, j] for i, j in PARAVIEW_ORDER], axis=1)


def _in_3d(vectors: np.ndarray) -> np.ndarray:
    """Return ``vectors`` (n, 2 or 3) with a third component, zero in the plane."""
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))


def _write(path: Path, mesh: Any) -> None:
    """Write a VTU file atomically."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(path.name + ".partial")
    meshio.write(partial, mesh, file_format="vtu")
    partial.replace(path)
