"""Each facet on a screw pile stands for a patch of the exact surface: how much of it.

Facets are inscribed in the surface, so adhesion along them would fall short of that along cylinder,
cone and plate by several per cent on a coarse mesh: by 6 % on a flat tip of twelve sides.  A facet
therefore has the shear strength of the patch between its vertices.  What is compared is the moment
about the pile axis of a unit shear traction along the surface, around the axis.

On a cylinder of radius a the patch is the triangle of the unrolled surface, and its moment a times
its area.  On a tip, a cone or a face of a plate the moment is that of the patch seen along the
axis,

    M = int r dA = int rho^3 / 3 d(theta)  round its edge,

rho(theta) being the edge: straight, or an arc where both ends lie on a circle that bounds the part.
On a helicoid that is so whatever the pitch (PC1); on a cone M is divided by the sine of the angle
between surface and axis.  Edges inside a part count once forward and once backward, so the sum over
a part is exact.  Leading and trailing edges, which have no closed form, keep the strength of their
facets.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from install_mpm.interface import Facets
from install_mpm.screw_pile import (
    CONE,
    FLAT_TIP,
    LOWER_FACE,
    RIM,
    SHAFT,
    UPPER_FACE,
    ScrewPile,
    first_part,
)
from install_mpm.screw_shape import surface_normals

ON_CIRCLE = 1e-3
"""Distance over its radius within which a vertex lies on a circle."""

GAUSS_POINTS = 8
"""Along a straight edge: its moment is then exact to round-off, but for edges beside the axis."""

Moment = Callable[[np.ndarray], np.ndarray]


def strength_shares(
    pile: ScrewPile, facets: Facets, part: np.ndarray, nodes: np.ndarray
) -> np.ndarray:
    """Return the shear strength of patches over that of their facets, at all points (n_points,).

    ``part`` (n_elements,) is that of each facet, ``nodes`` (n_nodes, 3) are at zero pile motion.
    """
    vertices, share = nodes[facets.nodes[:, :3]], np.ones(len(part))
    facet = _facet_moments(pile, facets, part, nodes)
    for numbers, moment in _moments_of_parts(pile):
        here = np.isin(part, numbers)
        share[here] = moment(vertices[here]) / facet[here]
    return np.repeat(share, len(facets.weights))


def _facet_moments(
    pile: ScrewPile, facets: Facets, part: np.ndarray, nodes: np.ndarray
) -> np.ndarray:
    """Return the moment (n_elements,) in m^3 of a unit traction around the axis along facets."""
    corners, n_points = nodes[facets.nodes], len(facets.weights)
    position = np.einsum("qa,eai->eqi", facets.shape_values, corners).reshape(-1, 3)
    normal = surface_normals(pile, np.repeat(part, n_points), position)
    radius = np.linalg.norm(position[:, :2], axis=1)
    climb = (normal[:, 1] * position[:, 0] - normal[:, 0] * position[:, 1]) / radius
    lever = (radius * np.sqrt(1.0 - climb**2)).reshape(-1, n_points)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    moment: np.ndarray = np.linalg.norm(across, axis=1) / 2.0 * (lever @ facets.weights)
    return moment


def _moments_of_parts(pile: ScrewPile) -> list[tuple[list[int], Moment]]:
    """Return groups of parts and the function that gives the moment of patches on them."""
    a = pile.shaft_radius
    slant = float(np.hypot(pile.tip_length, a))
    groups: list[tuple[list[int], Moment]] = [
        ([FLAT_TIP], partial(_moment_from_above, circles=(a,))),
        ([CONE], lambda vertices: _moment_from_above(vertices, (a,)) * slant / a),
        ([SHAFT], partial(_moment_on_cylinder, radius=a)),
    ]
    for index, helix in enumerate(pile.helices):
        first = first_part(index)
        faces = [first + LOWER_FACE, first + UPPER_FACE]
        groups += [
            (faces, partial(_moment_from_above, circles=(a, helix.radius))),
            ([first + RIM], partial(_moment_on_cylinder, radius=helix.radius)),
        ]
    return groups


def _moment_on_cylinder(vertices: np.ndarray, radius: float) -> np.ndarray:
    """Return the moment (n,) in m^3 of patches with ``vertices`` (n, 3, 3) on a cylinder."""
    angle = np.arctan2(vertices[:, :, 1], vertices[:, :, 0])
    angle = angle[:, :1] + np.mod(angle - angle[:, :1] + np.pi, 2.0 * np.pi) - np.pi
    edges = np.stack([radius * angle, vertices[:, :, 2]], axis=2)
    edges = edges[:, 1:] - edges[:, :1]
    moment: np.ndarray = radius * np.abs(np.linalg.det(edges)) / 2.0
    return moment


def _moment_from_above(vertices: np.ndarray, circles: tuple[float, ...]) -> np.ndarray:
    """Return the moment (n,) in m^3 of patches with ``vertices`` (n, 3, 3), seen along the axis.

    ``circles`` are the radii in m of what bounds the part.
    """
    total = np.zeros(len(vertices))
    for start in range(3):
        p, q = vertices[:, start, :2], vertices[:, (start + 1) % 3, :2]
        total += _moment_to_edge(p, q, circles)
    return np.abs(total)


def _moment_to_edge(p: np.ndarray, q: np.ndarray, circles: tuple[float, ...]) -> np.ndarray:
    """Return the integral (n,) of rho^3 / 3 d(theta) along the edges from ``p`` to ``q`` (n, 2)."""
    along, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    places = p[:, None] + (q - p)[:, None] * ((along + 1.0) / 2.0)[:, None]
    cross = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]  # rho^2 d(theta), the same all along
    moment: np.ndarray = cross / 3.0 * (np.linalg.norm(places, axis=2) @ weights / 2.0)
    turn = np.arctan2(cross, (p * q).sum(axis=1))
    ends = np.linalg.norm(np.stack([p, q]), axis=2)
    for radius in circles:
        is_arc = (np.abs(ends - radius) < ON_CIRCLE * radius).all(axis=0)
        moment = np.where(is_arc, radius**3 / 3.0 * turn, moment)
    return moment
