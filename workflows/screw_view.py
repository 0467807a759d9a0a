"""Pictures of surfaces in space: parallel projection, hidden surfaces, shading and edges.

Triangles are drawn into a grid of pixels that keeps, for every pixel, the nearest triangle and the
place in it.  Colours, shading and lines are made from that grid, so what lies behind is hidden
exactly and a picture of ten thousand facets takes a moment.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from scipy.ndimage import binary_dilation

LIGHT = np.array([-0.45, 0.35, 1.0])
"""Direction to the light: from the left, from above and from the viewer."""

EDGE_WIDTH = 1
"""Pixels, of those drawn, by which an edge is widened on either side."""

OVERSAMPLING = 2
"""Pixels drawn per pixel of the picture in each direction, for smooth edges."""

INK_COLOUR = np.array([0.106, 0.165, 0.220])

DEPTH_STEP = 0.04
"""Jump in depth, over the height of the picture, that is drawn as an edge."""


SAME_DEPTH = 1e-6
"""Difference in depth in m up to which triangles lie at the same place."""


class View(NamedTuple):
    """Directions of a picture in space, unit vectors."""

    right: np.ndarray
    up: np.ndarray
    towards: np.ndarray
    """To the viewer."""


class Frame(NamedTuple):
    """Part of the projection plane that a picture shows, in m."""

    left: float
    right: float
    bottom: float
    top: float


class Raster(NamedTuple):
    """What is seen in each pixel; the first row is the lowest."""

    triangle: np.ndarray
    """Nearest triangle (rows, columns), -1 where there is none."""
    shares: np.ndarray
    """Barycentric coordinates in it, (rows, columns, 3)."""
    depth: np.ndarray
    """Distance towards the viewer in m, -inf where there is nothing, (rows, columns)."""
    frame: Frame


def view_from(azimuth: float, elevation: float) -> View:
    """Return the view from a direction: angles in rad, azimuth from the x towards the y axis."""
    towards = np.array(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ]
    )
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    return View(right, np.cross(towards, right), towards)


def project(places: np.ndarray, view: View) -> np.ndarray:
    """Return places (..., 3) in the axes of the view: right, up, towards the viewer."""
    projected: np.ndarray = places @ np.stack([view.right, view.up, view.towards]).T
    return projected


def rasterise(triangles: np.ndarray, view: View, frame: Frame, rows: int) -> Raster:
    """Return what is seen of ``triangles`` (n, 3, 3) in a picture of ``rows`` pixels height.

    Of two triangles at the same place, the sides of a plate without thickness, the one is seen
    whose corners go round clockwise, as those of facets do from outside the pile.
    """
    size = (frame.top - frame.bottom) / rows
    columns = max(1, round((frame.right - frame.left) / size))
    triangle = np.full((rows, columns), -1, dtype=np.int64)
    shares, depth = np.zeros((rows, columns, 3)), np.full((rows, columns), -np.inf)
    corners = project(triangles, view)
    corners[:, :, :2] = (corners[:, :, :2] - (frame.left, frame.bottom)) / size - 0.5
    edge, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    twice_area = edge[:, 0] * other[:, 1] - edge[:, 1] * other[:, 0]
    low = np.clip(np.ceil(corners[:, :, :2].min(axis=1)), 0, None).astype(np.int64)
    last = np.floor(corners[:, :, :2].max(axis=1)).astype(np.int64)
    high = np.minimum(last + 1, (columns, rows))
    clockwise_first = np.argsort(twice_area > 0.0, kind="stable")
    is_drawn = (np.abs(twice_area) > 1e-9) & (high > low).all(axis=1)
    for k in clockwise_first[is_drawn[clockwise_first]]:
        _draw(k, corners[k], twice_area[k], (low[k], high[k]), triangle, shares, depth)
    return Raster(triangle, shares, depth, frame)


def _draw(
    number: int,
    corners: np.ndarray,
    twice_area: float,
    box: tuple[np.ndarray, np.ndarray],
    triangle: np.ndarray,
    shares: np.ndarray,
    depth: np.ndarray,
) -> None:
    """Draw one triangle of projected ``corners`` (3, 3) into the pixels of its ``box``."""
    (x0, y0), (x1, y1) = box
    a, b, c = corners
    x, y = np.arange(x0, x1)[None, :], np.arange(y0, y1)[:, None]
    at_b = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / twice_area
    at_c = ((y - a[1]) * (b[0] - a[0]) - (x - a[0]) * (b[1] - a[1])) / twice_area
    at_a = 1.0 - at_b - at_c
    here = at_a * a[2] + at_b * b[2] + at_c * c[2]
    window = (slice(y0, y1), slice(x0, x1))
    is_seen = (
        (at_a >= -1e-9) & (at_b >= -1e-9) & (at_c >= -1e-9) & (here > depth[window] + SAME_DEPTH)
    )
    triangle[window][is_seen] = number
    depth[window][is_seen] = here[is_seen]
    shares[window][is_seen] = np.stack([at_a, at_b, at_c], axis=-1)[is_seen]


def shading(triangles: np.ndarray, view: View, darkest: float) -> np.ndarray:
    """Return the brightness (n,) of triangles, either side of which may be seen.

    ``darkest`` is that of one that the light does not reach.
    """
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    normal *= np.where(normal @ view.towards < 0.0, -1.0, 1.0)[:, None]
    light = project(normal, view) @ (LIGHT / np.linalg.norm(LIGHT))
    brightness: np.ndarray = darkest + (1.0 - darkest) * np.clip(light, 0.0, 1.0)
    return brightness


def colour(raster: Raster, values: np.ndarray, brightness: np.ndarray, cmap: Any) -> np.ndarray:
    """Return the picture (rows, columns, 4) of ``values`` (n, 3) at the corners of triangles.

    ``cmap`` maps values to colours; where nothing is seen the picture is transparent.
    """
    seen = raster.triangle >= 0
    index = raster.triangle[seen]
    picture = np.zeros((*raster.triangle.shape, 4))
    colours = cmap((raster.shares[seen] * values[index]).sum(axis=1))[:, :3]
    picture[seen, :3] = colours * brightness[index][:, None]
    picture[seen, 3] = 1.0
    return picture


def feature_edges(raster: Raster, groups: np.ndarray) -> np.ndarray:
    """Return the pixels (rows, columns) where one of the ``groups`` (n,) of triangles ends."""
    group = np.where(raster.triangle >= 0, groups[raster.triangle], -1)
    jump = DEPTH_STEP * (raster.frame.top - raster.frame.bottom)
    depth = np.where(np.isfinite(raster.depth), raster.depth, -1e30)
    edges = np.zeros(group.shape, dtype=bool)
    for axis in (0, 1):
        here, ahead = [slice(None)] * 2, [slice(None)] * 2
        here[axis], ahead[axis] = slice(None, -1), slice(1, None)
        one, other = tuple(here), tuple(ahead)
        edges[one] |= (group[one] != group[other]) | (np.abs(depth[one] - depth[other]) > jump)
    wider: np.ndarray = binary_dilation(edges, iterations=EDGE_WIDTH)
    return wider


def mesh_lines(raster: Raster, triangles: np.ndarray, view: View, width: float) -> np.ndarray:
    """Return the pixels (rows, columns) on edges of triangles; ``width`` of the lines in pixels."""
    corners = project(triangles, view)[:, :, :2]
    edge, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    twice_area = np.abs(edge[:, 0] * other[:, 1] - edge[:, 1] * other[:, 0])
    opposite = np.linalg.norm(corners[:, [2, 0, 1]] - corners[:, [1, 2, 0]], axis=2)
    altitude = twice_area[:, None] / np.maximum(opposite, 1e-300)
    rows = raster.triangle.shape[0]
    pixel = (raster.frame.top - raster.frame.bottom) / rows
    seen = raster.triangle >= 0
    lines = np.zeros(raster.triangle.shape, dtype=bool)
    distance = raster.shares[seen] * altitude[raster.triangle[seen]] / pixel
    lines[seen] = (distance < width / 2.0).any(axis=1)
    return lines


def ink(picture: np.ndarray, lines: np.ndarray, strength: float = 1.0) -> np.ndarray:
    """Return the picture (rows, columns, 4) with ``lines`` (rows, columns) drawn over it."""
    drawn = picture.copy()
    drawn[lines, :3] = (1.0 - strength) * picture[lines, :3] + strength * INK_COLOUR
    drawn[lines, 3] = np.maximum(picture[lines, 3], strength)
    return drawn


def smoothed(picture: np.ndarray) -> np.ndarray:
    """Return the picture with ``OVERSAMPLING`` pixels averaged to one in each direction."""
    n = OVERSAMPLING
    rows, columns = (length // n * n for length in picture.shape[:2])
    blocks = picture[:rows, :columns].reshape(rows // n, n, columns // n, n, 4)
    opacity = blocks[..., 3:].mean(axis=(1, 3))
    colours = (blocks[..., :3] * blocks[..., 3:]).mean(axis=(1, 3))
    return np.concatenate([colours / np.maximum(opacity, 1e-9), opacity], axis=-1)
