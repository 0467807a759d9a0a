"""A quarter or half of a cylinder of ground around the z axis, for loads even or odd in x and y.

The quarter has positive x and y.  The half has positive y, for what is neither even nor odd in x,
such as a pile with soil in front and a gap behind.  A circle is a polygon; its corners lie so that
area or second moment of area are those of the circle.  Across a plane a load is even or odd: an
even one leaves the plane where it is, an odd one moves it along its normal only.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np

from handoff.fe_mesh import FacetTag, FEMesh
from workflows.verification.solid_boundary import fe_mesh
from workflows.verification.solid_meshes import Solid, extruded, quadratic_mesh, sector

QUARTERS, HALVES = 4.0, 2.0
"""Whole over modelled part."""

QUARTER_TURN, HALF_TURN = 0.5 * np.pi, np.pi
"""Angles in rad that the parts span."""

Parity = Literal["even", "odd"]


def equal_area(sides: int) -> float:
    """Return the radius of the corners of a polygon over that of the circle of the same area."""
    angle = 2.0 * np.pi / sides
    return float(np.sqrt(angle / np.sin(angle)))


def equal_inertia(sides: int) -> float:
    """Return the same for the second moment of area, n R^4 sin(a) (2 + cos(a)) / 24."""
    angle = 2.0 * np.pi / sides
    return float((3.0 * angle / (np.sin(angle) * (2.0 + np.cos(angle)))) ** 0.25)


def round_solid(
    radii: np.ndarray, depths: np.ndarray, sectors: int, angle: float = QUARTER_TURN
) -> Solid:
    """Return the tetrahedra between ``radii`` (from zero) and ``depths`` (from zero), in m.

    ``sectors`` divide the ``angle`` from the x axis.
    """
    angles = np.linspace(0.0, angle, sectors + 1)
    return extruded(sector(radii, angles), -depths[::-1])


def round_mesh(
    solid: Solid,
    is_ground: np.ndarray | None = None,
    pile_part: Callable[[np.ndarray], np.ndarray] = lambda centres: np.full(len(centres), -1),
) -> FEMesh:
    """Return the mesh of the cells ``is_ground`` (n_tetrahedra,), all by default.

    ``pile_part`` tells the part of the pile, or -1, of facets by their centres (n, 3).
    """
    low_x, low_y, bottom = solid.vertices.min(axis=0)
    slack = 1e-9 * np.ptp(solid.vertices)
    planes = [axis for axis, low in enumerate((low_x, low_y)) if low > -slack]

    def tags(centres: np.ndarray) -> np.ndarray:
        found = np.full(len(centres), int(FacetTag.SIDE))
        found[(centres[:, planes] < slack).any(axis=1)] = FacetTag.SYMMETRY
        found[centres[:, 2] > -slack] = FacetTag.SURFACE
        found[centres[:, 2] < bottom + slack] = FacetTag.BOTTOM
        part = pile_part(centres)
        return np.where(part >= 0, part, found)

    return fe_mesh(quadratic_mesh(solid, is_ground), tags)


def supports(mesh: FEMesh, in_x: Parity | None, in_y: Parity) -> np.ndarray:
    """Return the supports (node, 3) bool: symmetry in x and y, outer side and bottom held.

    None stands for the x of a half, whose plane x = 0 is inside.
    """
    slack = 1e-9 * np.ptp(mesh.nodes)
    is_fixed = np.zeros(mesh.nodes.shape, dtype=bool)
    for axis, parity in enumerate((in_x, in_y)):
        if parity is None:
            continue
        on_plane = np.abs(mesh.nodes[:, axis]) < slack
        others = [other for other in range(3) if other != axis]
        is_fixed[np.ix_(on_plane, [axis] if parity == "even" else others)] = True
    outer = np.isin(mesh.facet_tag, [FacetTag.SIDE, FacetTag.BOTTOM])
    is_fixed[np.unique(mesh.facet_nodes[outer])] = True
    return is_fixed


def surface_within(mesh: FEMesh, radius: float) -> np.ndarray:
    """Return the facets (n,) of the surface inside the polygon whose corners are at ``radius`` m.

    By their vertices: mid-sides of the next polygon may be nearer to the axis than these corners.
    """
    slack = 1e-9 * np.ptp(mesh.nodes)
    vertices = mesh.nodes[mesh.facet_nodes[:, :3]]
    is_inside = np.hypot(vertices[:, :, 0], vertices[:, :, 1]) < radius + slack
    return np.flatnonzero((is_inside & (vertices[:, :, 2] > -slack)).all(axis=1))
