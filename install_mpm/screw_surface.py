"""Interface elements on a screw pile: facets by part, and points with exact normals."""

from __future__ import annotations

import numpy as np

from install_mpm.background_mesh import (
    BackgroundMesh,
    facet_edge_nodes,
    facets_opposite_vertices,
)
from install_mpm.constitutive import coulomb_interface
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.conventions import rotation_matrix
from install_mpm.ground import GroundProfile, geostatic_stress, undrained_shear_strength
from install_mpm.interface import (
    Facets,
    InterfaceElements,
    InterfacePoints,
    facet_rule,
    local_axes,
    with_strength_share,
)
from install_mpm.screw_pile import (
    LOWER_FACE,
    PARTS_OF_PILE,
    UPPER_FACE,
    ScrewPile,
    edge_parts,
    first_part,
)
from install_mpm.screw_shape import distance_to_parts, surface_normals

ON_SURFACE = 1e-4
"""Distance, over the shaft diameter, within which a mesh node counts as lying on the pile.

A lofted plate is a spline through exact sections: between them it is off by some 1e-5.
"""


def pile_elements(
    mesh: BackgroundMesh, pile: ScrewPile
) -> tuple[InterfaceElements, np.ndarray, np.ndarray]:
    """Return the interface elements on the pile, their part (n,), and exact normals at the start.

    The normals (n_points, 3) belong to the points of the elements, at zero pile motion.
    """
    cell, facet, part = boundary_parts(mesh, pile)
    is_on_pile = part >= 0
    cell, facet, part = cell[is_on_pile], facet[is_on_pile], part[is_on_pile]
    vertices = facets_opposite_vertices(mesh.cell_nodes[:, :4])[cell, facet]
    nodes = np.hstack([vertices, facet_edge_nodes(mesh, cell, facet)])
    elements = InterfaceElements(nodes, cell, *facet_rule(6, 3))
    normals, has_corner = facet_normals(pile, elements, part, mesh.reference_nodes)
    is_swept = ~has_corner & ~np.isin(part, edge_parts(pile))
    return elements._replace(is_swept=np.repeat(is_swept, 3)), part, normals


