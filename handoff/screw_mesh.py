"""The finite-element mesh around an installed screw pile: straight-edged 10-node tetrahedra.

The ground is meshed in the frame of the pile, with the outer wall turned back, and then turned
with the pile: two models with the same depth and angle and a level surface get the same mesh.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from handoff.fe_mesh import SHAFT_SIZE, FacetTag, FEMesh, check_quality, surface_motion
from handoff.gmsh_triangles import MeshError
from handoff.options import HandoffOptions
from handoff.surface import SurfaceProfile
from install_mpm.background_mesh import (
    BackgroundMesh,
    cell_quality,
    facet_edge_nodes,
    facets_opposite_vertices,
    straightened,
)
from install_mpm.conventions import rotation_matrix
from install_mpm.options import Box, ScrewMeshOptions
from install_mpm.screw_pile import ScrewPile, edge_thickness
from install_mpm.screw_pile_mesh import mesh_around_pile
from install_mpm.screw_surface import boundary_parts

LARGEST_ON_PLATE = 2.5
"""Largest cell size at the plates over their thickness; coarser meshes fail or have flat cells."""

LARGEST_ON_NOSE = 2.0
"""The same of rounded edges, over the thickness there."""


def make_screw_mesh(
    pile: ScrewPile,
    rotation: float,
    box: Box,
    options: HandoffOptions,
    surface: SurfaceProfile,
    boundaries: Sequence[float] = (),
) -> FEMesh:
    """Return the mesh of the soil around a pile at its depth ``pile.embedment``.

    The pile has turned by ``rotation`` in rad.  The mesh conforms to the ``boundaries`` between
    undisturbed layers, depths in m.  Edges are ``size_at_pile`` long at the plates, twice that
    along the shaft and grow to ``size_far``.

    Raises
    ------
    MeshError
        If the pile does not fit into the box, the cells cannot hold its plates, or the surface is
        too steep for the mesh to follow.
    """
    _check_geometry(pile, box, options)
    size = options.size_at_pile
    sizes = ScrewMeshOptions(size, size, SHAFT_SIZE * size, options.size_far, edge_reach=0.0)
    inside = [depth for depth in boundaries if depth < box.depth]
    levels = [-box.depth, *(-depth for depth in sorted(inside, reverse=True)), 0.0]
    try:
        level_mesh = mesh_around_pile(pile, box, sizes, levels, -rotation)
    except Exception as error:  # gmsh raises bare exceptions
        raise MeshError(
            f"gmsh could not mesh the ground around the screw pile ({error}); use a smaller"
            " handoff.size_at_pile"
        ) from error
    facet_nodes, facet_tag = _facets(level_mesh, pile, box)
    moved = _turned(_warped(level_mesh, pile, surface), rotation)
    mesh = FEMesh(moved.nodes, moved.cell_nodes, facet_nodes, facet_tag)
    check_quality(mesh, cell_quality(moved))
    return mesh


def largest_size(pile: ScrewPile) -> float:
    """Return the largest ``size_at_pile`` in m that shaft and plates can be meshed with."""
    limits = [
        LARGEST_ON_NOSE * edge_thickness(helix)
        if helix.edges == "rounded"
        else LARGEST_ON_PLATE * helix.thickness
        for helix in pile.helices
    ]
    return float(min([pile.shaft_radius, *limits]))


def _check_geometry(pile: ScrewPile, box: Box, options: HandoffOptions) -> None:
    if not 0.0 < pile.embedment < box.depth:
        raise MeshError(
            f"the tip of the pile, {pile.embedment:g} m deep, is not in the box of {box.depth:g} m;"
            " make the box deeper"
        )
    if options.size_far < options.size_at_pile:
        raise MeshError("handoff.size_far is smaller than handoff.size_at_pile; make it larger")
    limit = largest_size(pile)
    if options.size_at_pile > limit:
        raise MeshError(
            f"handoff.size_at_pile {options.size_at_pile:g} m cannot hold the shaft and the plates"
            f" of the pile; take at most {limit:g} m"
        )


def _facets(mesh: BackgroundMesh, pile: ScrewPile, box: Box) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes (n, 6) and ``FacetTag`` (n,) of the boundary of the level mesh."""
    cell, facet, part = boundary_parts(mesh, pile)
    vertices = facets_opposite_vertices(mesh.cell_nodes[:, :4])[cell, facet]
    nodes = np.hstack([vertices, facet_edge_nodes(mesh, cell, facet)])
    z, slack = mesh.nodes[vertices][:, :, 2], 1e-9 * box.depth
    tag = np.where(part < 0, int(FacetTag.SIDE), part)
    tag[(np.abs(z) < slack).all(axis=1)] = FacetTag.SURFACE
    tag[(np.abs(z + box.depth) < slack).all(axis=1)] = FacetTag.BOTTOM
    return nodes, tag


def _warped(mesh: BackgroundMesh, pile: ScrewPile, surface: SurfaceProfile) -> BackgroundMesh:
    """Return the mesh moved vertically with the surface; this fades to the uppermost plate."""
    tops = [helix.height + helix.pitch * helix.turns + helix.thickness for helix in pile.helices]
    still_depth = pile.embedment - max([pile.tip_length, *tops])
    nodes = mesh.nodes.copy()
    radius = np.linalg.norm(nodes[:, :2], axis=1)
    nodes[:, 2] += surface_motion(surface, radius, nodes[:, 2], still_depth)
    return straightened(mesh._replace(nodes=nodes))


def _turned(mesh: BackgroundMesh, rotation: float) -> BackgroundMesh:
    """Return the mesh turned about the axis by ``rotation`` in rad."""
    return mesh._replace(nodes=mesh.nodes @ rotation_matrix(rotation, 3).T)
