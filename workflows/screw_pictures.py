"""Picture of the mesh around a screw pile, to be looked at before a run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from install_mpm.background_mesh import BackgroundMesh, cell_quality
from install_mpm.screw_pile import PARTS_OF_HELIX, PARTS_OF_PILE
from install_mpm.screw_pile_mesh import generate_screw_mesh
from install_mpm.screw_programme import rim_radius
from install_mpm.screw_surface import pile_elements
from workflows.report_fields import colour_bar
from workflows.report_style import INK, PILE, SEQUENTIAL, panels, png_of, styled
from workflows.screw_case import ScrewCase
from workflows.screw_frames import vertex_mesh
from workflows.screw_surface_pictures import ROWS, draw_image, frame_around, views_of
from workflows.screw_view import (
    OVERSAMPLING,
    Frame,
    View,
    colour,
    feature_edges,
    ink,
    mesh_lines,
    rasterise,
    shading,
    smoothed,
)

PART_COLOURS = (
    "#b9c2ca", "#b9c2ca", "#d9dee2", "#e3a18f", "#8fb8d0", "#dfc27d", "#c8553d", "#3d7ea6",
)  # fmt: skip
"""Of tip, cone, shaft, lower and upper face, rim, leading and trailing edge."""


def write_mesh_picture(path: Path, case: ScrewCase) -> None:
    """Mesh the ground of ``case`` and draw it into the PNG file ``path``."""
    mesh = generate_screw_mesh(case.pile, case.box, case.background_mesh)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(mesh_picture(case, mesh))


def mesh_picture(case: ScrewCase, mesh: BackgroundMesh) -> bytes:
    """Return the mesh around the pile as PNG: its surface from above and below, and a cut."""
    with styled():
        return png_of(mesh_figure(case, mesh))


def mesh_figure(case: ScrewCase, mesh: BackgroundMesh) -> Figure:
    """Return the surface of the pile with the facets of the mesh, and the cut y = 0."""
    elements, part, _ = pile_elements(mesh, case.pile)
    triangles = mesh.nodes[elements.nodes[:, :3]]
    views = views_of(case.pile, 0.0)
    frames = [frame_around(case.pile, view, 0.0) for view in views]
    figure, axes = panels(1, 3, 12.0, 5.3, width_ratios=(1.0, 1.0, 1.6))
    for here, view, frame in zip(axes[0], views, frames, strict=False):
        draw_image(here, _facets(triangles, part, view, frame), frame)
    axes[0, 0].set_title(f"pile surface: {len(part)} facets")
    axes[0, 1].set_title("from below")
    figure.legend(handles=_legend(part), loc="outside lower left", ncols=4, handlelength=1.2)
    _draw_cut(figure, axes[0, 2], case, mesh)
    return figure


def kind_of(part: np.ndarray) -> np.ndarray:
    """Return the parts (n,) numbered as those of a pile with one helix."""
    first, per_helix = len(PARTS_OF_PILE), len(PARTS_OF_HELIX)
    return np.where(part < first, part, first + (part - first) % per_helix)


def _facets(triangles: np.ndarray, part: np.ndarray, view: View, frame: Frame) -> np.ndarray:
    """Return the picture (rows, columns, 4) of facets with their edges, coloured by part."""
    raster = rasterise(triangles, view, frame, OVERSAMPLING * ROWS)
    values = np.repeat(kind_of(part)[:, None], 3, axis=1).astype(np.float64)
    palette, norm = ListedColormap(PART_COLOURS), Normalize(-0.5, len(PART_COLOURS) - 0.5)
    picture = colour(raster, values, shading(triangles, view, 0.5), lambda v: palette(norm(v)))
    picture = ink(picture, mesh_lines(raster, triangles, view, 1.2 * OVERSAMPLING), 0.45)
    return smoothed(ink(picture, feature_edges(raster, part), 0.9))


def _legend(part: np.ndarray) -> list[Patch]:
    names, kinds = PARTS_OF_PILE + PARTS_OF_HELIX, np.unique(kind_of(part))
    return [Patch(facecolor=PART_COLOURS[kind], label=names[kind]) for kind in kinds]


def _draw_cut(figure: Figure, axes: Any, case: ScrewCase, mesh: BackgroundMesh) -> None:
    """Draw the cells that the plane y = 0 cuts, coloured by their shape."""
    used, cells, _ = vertex_mesh(mesh)
    polygons, cut = plane_section(mesh.nodes[used], cells)
    norm = Normalize(0.0, 1.0)
    drawn = PolyCollection(
        polygons, array=cell_quality(mesh)[cut], cmap=SEQUENTIAL, norm=norm,
        edgecolor="white", linewidth=0.35,
    )  # fmt: skip
    axes.add_collection(drawn)
    reach = min(3.0 * rim_radius(case.pile), case.box.width)
    bottom = max(-case.final_tip_depth - 1.5 * rim_radius(case.pile), -case.box.depth)
    axes.set(xlim=(-reach, reach), ylim=(bottom, case.box.headroom), aspect="equal",
             xlabel="x (m)", ylabel="z (m)", facecolor=PILE)  # fmt: skip
    axes.axhline(0.0, color=INK, linewidth=1.2)
    worst = cell_quality(mesh).min()
    axes.set_title(f"cut y = 0: {len(mesh.cell_nodes)} cells, worst shape {worst:.2f}")
    colour_bar(figure, drawn, axes, "shape $3\\,r_{in}/r_{out}$ of the cells, 1 is regular")


def plane_section(nodes: np.ndarray, cells: np.ndarray) -> tuple[list[np.ndarray], np.ndarray]:
    """Return where tetrahedra meet the plane y = 0: polygons (3 or 4, 2) in x, z, and their cells.

    ``nodes`` (m, 3) in m, ``cells`` (n, 4).
    """
    height = np.where(np.abs(nodes[:, 1]) < 1e-12, 1e-12, nodes[:, 1])
    cut = np.flatnonzero(np.abs((height[cells] > 0.0).sum(axis=1) - 2) < 2)
    polygons = []
    for corners in cells[cut]:
        above, below = corners[height[corners] > 0.0], corners[height[corners] < 0.0]
        ends = [(a, b) for a in above for b in below]
        if len(ends) == 4:  # round the quadrilateral
            ends = [ends[0], ends[1], ends[3], ends[2]]
        polygons.append(np.array([_crossing(nodes, height, a, b) for a, b in ends]))
    return polygons, cut


def _crossing(nodes: np.ndarray, height: np.ndarray, a: int, b: int) -> np.ndarray:
    share = height[a] / (height[a] - height[b])
    place: np.ndarray = (nodes[a] + share * (nodes[b] - nodes[a]))[[0, 2]]
    return place