def boundary_parts(
    mesh: BackgroundMesh, pile: ScrewPile
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return cell, facet in it and part of the pile, each (n,), of the boundary facets of a mesh.

    The part is -1 off the pile; the pile is at its starting depth and angle.
    """
    cell, facet = np.argwhere(mesh.cell_neighbours < 0).T
    vertices = facets_opposite_vertices(mesh.cell_nodes[:, :4])[cell, facet]
    places = mesh.reference_nodes[vertices]
    distance = distance_to_parts(pile, places.reshape(-1, 3)).reshape(*vertices.shape, -1)
    farthest = distance.max(axis=1)
    is_on_pile = farthest.min(axis=1) < ON_SURFACE * pile.shaft_diameter
    part = np.where(is_on_pile, farthest.argmin(axis=1), -1)
    corner, second, third = places.transpose(1, 0, 2)
    outward = np.cross(second - corner, third - corner)
    return cell, facet, _of_own_face(pile, part, places.mean(axis=1), outward)


def _of_own_face(
    pile: ScrewPile, part: np.ndarray, place: np.ndarray, outward: np.ndarray
) -> np.ndarray:
    """Return ``part`` (n,) with the faces of plates held as surfaces told apart.

    Both lie at the same place; ``outward`` (n, 3) is the way from the soil to the pile.
    """
    part = part.copy()
    for number, helix in enumerate(pile.helices):
        lower = first_part(number) + LOWER_FACE
        here = np.flatnonzero((part == lower) & helix.is_surface)
        upward = surface_normals(pile, part[here], place[here])
        is_below = (upward * outward[here]).sum(axis=1) > 0.0
        part[here] = np.where(is_below, lower, first_part(number) + UPPER_FACE)
    return part


def facet_normals(
    pile: ScrewPile, facets: Facets, part: np.ndarray, nodes: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the normals (n_points, 3) at points on facets, and which facets (n,) have a corner.

    Normals are exact, but one at each corner.  ``part`` (n,) is that of each facet, ``nodes``
    (n_nodes, 3) in m are in the pile frame.

    A vertex that edge and face, or edge and rim, of a plate share has their mean normal.  With the
    normals of both it could not move at all against the pile, and would drag the soil ahead of it
    along.  In the facets beside such a corner the normal changes linearly.
    """
    shape_values, vertices = facets.shape_values, facets.nodes[:, :3]
    own = surface_normals(pile, np.repeat(part, 3), nodes[vertices].reshape(-1, 3))
    at_corner, is_corner = _corner_normals(pile, vertices, part, own.reshape(-1, 3, 3), len(nodes))
    position = np.einsum("qa,eai->eqi", shape_values, nodes[facets.nodes])
    exact = surface_normals(pile, np.repeat(part, len(shape_values)), position.reshape(-1, 3))
    share = _vertex_shares(shape_values)
    is_plate = part >= len(PARTS_OF_PILE)
    shared = is_corner[vertices] & is_plate[:, None]  # (n_elements, 3 vertices)
    weight = np.einsum("qv,ev->eq", share, shared)
    blended = np.einsum("qv,ev,evi->eqi", share, shared, at_corner[vertices])
    blended += (1.0 - weight)[:, :, None] * exact.reshape(position.shape)
    normals = (blended / np.linalg.norm(blended, axis=2)[:, :, None]).reshape(-1, 3)
    return normals, shared.any(axis=1)


def _corner_normals(
    pile: ScrewPile, vertices: np.ndarray, part: np.ndarray, normals: np.ndarray, n_nodes: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean normal (n_nodes, 3) at the corners of plate edges, and which nodes are such.

    ``normals`` (n_elements, 3, 3) are those of the parts at the vertices.  Every part counts once.
    """
    total, n_parts = np.zeros((n_nodes, 3)), np.zeros(n_nodes, dtype=np.int64)
    is_at_edge = np.zeros(n_nodes, dtype=bool)
    is_at_edge[vertices[np.isin(part, edge_parts(pile))]] = True
    for number in np.unique(part[part >= len(PARTS_OF_PILE)]):
        own = part == number
        of_part = np.zeros((n_nodes, 3))
        of_part[vertices[own].ravel()] = normals[own].reshape(-1, 3)
        total += of_part
        n_parts += of_part.any(axis=1)
    is_corner = is_at_edge & (n_parts > 1)
    length = np.linalg.norm(total, axis=1)
    return total / np.where(length > 0.0, length, 1.0)[:, None], is_corner


def _vertex_shares(shape_values: np.ndarray) -> np.ndarray:
    """Return the linear functions (n_facet_points, 3) of the vertices at points on a facet."""
    mid_sides = shape_values[:, 3:]
    # a quadratic shape function l (2 l - 1) plus half of its two neighbours 4 l m and 4 l n is l
    shares: np.ndarray = shape_values[:, :3] + (mid_sides + np.roll(mid_sides, 1, axis=1)) / 2.0
    return shares


def place_points(
    elements: InterfaceElements, mesh: BackgroundMesh
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return position (n, 3) in m, area (n,) in m^2 and facet normal (n, 3) of interface points."""
    corners = mesh.nodes[elements.nodes]
    position = np.einsum("qa,eai->eqi", elements.shape_values, corners).reshape(-1, 3)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    twice_area = np.linalg.norm(normal, axis=1)
    area = np.outer(twice_area / 2.0, elements.weights).ravel()
    return position, area, np.repeat(normal / twice_area[:, None], 3, axis=0)


def initial_interface(
    elements: InterfaceElements,
    part: np.ndarray,
    normals: np.ndarray,
    mesh: BackgroundMesh,
    ground: GroundProfile,
    law: CoulombInterface,
    share: np.ndarray,
) -> InterfacePoints:
    """Return the interface of a pile wished in place: the geostatic traction acts on its facets.

    ``share`` (n_points,) is that of ``exact_patches.strength_shares``.
    """
    position, area, facet_normal = place_points(elements, mesh)
    points = InterfacePoints(
        position=position,
        normal=normals,
        area=area,
        traction=np.zeros_like(position),
        parameters=_parameters(law, ground, position[:, 2], share),
        part=np.repeat(part, len(elements.weights)),
        covered=(position[:, 2] < 0.0).astype(np.float64),
    )
    stress = geostatic_stress(ground, position[:, 2], 2)
    traction = np.einsum("pij,pjk,pk->pi", local_axes(points), stress, facet_normal)
    return points._replace(traction=traction)


def follow(
    points: InterfacePoints,
    elements: InterfaceElements,
    normals: np.ndarray,
    angle: float,
    mesh: BackgroundMesh,
    ground: GroundProfile,
    law: CoulombInterface,
    share: np.ndarray,
) -> InterfacePoints:
    """Return the interface at its place on the moved mesh.

    ``normals`` (n, 3) are those at zero pile motion, ``angle`` is the rotation of the pile in rad;
    the adhesion is that of the level, times the ``share`` (n,) of ``strength_shares``.
    """
    position, area, _ = place_points(elements, mesh)
    return points._replace(
        position=position,
        normal=normals @ rotation_matrix(angle, 3).T,
        area=area,
        parameters=_parameters(law, ground, position[:, 2], share),
    )


def _parameters(
    law: CoulombInterface, ground: GroundProfile, height: np.ndarray, share: np.ndarray
) -> np.ndarray:
    """Return the packed parameters (n, 7) at ``height`` (n,) in m; ``share`` (n,) of strength."""
    strength = undrained_shear_strength(ground, height)
    return with_strength_share(coulomb_interface.pack(law, strength), share)
