"""The finite-element mesh of the installed pile: straight-edged quadratic simplices.

The ground is meshed with a level surface, conforming to the pile at its installed depth; the
surface is then warped to the profile that the installation left.  Two models with the same depth
and a level surface get the identical mesh.  The triangles around a flat-ended pile are made here,
the tetrahedra around a screw pile in ``screw_mesh``.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import IntEnum
from typing import Annotated, NamedTuple

import numpy as np

from handoff.gmsh_triangles import MeshError, fill_polygons
from handoff.options import HandoffOptions
from handoff.surface import SurfaceProfile, height_at
from install_mpm.options import Box
from install_mpm.pile import Pile
from install_mpm.record import Field
from install_mpm.soil_bands import soil_bands

SHAFT_SIZE = 2.0
"""Edge length along base and shaft, away from the corner, over the one at the corner."""
GROWTH = 0.15
"""Growth of the edge length per distance from the pile."""
SMALLEST_QUALITY = 0.1
"""Cells worse than this make a poor stiffness matrix: the surface is too steep to be followed."""


class FacetTag(IntEnum):
    """Parts of the boundary of the soil.  Those of the pile are not negative.

    They are ``PilePart`` for a flat-ended pile and numbers of ``screw_pile.part_names`` for a screw
    pile.
    """

    PILE_BASE = 0
    PILE_SHAFT = 1
    PILE_HEAD = 1000
    """Section of a deformable pile that a rigid cap holds; no surface of the soil."""
    SYMMETRY = -1
    SIDE = -2
    BOTTOM = -3
    SURFACE = -4


class FEMesh(NamedTuple):
    """Six-node triangles (x >= 0) or ten-node tetrahedra with straight edges, and their boundary.

    z is up.
    """

    nodes: Annotated[
        np.ndarray, Field(("node", "dim"), "m", "node coordinates (x, z) or (x, y, z)")
    ]
    cell_nodes: Annotated[
        np.ndarray,
        Field(
            ("cell", "cell_node"),
            "",
            "vertices, then mid-sides of edges 01, 12, 20, in space also 03, 23, 13",
            "int64",
        ),
    ]
    facet_nodes: Annotated[
        np.ndarray,
        Field(
            ("facet", "facet_node"),
            "",
            "boundary facets: vertices, soil on the left hand of an edge, then mid-sides",
            "int64",
        ),
    ]
    facet_tag: Annotated[
        np.ndarray, Field(("facet",), "", "FacetTag of each boundary facet", "int64")
    ]


def pile_facets(mesh: FEMesh) -> np.ndarray:
    """Return the numbers (n,) of the facets on the pile."""
    return np.flatnonzero(mesh.facet_tag >= 0)


def make_mesh(
    pile: Pile,
    tip_depth: float,
    box: Box,
    options: HandoffOptions,
    surface: SurfaceProfile,
    boundaries: Sequence[float] = (),
) -> FEMesh:
    """Return the mesh of the soil around the pile whose tip is ``tip_depth`` m deep.

    It conforms to the ``boundaries`` between undisturbed layers, depths in m.  Edges are
    ``size_at_pile`` long at the corner of the pile, twice that along base and shaft and grow to
    ``size_far``.

    Raises
    ------
    MeshError
        If the pile does not fit into the box or is narrower than a cell, or if the surface is too
        steep for the mesh to follow.
    """
    _check_geometry(pile, tip_depth, box, options)
    vertices, triangles = fill_polygons(
        _outlines(pile, tip_depth, box, boundaries),
        lambda x, z: _edge_length(x, z, pile, tip_depth, options),
    )
    cell_nodes, facet_nodes = _quadratic_cells(len(vertices), triangles)
    tags = _facet_tags(vertices[facet_nodes[:, :2]].mean(axis=1), pile, tip_depth, box)
    warped = _warped(vertices, tip_depth, surface)
    mesh = FEMesh(_with_mid_sides(warped, cell_nodes), cell_nodes, facet_nodes, tags)
    check_quality(mesh, mesh_quality(mesh))
    return mesh


def cell_areas(mesh: FEMesh) -> np.ndarray:
    """Return the signed area (cell,) in m^2 of triangles; negative for an inverted cell."""
    first, second, third = np.moveaxis(mesh.nodes[mesh.cell_nodes[:, :3]], 1, 0)
    a, b = second - first, third - first
    areas: np.ndarray = 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    return areas


def mesh_quality(mesh: FEMesh) -> np.ndarray:
    """Return 2 r_in / r_out (cell,) of triangles: 1 equilateral, 0 flat, negative if inverted."""
    corners = mesh.nodes[mesh.cell_nodes[:, :3]]
    edges = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
    quality: np.ndarray = (
        16.0 * cell_areas(mesh) ** 2 / (edges.sum(axis=1) * edges.prod(axis=1))
    ) * np.sign(cell_areas(mesh))
    return quality


def _check_geometry(pile: Pile, tip_depth: float, box: Box, options: HandoffOptions) -> None:
    if not 0.0 < tip_depth < box.depth or pile.half_width >= box.width:
        raise MeshError(
            f"the pile (half-width {pile.half_width:g} m, tip {tip_depth:g} m deep) does not fit"
            f" into the box of {box.width:g} m x {box.depth:g} m; make the box larger"
        )
    if options.size_at_pile > pile.half_width:
        raise MeshError(
            f"handoff.size_at_pile is {options.size_at_pile:g} m, larger than the half-width of"
            f" the pile, {pile.half_width:g} m; make it smaller"
        )
    if options.size_far < options.size_at_pile:
        raise MeshError("handoff.size_far is smaller than handoff.size_at_pile; make it larger")


def _outlines(
    pile: Pile, tip_depth: float, box: Box, boundaries: Sequence[float]
) -> list[np.ndarray]:
    """Return the corners of the soil, anticlockwise; the band with the tip begins at its axis."""
    tip = np.array([0.0, -tip_depth])
    bands = soil_bands(pile, tip_depth, box, boundaries)
    starts = [int(np.argmax((band == tip).all(axis=1))) for band in bands]
    return [np.roll(band, -start, axis=0) for band, start in zip(bands, starts, strict=True)]


def _edge_length(
    x: float, z: float, pile: Pile, tip_depth: float, options: HandoffOptions
) -> float:
    """Return the wanted edge length in m at a place in the soil."""
    beside, below = max(x - pile.half_width, 0.0), max(-tip_depth - z, 0.0)
    to_corner = float(np.hypot(x - pile.half_width, z + tip_depth))
    to_pile = float(np.hypot(beside, below))
    return min(
        options.size_far,
        options.size_at_pile + GROWTH * to_corner,
        SHAFT_SIZE * options.size_at_pile + GROWTH * to_pile,
    )


def _quadratic_cells(n_vertices: int, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return 6-node cells, mid-sides numbered after the vertices, and the boundary edges."""
    ends = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    _, edge, uses = np.unique(
        np.sort(ends, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    edge = edge.reshape(-1)
    mid_sides = n_vertices + edge
    on_boundary = uses[edge] == 1
    cell_nodes = np.column_stack([triangles, mid_sides.reshape(-1, 3)])
    facet_nodes = np.column_stack([ends, mid_sides])[on_boundary]
    return cell_nodes.astype(np.int64), facet_nodes.astype(np.int64)


def _facet_tags(centres: np.ndarray, pile: Pile, tip_depth: float, box: Box) -> np.ndarray:
    """Return the ``FacetTag`` (facet,) of boundary edges of the level mesh with ``centres``."""
    x, z = centres.T
    slack = 1e-9 * max(box.width, box.depth)
    tags = np.full(len(centres), int(FacetTag.PILE_SHAFT))
    tags[np.abs(z) < slack] = FacetTag.SURFACE
    tags[np.abs(z + box.depth) < slack] = FacetTag.BOTTOM
    tags[np.abs(x - box.width) < slack] = FacetTag.SIDE
    tags[np.abs(x) < slack] = FacetTag.SYMMETRY
    tags[(np.abs(z + tip_depth) < slack) & (x < pile.half_width)] = FacetTag.PILE_BASE
    return tags.astype(np.int64)


def _warped(vertices: np.ndarray, tip_depth: float, surface: SurfaceProfile) -> np.ndarray:
    """Return the vertices moved vertically with the surface; this fades linearly to the tip."""
    x, z = vertices.T
    return np.column_stack([x, z + surface_motion(surface, x, z, tip_depth)])


def surface_motion(
    surface: SurfaceProfile, x: np.ndarray, z: np.ndarray, still_depth: float
) -> np.ndarray:
    """Return the rise (n,) in m of the mesh with the surface, zero from ``still_depth`` m down.

    ``x`` (n,) in m is the distance from the axis, ``z`` (n,) the level.
    """
    fading = np.clip(1.0 + z / still_depth, 0.0, 1.0)
    return fading * height_at(surface, x)


def _with_mid_sides(vertices: np.ndarray, cell_nodes: np.ndarray) -> np.ndarray:
    """Return the vertices followed by the mid-sides, halfway between their vertices."""
    nodes = np.empty((cell_nodes.max() + 1, 2))
    nodes[: len(vertices)] = vertices
    for corner in range(3):
        ends = cell_nodes[:, corner], cell_nodes[:, (corner + 1) % 3]
        nodes[cell_nodes[:, 3 + corner]] = 0.5 * (vertices[ends[0]] + vertices[ends[1]])
    return nodes


def check_quality(mesh: FEMesh, quality: np.ndarray) -> None:
    """Check that no cell has a ``quality`` (cell,) below ``SMALLEST_QUALITY``.

    Raises
    ------
    MeshError
        Naming the place of the worst cell.
    """
    worst = int(np.argmin(quality))
    if quality[worst] < SMALLEST_QUALITY:
        n_vertices = mesh.nodes.shape[1] + 1
        place = mesh.nodes[mesh.cell_nodes[worst, :n_vertices]].mean(axis=0)
        raise MeshError(
            f"the finite-element cell at ({', '.join(f'{x:.2f} m' for x in place)}) has quality"
            f" {quality[worst]:.2g} (1 is regular, at least {SMALLEST_QUALITY} is needed): the"
            " ground surface left by the installation is too steep there; use a smaller"
            " handoff.size_at_pile"
        )
