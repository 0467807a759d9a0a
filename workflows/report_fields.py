"""Fields on material points and finite elements as pictures: squares, cells, colour bars."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize, TwoSlopeNorm
from matplotlib.patches import Rectangle
from scipy.spatial import cKDTree

from handoff.fe_mesh import FEMesh
from handoff.surface import height_at, surface_profile
from install_mpm.geostatic import named_state
from install_mpm.ground import GroundProfile, geostatic_stress
from install_mpm.material_points import MaterialPoints, plane_area
from workflows.case import Case
from workflows.report_style import INK, MUTED, PILE

PIXELS = 420
"""Pixels across a picture of material points."""

REACH = 1.5
"""Distance from its point, over the point's size, to which soil is drawn."""


class Window(NamedTuple):
    """Part of the ground that a picture shows."""

    right: float
    bottom: float
    top: float


def window_of(case: Case) -> Window:
    """Return the surroundings of the pile: three widths beside it and two and a half below."""
    width = case.pile.width
    return Window(
        right=min(case.box.width, 3.5 * width),
        bottom=-min(case.box.depth, case.final_tip_depth + 2.5 * width),
        top=case.box.headroom,
    )


def tip_window(case: Case) -> Window:
    """Return the neighbourhood of the installed pile's tip, in the same proportions."""
    window, width = window_of(case), case.pile.width
    right = 1.4 * width
    height = right * (window.top - window.bottom) / window.right
    return Window(right, -case.final_tip_depth - 0.6 * height, -case.final_tip_depth + 0.4 * height)


def nearest_index(points: MaterialPoints, case: Case, window: Window) -> np.ndarray:
    """Return for each pixel (n_rows, n_columns) of a picture the nearest material point.

    It is -1 outside the soil: above the surface, and further than ``REACH`` point sizes from any.
    """
    pixel = window.right / PIXELS
    x = np.arange(0.5 * pixel, window.right, pixel)
    z = np.arange(window.bottom + 0.5 * pixel, window.top, pixel)
    places = np.stack(np.meshgrid(x, z), axis=-1)
    distance, nearest = cKDTree(points.position).query(places)
    size = np.sqrt(plane_area(points, case.kinematics))
    surface = surface_profile(
        points, case.pile.half_width, case.handoff.size_at_pile, case.kinematics
    )
    is_soil = places[:, :, 1] < height_at(surface, places[:, :, 0])
    is_soil &= distance <= REACH * size[nearest]
    index: np.ndarray = np.where(is_soil, nearest, -1)
    return index


def draw_points(
    axes: Any, index: np.ndarray, values: np.ndarray, window: Window, norm: Any, cmap: str
) -> Any:
    """Draw ``values`` (n,) of material points, every pixel with the value of its nearest point."""
    image = np.ma.masked_array(values[index], mask=index < 0)
    extent = (0.0, window.right, window.bottom, window.top)
    return axes.imshow(
        image, extent=extent, origin="lower", interpolation="nearest", cmap=cmap, norm=norm
    )


def sub_regions(mesh: FEMesh, integration_positions: np.ndarray) -> np.ndarray:
    """Return the quadrilaterals (n_q, 4, 2) of an FE mesh that belong to its integration points.

    Each cell is shared out among its three points, each of which takes the part around its vertex.
    """
    corners = mesh.nodes[mesh.cell_nodes[:, :3]]
    mid_sides = mesh.nodes[mesh.cell_nodes[:, 3:]]
    centre = corners.mean(axis=1, keepdims=True)
    parts = np.stack(
        [corners, mid_sides, np.repeat(centre, 3, axis=1), np.roll(mid_sides, 1, axis=1)], axis=2
    )
    points = integration_positions.reshape(len(corners), 3, 2)
    distance = np.linalg.norm(points[:, :, None] - corners[:, None], axis=3)
    vertex = distance.argmin(axis=2)
    chosen: np.ndarray = np.take_along_axis(parts, vertex[:, :, None, None], axis=1)
    return chosen.reshape(-1, 4, 2)


def draw_polygons(axes: Any, polygons: np.ndarray, values: np.ndarray, norm: Any, cmap: str) -> Any:
    """Draw coloured ``polygons`` (n, corners, 2) as an image; return what a colour bar needs."""
    collection = PolyCollection(polygons, array=values, cmap=cmap, norm=norm)
    collection.set(edgecolor="face", linewidth=0.15, rasterized=True)
    axes.add_collection(collection)
    return collection


def draw_nodal(axes: Any, mesh: FEMesh, values: np.ndarray, norm: Any, cmap: str) -> Any:
    """Draw nodal ``values`` (node,), linear on the four parts of each six-node triangle."""
    parts = mesh.cell_nodes[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]]].reshape(-1, 3)
    return axes.tripcolor(
        *mesh.nodes.T, parts, values, shading="gouraud", cmap=cmap, norm=norm, rasterized=True
    )


