"""Views of a screw pile installation for ParaView: series of frames, and the state at the end.

An export, not a state file: no computation starts from it.  ``pile_surface.pvd``,
``material_points.pvd`` and ``background_mesh.pvd`` hold the stored frames in order; the time of a
frame is its load step.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from install_mpm.ground import GroundProfile
from install_mpm.installation import InstallationProgress, Observer
from install_mpm.screw_programme import total_length
from install_mpm.state_file import InstalledState
from workflows.directory import FRAMES, SCREW_VIEWS, VIEWS, write_text
from workflows.export import export_material_points
from workflows.screw_case import ScrewCase
from workflows.screw_frames import (
    PileSurface,
    PointCloud,
    fill_of,
    pile_surface,
    points_near_pile,
    vertex_mesh,
)

SURFACE, POINTS, MESH = "pile_surface", "material_points", "background_mesh"
SERIES = (SURFACE, POINTS, MESH)


FRAMES_OF_A_RUN = 40
"""About how many frames an installation leaves."""


def frame_interval(case: ScrewCase) -> int:
    """Return after how many load steps a frame is stored."""
    n_steps = total_length(case.pile, case.installation) / case.installation.step
    return max(1, round(n_steps / FRAMES_OF_A_RUN))


def frame_writer(directory: Path, every: int) -> Observer:
    """Return an observer that stores a frame of every ``every``-th load step, and of the last.

    Frames are named by their load step.  Those of later steps than the one that was reached belong
    to an earlier run and are removed, so a resumed installation leaves the same frames as one that
    was never interrupted.
    """

    def observe(state: InstalledState, progress: InstallationProgress) -> None:
        is_last = progress.travel >= progress.target * (1.0 - 1e-12)
        if progress.load_step % every == 0 or is_last:
            write_frame(directory, state)

    return observe


def write_frame(directory: Path, state: InstalledState) -> None:
    """Store the frame of the last load step of ``state`` and bring the lists of frames up to date.

    Every file is replaced as a whole: a reader never sees half of one.
    """
    number = len(state.history.travel) - 1
    _remove_later_frames(directory, number)
    _write(_frame_path(directory, SURFACE, number), _surface_mesh(pile_surface(state.interface)))
    _write(_frame_path(directory, POINTS, number), _points_mesh(points_near_pile(state)))
    _write(_frame_path(directory, MESH, number), _cells_mesh(state))
    for series in SERIES:
        _write_list(directory, series)


def stored_frames(directory: Path) -> list[int]:
    """Return the load steps of which all files of the frame are there, in order."""
    found = [
        {
            int(match[1])
            for path in (directory / FRAMES).glob(f"{series}_*.vtu")
            if (match := re.fullmatch(rf"{series}_(\d+)\.vtu", path.name))
        }
        for series in SERIES
    ]
    return sorted(set.intersection(*found))


def read_surface(directory: Path, number: int) -> PileSurface:
    """Return the pile surface of a stored frame."""
    mesh = meshio.read(_frame_path(directory, SURFACE, number))
    data = mesh.point_data
    return PileSurface(
        corners=mesh.points.reshape(-1, 3, 3).astype(np.float64),
        part=mesh.cell_data["part"][0],
        traction=data["traction"].reshape(-1, 3, 3),
        pressure=data["contact_pressure"].reshape(-1, 3),
        shear=data["shear_traction"].reshape(-1, 3),
    )


def read_points(directory: Path, number: int) -> PointCloud:
    """Return the material points of a stored frame."""
    mesh = meshio.read(_frame_path(directory, POINTS, number))
    data = mesh.point_data
    return PointCloud(
        mesh.points.astype(np.float64), data["displacement"], data["mean_pressure"], data["volume"]
    )


def export_screw_pile(
    directory: Path, installed: InstalledState, ground: GroundProfile
) -> list[Path]:
    """Write the state at the end in full into ``directory``; return the files."""
    paths = [directory / view for view in SCREW_VIEWS]
    _write(paths[0], _surface_mesh(pile_surface(installed.interface)))
    export_material_points(paths[1], installed, ground)
    _write(paths[2], _cells_mesh(installed))
    return paths


def _frame_path(directory: Path, series: str, number: int) -> Path:
    return directory / FRAMES / f"{series}_{number:06d}.vtu"


def _remove_later_frames(directory: Path, number: int) -> None:
    for path in (directory / FRAMES).glob("*_*.vtu"):
        step = path.stem.rpartition("_")[2]
        if step.isdigit() and int(step) > number:
            path.unlink()


def _write_list(directory: Path, series: str) -> None:
    """Write the list of the frames of a series, with the load step as time."""
    rows = [
        f'<DataSet timestep="{number}" '
        f'file="{_frame_path(Path(), series, number).relative_to(VIEWS).as_posix()}"/>'
        for number in stored_frames(directory)
    ]
    lines = ['<VTKFile type="Collection" version="0.1">', "<Collection>", *rows, "</Collection>",
             "</VTKFile>", ""]  # fmt: skip
    write_text(directory / VIEWS / f"{series}.pvd", "\n".join(lines))


def _surface_mesh(surface: PileSurface) -> Any:
    """Return the pile surface; its triangles share no corners, tractions jump between them."""
    n = len(surface.corners)
    return meshio.Mesh(
        _single(surface.corners.reshape(-1, 3)),
        [("triangle", np.arange(3 * n).reshape(-1, 3))],
        point_data={
            "traction": _single(surface.traction.reshape(-1, 3)),
            "contact_pressure": _single(surface.pressure.ravel()),
            "shear_traction": _single(surface.shear.ravel()),
        },
        cell_data={"part": [surface.part]},
    )


def _points_mesh(cloud: PointCloud) -> Any:
    return meshio.Mesh(
        _single(cloud.position),
        [("vertex", np.arange(len(cloud.position))[:, None])],
        point_data={
            "displacement": _single(cloud.displacement),
            "mean_pressure": _single(cloud.mean_pressure),
            "volume": _single(cloud.volume),
        },
    )


def _cells_mesh(installed: InstalledState) -> Any:
    mesh = installed.background_mesh
    used, cells, volume = vertex_mesh(mesh)
    return meshio.Mesh(
        _single(mesh.nodes[used]),
        [("tetra", cells)],
        point_data={"displacement": _single((mesh.nodes - mesh.reference_nodes)[used])},
        cell_data={"fill": [_single(fill_of(installed, volume))]},
    )


def _single(values: np.ndarray) -> np.ndarray:
    """Return ``values`` in single precision, enough for pictures."""
    return values.astype(np.float32)


def _write(path: Path, mesh: Any) -> None:
    """Write a VTU file atomically."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(path.name + ".partial")
    meshio.write(partial, mesh, file_format="vtu")
    partial.replace(path)
