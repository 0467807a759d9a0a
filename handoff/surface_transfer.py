"""Transfer of interface tractions to another mesh of the surface of a screw pile, part by part.

What is carried over is the difference from the geostatic traction, in local axes, by moving least
squares on each part.  A traction that varies linearly with the place,

    t = a + b x (x - x_m) ,

is added to each part, so that the force and the moment of the difference are kept.  Undisturbed
ground comes out exactly.
"""

from __future__ import annotations

import numpy as np

from handoff.geostatic import geostatic_traction
from handoff.interface_transfer import FESurface
from handoff.transfer import transfer_least_squares
from install_mpm.background_mesh import BackgroundMesh
from install_mpm.ground import GroundProfile
from install_mpm.interface import InterfacePoints, local_axes
from install_mpm.interface_axes import axes_of
from install_mpm.screw_pile import ScrewPile, part_names
from install_mpm.screw_surface import pile_elements, place_points

NEIGHBOURS = 12
"""Interface points in each fit, fewer on a part that has fewer."""


def traction_on_surface(
    ground: GroundProfile,
    pile: ScrewPile,
    mesh: BackgroundMesh,
    points: InterfacePoints,
    surface: FESurface,
) -> np.ndarray:
    """Return the tractions (n, 3) in Pa, (tangential, tangential, normal), at the ``surface``.

    ``points`` are those of the installation on ``mesh``, ``pile`` is the pile at its start.  Only
    points that soil covers count.

    Raises
    ------
    ValueError
        If no soil touches a part of the pile.
    """
    elements, _, _ = pile_elements(mesh, pile)
    _, _, facet_normals = place_points(elements, mesh)
    geostatic = geostatic_traction(ground, points.position, points.normal, facet_normals)
    difference = points.traction - geostatic
    traction = geostatic_traction(ground, surface.positions, surface.normals, surface.facet_normals)
    names = part_names(pile)
    for part in np.unique(surface.parts):
        source = np.flatnonzero((points.part == part) & (points.covered > 0.0))
        target = np.flatnonzero(surface.parts == part)
        if len(source) == 0:
            raise ValueError(
                f"no soil touches the {names[part]} of the installed pile; look at the interface"
                " points of the installed state"
            )
        traction[target] += _carried_over(points, difference, source, surface, target)
    return traction


def _carried_over(
    points: InterfacePoints,
    difference: np.ndarray,
    source: np.ndarray,
    surface: FESurface,
    target: np.ndarray,
) -> np.ndarray:
    """Return the ``difference`` of the points ``source`` at the points ``target`` of one part."""
    areas = (points.area * points.covered)[source]
    position, place = points.position[source], surface.positions[target]
    mapped = transfer_least_squares(
        position, areas, difference[source], place, min(NEIGHBOURS, len(source))
    )
    axes = axes_of(surface.normals[target], place)
    wanted = resultant(position, _in_space(difference, points)[source] * areas[:, None])
    force = np.einsum("nki,nk->ni", axes, mapped) * surface.areas[target][:, None]
    lacking = wanted - resultant(place, force)
    more = _linear_traction(place, surface.areas[target], lacking)
    total: np.ndarray = mapped + np.einsum("nki,ni->nk", axes, more)
    return total


def _in_space(local: np.ndarray, points: InterfacePoints) -> np.ndarray:
    """Return vectors (n, 3) given in the local axes of ``points`` in global ones."""
    vectors: np.ndarray = np.einsum("nki,nk->ni", local_axes(points), local)
    return vectors


def resultant(positions: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Return force and moment about the origin (6,) in N and N m of ``forces`` (n, 3)."""
    moment = np.cross(positions, forces)
    return np.concatenate([forces.sum(axis=0), moment.sum(axis=0)])


def _linear_traction(positions: np.ndarray, areas: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Return the traction (n, 3) in Pa, linear as the module says, with the ``wanted`` resultant.

    A part whose points cannot carry it, such as one with a single point, takes what it can.
    """
    middle = areas @ positions / areas.sum()
    fields = np.zeros((6, len(positions), 3))
    for axis in range(3):
        fields[axis, :, axis] = 1.0
        fields[3 + axis] = np.cross(np.eye(3)[axis], positions - middle)
    matrix = np.stack([resultant(positions, field * areas[:, None]) for field in fields], axis=1)
    scale = np.sqrt(areas.sum())
    rows = np.array([1.0, 1.0, 1.0, 1.0 / scale, 1.0 / scale, 1.0 / scale])
    shares = np.linalg.lstsq(matrix * rows[:, None], wanted * rows, rcond=1e-9)[0]
    traction: np.ndarray = np.tensordot(shares, fields, 1)
    return traction