def draw_mesh(axes: Any, nodes: np.ndarray, cell_nodes: np.ndarray) -> None:
    """Draw the edges of triangles ``cell_nodes`` (n, 3) as thin lines."""
    ends = np.concatenate([cell_nodes[:, [0, 1]], cell_nodes[:, [1, 2]], cell_nodes[:, [2, 0]]])
    edges = np.unique(np.sort(ends, axis=1), axis=0)
    lines = LineCollection(list(nodes[edges]), colors=MUTED, linewidths=0.4)
    lines.set_rasterized(True)
    axes.add_collection(lines)


def draw_pile(axes: Any, half_width: float, tip_depth: float, window: Window) -> None:
    """Draw the pile's half, and the axis of symmetry below it."""
    height = max(tip_depth + window.top, 0.0)
    axes.add_patch(Rectangle((0.0, -tip_depth), half_width, height, facecolor=PILE, linewidth=0.0))
    axes.plot(
        [0.0, 0.0], [window.bottom, -tip_depth], color=INK, linewidth=0.7, dashes=(8, 3, 2, 3)
    )


def finish(axes: Any, window: Window, title: str, *, with_height: bool) -> None:
    """Set extent, equal scale, labels and title of a picture of the ground."""
    axes.set_xlim(0.0, window.right)
    axes.set_ylim(window.bottom, window.top)
    axes.set_aspect("equal")
    if title:
        axes.set_title(title)
    axes.set_xlabel("x (m)")
    if with_height:
        axes.set_ylabel("z (m)")
    else:
        axes.tick_params(labelleft=False)


def colour_bar(figure: Any, mappable: Any, axes: Any, label: str, extend: str = "neither") -> None:
    """Add a horizontal colour bar below ``axes``."""
    bar = figure.colorbar(
        mappable, ax=axes, location="bottom", label=label, extend=extend, aspect=28, pad=0.015
    )
    bar.solids.set_rasterized(True)
    bar.outline.set_visible(False)


def symmetric_norm(values: np.ndarray) -> TwoSlopeNorm:
    """Return a norm centred on zero that spans 99 % of ``values`` and ends on a round number."""
    limit = _round_up(float(np.percentile(np.abs(values), 99.0)))
    return TwoSlopeNorm(0.0, -limit, limit)


def positive_norm(values: np.ndarray) -> Normalize:
    """Return a norm from zero that spans 99.5 % of ``values`` and ends on a round number."""
    return Normalize(0.0, _round_up(float(np.percentile(values, 99.5))))


def _round_up(value: float) -> float:
    """Return the next number of the series 1, 1.5, 2, 3, 4, 5, 6, 8, 10."""
    if value <= 0.0:
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    steps = np.array([1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0])
    return float(power * steps[np.searchsorted(steps, value / power * (1.0 - 1e-12))])


def pressure_change(ground: GroundProfile, stress: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Return the change of mean pressure (n,) in kPa, compression positive."""
    change = stress - geostatic_stress(ground, height, vertical=1)
    pressure: np.ndarray = -np.trace(change, axis1=1, axis2=2) / 3.0 / 1e3
    return pressure


def deviatoric_stress(stress: np.ndarray) -> np.ndarray:
    """Return |s| / sqrt(2) (n,) in Pa, which is the shear stress in plane strain."""
    mean = np.trace(stress, axis1=1, axis2=2) / 3.0
    deviator = stress - mean[:, None, None] * np.eye(3)
    return np.asarray(np.sqrt((deviator**2).sum(axis=(1, 2)) / 2.0))


class ShearMeasure(NamedTuple):
    """What the shear stress is compared with: the strength where the soil has one, else 1 kPa."""

    values: np.ndarray
    label: str
    limit: float | None


def shear_measure(
    ground: GroundProfile, stress: np.ndarray, material: np.ndarray, state: np.ndarray
) -> ShearMeasure:
    """Return mobilised shear strength (n,), or shear stress in kPa if a soil has no strength."""
    shear = deviatoric_stress(stress)
    strength = named_state(ground, material, state, "undrained_shear_strength")
    if strength is None:
        return ShearMeasure(shear / 1e3, "shear stress (kPa)", None)
    return ShearMeasure(shear / strength, "mobilised shear strength", 1.0)


def initial_position(points: MaterialPoints) -> np.ndarray:
    """Return where the material points (n, 2) were before the installation."""
    start: np.ndarray = points.position - points.displacement
    return start


def picture_height(window: Window, columns: int, width: float) -> float:
    """Return the height in inches at which equal scales fill ``columns`` pictures of the window."""
    return (window.top - window.bottom) / window.right * (width - 0.8) / columns + 0.7
