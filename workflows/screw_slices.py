"""Slices through the ground around a screw pile: every pixel shows its nearest material point."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from install_mpm.ground import GroundProfile, geostatic_stress
from install_mpm.screw_pile import ScrewPile, thickness_at, winding_angle
from install_mpm.screw_programme import Pose, rim_radius
from install_mpm.screw_shape import distance_to_noses
from workflows.report_style import INK, PILE
from workflows.screw_frames import PointCloud

PIXELS = 480
"""Pixels across a slice."""

REACH = 2.5
"""Distance from its point, over the point's size, to which soil is drawn; cells are not cubes."""

ARROWS = 26
"""Arrows of displacement across a slice."""

MARGIN = 2.6
"""Half-width of a slice over the radius of the largest plate."""


class Slice(NamedTuple):
    """Pixels of a plane through the ground."""

    places: np.ndarray
    """(rows, columns, 3) in m."""
    extent: tuple[float, float, float, float]
    """Left, right, bottom and top in the coordinates of the picture, in m."""
    axes: tuple[int, int]
    """Which coordinates the picture shows across and upward."""


class SoilPixels(NamedTuple):
    """What the ground and the pile are in each pixel of a slice."""

    index: np.ndarray
    """Nearest material point (rows, columns), -1 outside the soil."""
    to_pile: np.ndarray
    """Distance from the pile in m, negative inside, (rows, columns)."""


def vertical_slice(
    pile: ScrewPile, depth: float, headroom: float, box_width: float, pixels: int = PIXELS
) -> Slice:
    """Return the plane through the axis, from below the deepest tip ``depth`` to ``headroom``."""
    reach = min(MARGIN * rim_radius(pile), 0.98 * box_width)
    bottom = -depth - 1.6 * rim_radius(pile)
    top = min(headroom, 0.6 * rim_radius(pile))
    size = 2.0 * reach / pixels
    x = np.arange(-reach + size / 2.0, reach, size)
    z = np.arange(bottom + size / 2.0, top, size)
    across, up = np.meshgrid(x, z)
    places = np.stack([across, np.zeros_like(across), up], axis=-1)
    return Slice(places, (-reach, reach, bottom, bottom + len(z) * size), (0, 2))


def horizontal_slice(pile: ScrewPile, level: float, box_width: float) -> Slice:
    """Return the level plane at the height ``level`` in m."""
    reach = min(MARGIN * rim_radius(pile), 0.98 * box_width)
    size = 2.0 * reach / PIXELS
    x = np.arange(-reach + size / 2.0, reach, size)
    across, up = np.meshgrid(x, x)
    places = np.stack([across, up, np.full_like(across, level)], axis=-1)
    return Slice(places, (-reach, reach, -reach, reach), (0, 1))


def plate_level(pile: ScrewPile, pose: Pose) -> float:
    """Return the height in m of the middle of the lowest plate (of the tip, if there is none)."""
    if not pile.helices:
        return -pile.embedment - pose.advance
    lowest = min(pile.helices, key=lambda helix: helix.height)
    return pile.leading_level(lowest) + lowest.pitch * lowest.turns / 2.0 - pose.advance


def distance_from_pile(pile: ScrewPile, pose: Pose, places: np.ndarray) -> np.ndarray:
    """Return about how far ``places`` (..., 3) are from the pile in m, negative inside it."""
    cosine, sine = np.cos(pose.rotation), np.sin(pose.rotation)
    flat = places.reshape(-1, 3)
    own = np.column_stack(
        [
            cosine * flat[:, 0] + sine * flat[:, 1],
            cosine * flat[:, 1] - sine * flat[:, 0],
            flat[:, 2] + pose.advance,
        ]
    )
    radius, above_tip = np.hypot(own[:, 0], own[:, 1]), own[:, 2] + pile.embedment
    distance = np.maximum(radius - pile.shaft_radius, -above_tip)
    if pile.tip_length > 0.0:
        across = radius * pile.tip_length - above_tip * pile.shaft_radius
        distance = np.maximum(distance, across / np.hypot(pile.tip_length, pile.shaft_radius))
    for helix in pile.helices:
        winding = winding_angle(pile, helix, own)
        middle = pile.leading_level(helix) + helix.pitch * winding / (2.0 * np.pi)
        beyond = np.maximum(-winding, winding - helix.winding) * radius
        off_plate = np.abs(own[:, 2] - middle) - thickness_at(helix, winding) / 2.0
        outside = np.maximum(radius - helix.radius, pile.shaft_radius * 0.9 - radius)
        body = np.maximum(off_plate, beyond)
        if helix.edges == "rounded":
            body = np.minimum(body, distance_to_noses(pile, helix, own))
        distance = np.minimum(distance, np.maximum(body, outside))
    return distance.reshape(places.shape[:-1])


