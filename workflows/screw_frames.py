"""Frames of a screw pile installation: what a picture or ParaView needs of one load step.

A frame is small: the pile surface with its tractions, a thinned set of material points around the
pile, and the background mesh without its mid-side nodes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.interface import InterfacePoints, global_traction
from install_mpm.material_points import MaterialPoints, cauchy_stress
from install_mpm.state_file import InstalledState

MOST_POINTS = 20000
"""Material points in a frame; of more, every second, third, ... is left out."""

REACH = 3.0
"""Radius around the axis in which points are kept, over the largest radius of the pile."""


class PileSurface(NamedTuple):
    """The pile surface as triangles, each with a value at each of its corners."""

    corners: np.ndarray
    """(n, 3, 3) in m."""
    part: np.ndarray
    """Number of the part of the pile, (n,)."""
    traction: np.ndarray
    """Of the soil on the pile, (n, 3, 3) in Pa."""
    pressure: np.ndarray
    """Contact pressure, compression positive, (n, 3) in Pa."""
    shear: np.ndarray
    """Magnitude of the traction along the surface, (n, 3) in Pa."""


class PointCloud(NamedTuple):
    """Material points with what pictures show of them."""

    position: np.ndarray
    """(n, 3) in m."""
    displacement: np.ndarray
    """Since the start of the installation, (n, 3) in m."""
    mean_pressure: np.ndarray
    """Compression positive, (n,) in Pa."""
    volume: np.ndarray
    """(n,) in m^3."""


def pile_surface(interface: InterfacePoints) -> PileSurface:
    """Return the pile surface of an interface in space.

    The three points of a facet lie half-way between its centre and its corners, so the corners
    follow from the points; each takes the traction of the point next to it.
    """
    points = interface.position.reshape(-1, 3, 3)
    covered = interface.covered.reshape(-1, 3)
    traction = interface.traction.reshape(-1, 3, 3)
    return PileSurface(
        corners=2.0 * points - points.mean(axis=1, keepdims=True),
        part=interface.part[::3],
        traction=-global_traction(interface).reshape(-1, 3, 3) * covered[:, :, None],
        pressure=-traction[:, :, 2] * covered,
        shear=np.linalg.norm(traction[:, :, :2], axis=2) * covered,
    )


def points_near_pile(installed: InstalledState) -> PointCloud:
    """Return the material points around the pile, at most ``MOST_POINTS``."""
    cloud = point_cloud(installed.material_points)
    largest = np.linalg.norm(installed.interface.position[:, :2], axis=1).max()
    is_near = np.linalg.norm(cloud.position[:, :2], axis=1) < REACH * largest
    keep = np.flatnonzero(is_near)
    keep = keep[:: -(-len(keep) // MOST_POINTS)] if len(keep) else keep
    share = is_near.sum() / max(len(keep), 1)
    thinned = PointCloud(*(values[keep] for values in cloud))
    return thinned._replace(volume=share * thinned.volume)


def point_cloud(points: MaterialPoints) -> PointCloud:
    """Return all material points."""
    pressure = -np.trace(cauchy_stress(points), axis1=1, axis2=2) / 3.0
    return PointCloud(points.position, points.displacement, pressure, points.volume)


def vertex_mesh(mesh: BackgroundMesh) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the mesh without its mid-side nodes: which nodes (m,) stay, cells (n, 4), volume (n,).

    The cells are straight-edged, so nothing is lost.
    """
    used, cells = np.unique(mesh.cell_nodes[:, :4], return_inverse=True)
    cells = cells.reshape(-1, 4)
    corners = mesh.nodes[used][cells]
    volume = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6.0
    return used, cells, volume


def fill_of(installed: InstalledState, volume: np.ndarray) -> np.ndarray:
    """Return the volume of material points over that of each cell (n,)."""
    points = installed.material_points
    inside = np.bincount(points.cell, weights=points.volume, minlength=len(volume))
    fill: np.ndarray = inside / volume
    return fill
