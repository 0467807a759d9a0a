"""Pictures of the surface of a screw pile in space, e.g. with the tractions of the soil."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from install_mpm.screw_pile import ScrewPile
from install_mpm.screw_programme import Pose, rim_radius
from workflows.report_fields import colour_bar, positive_norm, symmetric_norm
from workflows.report_style import DIVERGING, INTENSITY, PILE, SEQUENTIAL, panels
from workflows.screw_frames import PileSurface
from workflows.screw_view import (
    OVERSAMPLING,
    Frame,
    View,
    colour,
    feature_edges,
    ink,
    rasterise,
    shading,
    smoothed,
    view_from,
)

AZIMUTH = np.radians(-50.0)
"""Of the viewer from the leading edge of the lowest helix of a right-handed pile."""

ABOVE, BELOW = np.radians(22.0), np.radians(-28.0)
"""Elevation of the viewer."""

DARKEST = 0.72
"""Brightness of a facet that the light does not reach: colours can still be read."""

ROWS = 440
"""Pixels of the height of a picture."""

AROUND = 1.15
"""Radius of the picture of a pile over the radius of its largest plate."""

UNUSUAL = 0.02
"""Share of the area with the largest, and with the smallest, pressures: beyond the colours."""

Colours = Callable[[np.ndarray], np.ndarray]


def views_of(pile: ScrewPile, rotation: float) -> tuple[View, View]:
    """Return the views from above and from below of a pile that has turned by ``rotation``."""
    azimuth = rotation + pile.sense * AZIMUTH
    return view_from(azimuth, ABOVE), view_from(azimuth, BELOW)


def frame_around(pile: ScrewPile, view: View, advance: float) -> Frame:
    """Return the part of the picture plane with tip and plates, the pile centred."""
    reach = AROUND * rim_radius(pile)
    tops = [h.height + h.pitch * h.turns + h.thickness / 2.0 for h in pile.helices]
    upper = min(max([2.0 * reach, *(top + 0.7 * reach for top in tops)]), pile.embedment + reach)
    flat, tilt, tip = view.up[2], abs(view.towards[2]), -pile.embedment - advance
    lows = [
        (height - pile.embedment - advance) * flat - tilt * radius
        for height, radius in (
            (0.0, pile.shaft_radius if pile.tip_length == 0.0 else 0.0),
            *((h.height - h.thickness / 2.0, h.radius) for h in pile.helices),
        )
    ]
    high = (tip + upper) * flat + 0.3 * tilt * reach
    return Frame(-reach, reach, min(lows) - 0.08 * reach, high)


def surface_image(
    surface: PileSurface, view: View, frame: Frame, rows: int, values: np.ndarray, colours: Colours
) -> np.ndarray:
    """Return the picture (rows, columns, 4) of the pile with ``values`` (n, 3) as colours."""
    raster = rasterise(surface.corners, view, frame, OVERSAMPLING * rows)
    picture = colour(raster, values, shading(surface.corners, view, DARKEST), colours)
    return smoothed(ink(picture, feature_edges(raster, surface.part), 0.85))


def draw_image(axes: Any, picture: np.ndarray, frame: Frame) -> None:
    """Draw a picture in space without axes."""
    axes.imshow(np.clip(picture, 0.0, 1.0), extent=tuple(frame), origin="lower")
    axes.set_axis_off()
    axes.set_aspect("equal")


def tractions(pile: ScrewPile, surface: PileSurface, pose: Pose) -> Figure:
    """Return the pile surface with contact pressure and shear, from above and from below."""
    views = views_of(pile, pose.rotation)
    frames = [frame_around(pile, view, pose.advance) for view in views]
    ratio = max((f.top - f.bottom) / (f.right - f.left) for f in frames)
    figure, axes = panels(1, 4, 10.0, 2.45 * ratio + 0.8)
    for number, field in enumerate(traction_fields(surface)):
        colours, pair = mapping(field), axes[0, 2 * number : 2 * number + 2]
        for here, view, frame in zip(pair, views, frames, strict=True):
            picture = surface_image(surface, view, frame, ROWS, field.values, colours)
            draw_image(here, picture, frame)
        colour_bar(figure, ScalarMappable(field.norm, field.cmap), list(pair), field.label,
                   field.extend)  # fmt: skip
    return figure


class TractionField(NamedTuple):
    """A traction on the pile surface with the way in which it is shown."""

    values: np.ndarray
    """(n, 3) in kPa, NaN above the ground."""
    norm: Normalize
    cmap: str
    label: str
    extend: str


def traction_fields(surface: PileSurface) -> tuple[TractionField, TractionField]:
    """Return contact pressure and shear traction, the mean of each facet."""
    is_buried = surface.corners[:, :, 2].mean(axis=1) < 0.0
    pressure, shear = (
        np.where(is_buried, values.mean(axis=1) / 1e3, np.nan)[:, None].repeat(3, axis=1)
        for values in (surface.pressure, surface.shear)
    )
    known = np.clip(pressure[is_buried], *_usual_range(surface, pressure, is_buried))
    is_signed = known.min() < 0.0
    return (
        TractionField(
            pressure,
            symmetric_norm(known) if is_signed else positive_norm(known),
            DIVERGING if is_signed else INTENSITY,
            "contact pressure (kPa)",
            "both" if is_signed else "max",
        ),
        TractionField(
            shear, positive_norm(shear[is_buried]), SEQUENTIAL, "shear traction (kPa)", "max"
        ),
    )


def _usual_range(
    surface: PileSurface, values: np.ndarray, selected: np.ndarray
) -> tuple[float, float]:
    """Return the range of values (n, 3) of the ``selected`` facets without the unusual ones.

    Shares are those of the area: the many small facets at the edges count little.
    """
    corners = surface.corners[selected]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.repeat(np.linalg.norm(normal, axis=1), 3)
    flat = values[selected].ravel()
    order = np.argsort(flat)
    share = np.cumsum(area[order]) / area.sum()
    low, high = np.interp((UNUSUAL, 1.0 - UNUSUAL), share, flat[order])
    return float(low), float(high)


def mapping(field: TractionField) -> Colours:
    """Return the function that gives the colours (n, 4) of values (n,), grey where one is NaN."""
    chosen = colormaps[field.cmap].with_extremes(bad=PILE)
    return lambda values: np.asarray(chosen(np.ma.masked_invalid(field.norm(values))))