def soil_pixels(plane: Slice, cloud: PointCloud, pile: ScrewPile, pose: Pose) -> SoilPixels:
    """Return the nearest material point of each pixel.

    There is none above the surface, and none where the next point is further away than
    ``REACH`` of its size.
    """
    places = plane.places
    distance, nearest = cKDTree(cloud.position).query(places)
    size = np.cbrt(cloud.volume)[nearest]
    above = places[..., 2] - cloud.position[nearest, 2]
    is_soil = (distance <= REACH * size) & ((places[..., 2] < 0.0) | (above <= size / 2.0))
    to_pile = distance_from_pile(pile, pose, places)
    return SoilPixels(np.where(is_soil & (to_pile > 0.0), nearest, -1), to_pile)


def draw_slice(
    axes: Any, plane: Slice, soil: SoilPixels, values: np.ndarray, norm: Any, cmap: str
) -> Any:
    """Draw ``values`` (n,) of the material points, and the section of the pile."""
    image = np.ma.masked_array(values[soil.index], mask=soil.index < 0)
    drawn = axes.imshow(
        image, extent=plane.extent, origin="lower", interpolation="nearest", cmap=cmap, norm=norm
    )
    left, right, bottom, top = plane.extent
    rows, columns = soil.to_pile.shape
    x = left + (np.arange(columns) + 0.5) * (right - left) / columns
    y = bottom + (np.arange(rows) + 0.5) * (top - bottom) / rows
    if soil.to_pile.min() < 0.0:
        axes.contourf(x, y, soil.to_pile, levels=[-1e9, 0.0], colors=[PILE])
        axes.contour(x, y, soil.to_pile, levels=[0.0], colors=[INK], linewidths=0.8)
    axes.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
    return drawn


def mean_pressure_change(ground: GroundProfile, cloud: PointCloud) -> np.ndarray:
    """Return the change of mean pressure (n,) in kPa since the ground was undisturbed."""
    before = geostatic_stress(ground, cloud.position[:, 2], vertical=2)
    change = cloud.mean_pressure + np.trace(before, axis1=1, axis2=2) / 3.0
    return np.asarray(change / 1e3)


def draw_arrows(axes: Any, plane: Slice, soil: SoilPixels, displacement: np.ndarray) -> None:
    """Draw where the soil went: ``displacement`` (n, 3) of points, its part in the plane.

    Arrows are to scale among themselves; the longest few are cut to the length of the others.
    """
    step = max(1, soil.index.shape[1] // ARROWS)
    chosen = (slice(step // 2, None, step),) * 2
    seen = soil.index[chosen] >= 0
    start = plane.places[chosen][seen][:, plane.axes]
    moved = displacement[soil.index[chosen][seen]][:, plane.axes]
    length = np.linalg.norm(moved, axis=1)
    if not length.any():
        return
    longest = np.percentile(length, 97.0)
    visible = length > 0.06 * longest
    moved *= np.minimum(1.0, longest / np.maximum(length, 1e-300))[:, None]
    left, right, _, _ = plane.extent
    spacing = (right - left) * step / soil.index.shape[1]
    axes.quiver(
        *start[visible].T, *moved[visible].T, color=INK, width=0.0028, headwidth=4.0,
        angles="xy", scale_units="xy", scale=longest / (1.7 * spacing),
    )  # fmt: skip
