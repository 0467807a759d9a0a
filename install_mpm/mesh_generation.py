"""Background mesh of a pile in a box, by gmsh."""

from __future__ import annotations

from collections.abc import Sequence

import gmsh
import numpy as np

from install_mpm.background_mesh import BackgroundMesh, make_background_mesh
from install_mpm.cells import CellType, reference_cell
from install_mpm.options import BackgroundMeshOptions, Box
from install_mpm.pile import Pile
from install_mpm.soil_bands import Drawing, soil_bands

GMSH_TYPE = {CellType.TRI3: 2, CellType.TRI6: 9}
"""Numbers by which gmsh knows the cells."""
FINE_REACH = 1.0
"""Half-widths around the base within which the size is that at the pile; half for the shaft."""


def generate_background_mesh(
    pile: Pile,
    box: Box,
    options: BackgroundMeshOptions,
    boundaries: Sequence[float] = (),
    cell_type: CellType = CellType.TRI6,
) -> BackgroundMesh:
    """Return a mesh of triangles conforming to the pile and to the level ground surface.

    It also conforms to the ``boundaries`` of layers, depths in m, so that geostatic stress, which
    jumps there or changes its slope, is integrated exactly.  It covers the ground and the headroom
    above it, and is finest at the base and along the shaft of the pile.
    """
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)  # more threads: another mesh in every run
        gmsh.model.add("background")
        _draw(pile, box, boundaries)
        _set_sizes(pile, options)
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(2 if cell_type == CellType.TRI6 else 1)
        return _collect(cell_type)
    finally:
        gmsh.finalize()


def _draw(pile: Pile, box: Box, boundaries: Sequence[float]) -> None:
    """Draw bands of soil and the headroom as surfaces that share their lines."""
    drawing = Drawing(gmsh.model.geo)
    bands = soil_bands(pile, pile.embedment, box, boundaries)
    headroom = [
        (pile.half_width, 0.0),
        (box.width, 0.0),
        (box.width, box.headroom),
        (pile.half_width, box.headroom),
    ]
    for outline in [*bands, np.array(headroom)]:
        drawing.add_surface(outline)
    gmsh.model.geo.synchronize()
    tip, side = (0.0, -pile.embedment), pile.half_width
    base = [
        line for ends, line in drawing.lines.items() if tip in ends and ends[0][1] == ends[1][1]
    ]
    shaft = [line for ends, line in drawing.lines.items() if ends[0][0] == side == ends[1][0]]
    for name, lines in (("base", base), ("shaft", shaft)):
        gmsh.model.setPhysicalName(1, gmsh.model.addPhysicalGroup(1, lines), name)


def _set_sizes(pile: Pile, options: BackgroundMeshOptions) -> None:
    """Grade the cell size from the pile to the far field."""
    field = gmsh.model.mesh.field
    lines = {
        gmsh.model.getPhysicalName(1, tag): gmsh.model.getEntitiesForPhysicalGroup(1, tag)
        for _, tag in gmsh.model.getPhysicalGroups(1)
    }
    thresholds = []
    for name, coarser, reach in (("base", 1.0, FINE_REACH), ("shaft", 1.5, FINE_REACH / 2)):
        distance = field.add("Distance")
        field.setNumbers(distance, "CurvesList", list(lines[name]))
        field.setNumber(distance, "Sampling", 200)
        threshold = field.add("Threshold")
        field.setNumber(threshold, "InField", distance)
        field.setNumber(threshold, "SizeMin", min(coarser * options.size_at_pile, options.size_far))
        field.setNumber(threshold, "SizeMax", options.size_far)
        field.setNumber(threshold, "DistMin", reach * pile.half_width)
        field.setNumber(threshold, "DistMax", 4.0 * pile.half_width + 4.0 * options.size_far)
        thresholds.append(threshold)
    smallest = field.add("Min")
    field.setNumbers(smallest, "FieldsList", thresholds)
    field.setAsBackgroundMesh(smallest)
    for option in ("FromPoints", "FromCurvature", "ExtendFromBoundary"):
        gmsh.option.setNumber(f"Mesh.MeshSize{option}", 0)


def _collect(cell_type: CellType) -> BackgroundMesh:
    """Return the mesh that gmsh holds, with nodes numbered as used."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    _, cells = gmsh.model.mesh.getElementsByType(GMSH_TYPE[cell_type])
    used, cell_nodes = np.unique(cells, return_inverse=True)
    position = np.empty(int(tags.max()) + 1, dtype=np.int64)
    position[tags] = np.arange(len(tags))
    nodes = coordinates.reshape(-1, 3)[position[used], :2]
    n_cell_nodes = reference_cell(cell_type).n_nodes
    return make_background_mesh(nodes, cell_nodes.reshape(-1, n_cell_nodes))
