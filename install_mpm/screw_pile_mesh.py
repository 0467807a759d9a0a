"""Background mesh around a screw pile: quadratic tetrahedra that conform to its surface, by gmsh.

The outer wall is a regular prism, so that the mesh fills the same space after it was turned back by
a whole number of its sides.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import gmsh
import numpy as np

from install_mpm.background_mesh import (
    BackgroundMesh,
    cut_along,
    facets_opposite_vertices,
    make_background_mesh,
)
from install_mpm.options import Box, ScrewMeshOptions
from install_mpm.screw_pile import Helix, ScrewPile, edge_thickness, thickness_at

WALL_SIDES = 24
"""Sides of the outer wall: the mesh fits into it again after a turn of 15 degrees."""

SECTIONS_PER_TURN = 16
"""Radial sections that a plate is lofted through in a turn."""

LEAST_SECTIONS = 7
"""Sections of a piece of a plate, however short: fewer are too far off the circle of the rim."""

NOSE_SECTIONS = 8
"""Sections across a rounded edge that its nose is lofted through, from the inside to the rim."""

INSIDE_SHARE = 0.6
"""Of the shaft radius: where the sections of a plate begin, inside the shaft."""

GROWTH_ABOVE_GROUND = 1.0
"""Increase of the cell size per height above the ground, where cells only wait for soil."""

OPTIMISERS = ("", "Netgen")
"""Of gmsh, in order; the second removes the flat cells that the first leaves at the plates."""

OPTIMISED_BELOW = 0.6
"""Quality of gmsh below which a cell is optimised beside a plate that is held as a surface, where
Netgen cannot help: it does not take surfaces inside a volume."""

GMSH_TRIANGLE_6, GMSH_TETRAHEDRON_10 = 9, 11


def generate_screw_mesh(pile: ScrewPile, box: Box, options: ScrewMeshOptions) -> BackgroundMesh:
    """Return a mesh of 10-node tetrahedra conforming to the pile and to the level ground surface.

    It covers the ground within ``box.width`` of the axis (to the corners of the wall) and the
    headroom above it.
    """
    return mesh_around_pile(pile, box, options, (-box.depth, 0.0, box.headroom))


def mesh_around_pile(
    pile: ScrewPile,
    box: Box,
    options: ScrewMeshOptions,
    levels: Sequence[float],
    wall_angle: float = 0.0,
) -> BackgroundMesh:
    """Return a mesh of 10-node tetrahedra conforming to the pile and to all ``levels``.

    Along plates that are held as surfaces it is cut open.

    The levels in m, from the bottom to the top, are horizontal planes; the first and the last bound
    the mesh.  The corners of the outer wall are turned by ``wall_angle`` in rad.
    """
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)  # more threads: another mesh in every run
        gmsh.option.setNumber("Mesh.RandomSeed", options.random_seed + 1)
        gmsh.model.add("background")
        sheets = _draw(pile, box.width, levels, wall_angle)
        _set_sizes(pile, box, options)
        gmsh.model.mesh.generate(3)
        if sheets:
            gmsh.option.setNumber("Mesh.OptimizeThreshold", OPTIMISED_BELOW)
        for optimiser in OPTIMISERS[:1] if sheets else OPTIMISERS:
            gmsh.model.mesh.optimize(optimiser)
        gmsh.model.mesh.setOrder(2)
        return _collect(sheets)
    finally:
        gmsh.finalize()


def _draw(pile: ScrewPile, width: float, levels: Sequence[float], wall_angle: float) -> list[int]:
    """Draw the volumes between the levels, which share their horizontal faces, less the pile.

    Return the surfaces in them that are plates.
    """
    occ = gmsh.model.occ
    prisms = [(3, _prism(width, *ends, wall_angle)) for ends in pairwise(levels)]
    body = _draw_pile(pile, top=levels[-1] + pile.shaft_radius)
    sheets = [_draw_sheet(pile, helix) for helix in pile.helices if helix.is_surface]
    if sheets:
        sheets, _ = occ.cut(sheets, body, removeTool=False)
    remaining, _ = occ.cut(prisms, body)
    pieces: list[list[tuple[int, int]]] = []
    if len(remaining) + len(sheets) > 1:
        _, pieces = occ.fragment(remaining[:1], remaining[1:] + sheets)
    occ.synchronize()
    return [tag for piece in pieces[len(remaining) :] for _, tag in piece]


def _prism(radius: float, bottom: float, top: float, wall_angle: float) -> int:
    """Return the volume of a regular prism around the axis."""
    occ = gmsh.model.occ
    angle = wall_angle + 2.0 * np.pi * np.arange(WALL_SIDES) / WALL_SIDES
    points = [occ.addPoint(radius * np.cos(a), radius * np.sin(a), bottom) for a in angle]
    lines = [occ.addLine(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]
    surface = occ.addPlaneSurface([occ.addCurveLoop(lines)])
    volumes = occ.extrude([(2, surface)], 0.0, 0.0, top - bottom)
    return next(tag for dim, tag in volumes if dim == 3)


def _draw_pile(pile: ScrewPile, top: float) -> list[tuple[int, int]]:
    """Return the volume of shaft, tip and solid plates, from the tip up to the level ``top``."""
    occ = gmsh.model.occ
    tip, a = -pile.embedment, pile.shaft_radius
    bottom = tip + pile.tip_length
    shaft = [(3, occ.addCylinder(0.0, 0.0, bottom, 0.0, 0.0, top - bottom, a))]
    tools = [piece for helix in pile.helices if not helix.is_surface
             for piece in _draw_plate(pile, helix)]  # fmt: skip
    if pile.tip_length > 0.0:
        tools.append((3, occ.addCone(0.0, 0.0, tip, 0.0, 0.0, pile.tip_length, 0.0, a)))
    if not tools:
        return shaft
    body, _ = occ.fuse(shaft, tools)
    return list(body)


def _draw_sheet(pile: ScrewPile, helix: Helix) -> tuple[int, int]:
    """Return the middle surface of a plate, lofted through radial lines."""
    occ = gmsh.model.occ
    wires = []
    for winding in _section_windings(0.0, helix.winding):
        polar = pile.sense * winding
        level = pile.leading_level(helix) + helix.pitch * winding / (2.0 * np.pi)
        ends = [
            occ.addPoint(r * np.cos(polar), r * np.sin(polar), level)
            for r in (INSIDE_SHARE * pile.shaft_radius, helix.radius)
        ]
        wires.append(occ.addWire([occ.addLine(*ends)]))
    surfaces = occ.addThruSections(wires, makeSolid=False, makeRuled=False)
    return next((dim, tag) for dim, tag in surfaces if dim == 2)


def _section_windings(start: float, end: float) -> np.ndarray:
    """Return the winding angles (n,) of the sections between two."""
    n_sections = int(np.ceil(SECTIONS_PER_TURN * (end - start) / (2.0 * np.pi))) + 1
    return np.linspace(start, end, max(n_sections, LEAST_SECTIONS))


def _draw_plate(pile: ScrewPile, helix: Helix) -> list[tuple[int, int]]:
    """Return the volumes of a plate: one, or three if it thins towards its edges; and its noses.

    A loft is a spline: it would be off the plate on both sides of a bend in the thickness.
    """
    bends = []
    if helix.edge_thickness is not None:
        bends = [helix.taper_angle, helix.winding - helix.taper_angle]
    ends = np.unique([0.0, *bends, helix.winding])
    pieces = [_draw_piece(pile, helix, start, end) for start, end in pairwise(ends)]
    if helix.edges == "rounded":
        pieces += [_draw_nose(pile, helix, end) for end in (-1, 1)]
    return pieces


def _draw_piece(pile: ScrewPile, helix: Helix, start: float, end: float) -> tuple[int, int]:
    """Return the volume of a plate between two winding angles, lofted through radial rectangles."""
    occ = gmsh.model.occ
    windings = _section_windings(start, end)
    wires = []
    for winding, thickness in zip(windings, thickness_at(helix, windings), strict=True):
        level = pile.leading_level(helix) + helix.pitch * winding / (2.0 * np.pi)
        polar = pile.sense * winding
        corners = [
            occ.addPoint(r * np.cos(polar), r * np.sin(polar), level + side * thickness / 2.0)
            for r, side in (
                (INSIDE_SHARE * pile.shaft_radius, -1.0),
                (helix.radius, -1.0),
                (helix.radius, 1.0),
                (INSIDE_SHARE * pile.shaft_radius, 1.0),
            )
        ]
        lines = [occ.addLine(p, q) for p, q in zip(corners, corners[1:] + corners[:1], strict=True)]
        wires.append(occ.addWire(lines))
    volumes = occ.addThruSections(wires, makeSolid=True, makeRuled=False)
    return next((dim, tag) for dim, tag in volumes if dim == 3)


def _draw_nose(pile: ScrewPile, helix: Helix, end: int) -> tuple[int, int]:
    """Return the volume of the rounded leading (``end`` -1) or trailing (+1) edge of a plate.

    Its sections square to the edge are half circles, inclined with the climb of the plate there.
    They are lofted, and cut off at the radius of the rim.
    """
    occ = gmsh.model.occ
    winding = helix.winding if end > 0 else 0.0
    polar, half = pile.sense * winding, edge_thickness(helix) / 2.0
    level = pile.leading_level(helix) + helix.pitch * winding / (2.0 * np.pi)
    inside = INSIDE_SHARE * pile.shaft_radius
    wires = []
    for along in np.linspace(inside, helix.radius + half / 2.0, NOSE_SECTIONS):
        climb = helix.pitch / (2.0 * np.pi * along)
        corners = [
            occ.addPoint(
                along * np.cos(polar) - pile.sense * end * ahead * half * np.sin(polar),
                along * np.sin(polar) + pile.sense * end * ahead * half * np.cos(polar),
                level + half * (rise + climb * end * ahead),
            )
            for ahead, rise in ((0.0, -1.0), (1.0, -1.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
        ]
        quarters = [_quarter(corners[:3]), _quarter(corners[2:])]
        wires.append(occ.addWire([*quarters, occ.addLine(corners[4], corners[0])]))
    nose = occ.addThruSections(wires, makeSolid=True, makeRuled=False)
    height = 2.0 * (half + helix.pitch)
    rim = occ.addCylinder(0.0, 0.0, level - height, 0.0, 0.0, 2.0 * height, helix.radius)
    trimmed, _ = occ.intersect([entry for entry in nose if entry[0] == 3], [(3, rim)])
    return next((dim, tag) for dim, tag in trimmed if dim == 3)


def _quarter(corners: Sequence[int]) -> int:
    """Return a quarter of an ellipse: a rational curve with three control points."""
    weights = [1.0, np.sqrt(0.5), 1.0]
    curve: int = gmsh.model.occ.addBSpline(
        corners, degree=2, weights=weights, knots=[0.0, 1.0], multiplicities=[3, 3]
    )
    return curve


def _set_sizes(pile: ScrewPile, box: Box, options: ScrewMeshOptions) -> None:
    """Grade the cell size from edges, plates and shaft to the far field."""
    size_at = cell_size(pile, options)
    gmsh.model.mesh.setSizeCallback(lambda dim, tag, x, y, z, *rest: size_at(x, y, z))
    for option in ("FromPoints", "FromCurvature", "ExtendFromBoundary"):
        gmsh.option.setNumber(f"Mesh.MeshSize{option}", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMax", options.size_far)


def cell_size(pile: ScrewPile, options: ScrewMeshOptions) -> Callable[[float, float, float], float]:
    """Return the wanted cell size in m as a function of the place: it grows away from the pile."""
    sense, a, tip = pile.sense, pile.shaft_radius, -pile.embedment

    def size_at(x: float, y: float, z: float) -> float:
        radius = float(np.hypot(x, y))
        outside = max(radius - a, tip - z, 0.0)
        size = options.size_at_shaft + options.growth * outside
        for helix in pile.helices:
            leading = pile.leading_level(helix)
            height = helix.pitch * helix.turns
            off_radius = max(radius - helix.radius, 0.0)
            off_level = max(leading - z, z - leading - height, 0.0)
            from_plate = float(np.hypot(off_radius, off_level))
            size = min(size, options.size_at_plate + options.growth * from_plate)
            for winding in (0.0, helix.winding):
                polar = sense * winding
                along = x * np.cos(polar) + y * np.sin(polar)
                across = y * np.cos(polar) - x * np.sin(polar)
                beside = max(a - along, along - helix.radius, 0.0)
                rise = z - leading - helix.pitch * winding / (2.0 * np.pi)
                from_edge = float(np.sqrt(beside**2 + across**2 + rise**2))
                beyond = max(from_edge - options.edge_reach, 0.0)
                size = min(size, options.size_at_edges + options.growth * beyond)
        return float(min(size + GROWTH_ABOVE_GROUND * max(z, 0.0), options.size_far))

    return size_at


def _collect(sheets: Sequence[int]) -> BackgroundMesh:
    """Return the mesh that gmsh holds, with nodes numbered as used, cut along ``sheets``."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    _, cells = gmsh.model.mesh.getElementsByType(GMSH_TETRAHEDRON_10)
    used, cell_nodes = np.unique(cells, return_inverse=True)
    position = np.empty(int(tags.max()) + 1, dtype=np.int64)
    position[tags] = np.arange(len(tags))
    nodes = coordinates.reshape(-1, 3)[position[used]]
    mesh = make_background_mesh(nodes, cell_nodes.reshape(-1, 10))
    if not sheets:
        return mesh
    triangles = [gmsh.model.mesh.getElementsByType(GMSH_TRIANGLE_6, tag)[1] for tag in sheets]
    corners = np.concatenate(triangles).reshape(-1, 6)[:, :3]
    return cut_along(mesh, _facets_between(mesh, np.searchsorted(used, corners)))


def _facets_between(mesh: BackgroundMesh, corners: np.ndarray) -> np.ndarray:
    """Return which facets of the cells are those with ``corners`` (n, 3), (n_cells, 4) bool."""
    facets = facets_opposite_vertices(mesh.cell_nodes[:, :4]).reshape(-1, 3)
    _, facet = np.unique(
        np.sort(np.concatenate([corners, facets]), axis=1), axis=0, return_inverse=True
    )
    return np.isin(facet[len(corners) :], facet[: len(corners)]).reshape(-1, 4)
