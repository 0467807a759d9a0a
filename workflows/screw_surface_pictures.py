"""Pictures of the surface of a screw pile in space, e.g. with the tractions of the soil."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from install_mpm.screw_pile import ScrewPile
from install_mpm.screw_programme import rim_radius
from workflows.report_fields import colour_bar, positive_norm
from workflows.report_style import panels
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

ABOVE = view_from(np.radians(-50.0), np.radians(22.0))
BELOW = view_from(np.radians(-50.0), np.radians(-28.0))
"""Directions from which a pile is looked at."""

ROWS = 620
"""Pixels of the height of a picture."""

AROUND = 1.15
"""Radius of the picture of a pile over the radius of its largest plate."""

TRACTION_MAPS = ("viridis", "magma")
"""Colours of contact pressure and shear traction."""

Colours = Callable[[np.ndarray], np.ndarray]


def frame_around(pile: ScrewPile, view: View, advance: float) -> Frame:
    """Return the part of the picture plane with tip and plates, the pile centred."""
    reach = AROUND * rim_radius(pile)
    tops = [h.height + h.pitch * h.turns + h.thickness / 2.0 for h in pile.helices]
    upper = min(max([2.0 * reach, *(top + 0.7 * reach for top in tops)]), pile.embedment + reach)
    low, high = -pile.embedment - advance, -pile.embedment - advance + upper
    flat, tilt = view.up[2], abs(view.towards[2])
    return Frame(-reach, reach, low * flat - tilt * reach, high * flat + 0.3 * tilt * reach)


def surface_image(
    surface: PileSurface, view: View, frame: Frame, rows: int, values: np.ndarray, colours: Colours
) -> np.ndarray:
    """Return the picture (rows, columns, 4) of the pile with ``values`` (n, 3) as colours."""
    raster = rasterise(surface.corners, view, frame, OVERSAMPLING * rows)
    picture = colour(raster, values, shading(surface.corners, view), colours)
    return smoothed(ink(picture, feature_edges(raster, surface.part), 0.85))


def draw_image(axes: Any, picture: np.ndarray, frame: Frame) -> None:
    """Draw a picture in space without axes."""
    axes.imshow(np.clip(picture, 0.0, 1.0), extent=tuple(frame), origin="lower")
    axes.set_axis_off()
    axes.set_aspect("equal")


def tractions(pile: ScrewPile, surface: PileSurface, advance: float) -> Figure:
    """Return the pile surface with contact pressure and shear, from above and from below."""
    views = (ABOVE, BELOW)
    frames = [frame_around(pile, view, advance) for view in views]
    ratio = max((f.top - f.bottom) / (f.right - f.left) for f in frames)
    figure, axes = panels(1, 4, 10.0, 2.35 * ratio + 0.75)
    for number, (values, norm, label, extend) in enumerate(traction_values(surface)):
        colours, pair = mapping(TRACTION_MAPS[number], norm), axes[0, 2 * number : 2 * number + 2]
        for here, view, frame in zip(pair, views, frames, strict=True):
            draw_image(here, surface_image(surface, view, frame, ROWS, values, colours), frame)
        colour_bar(figure, ScalarMappable(norm, TRACTION_MAPS[number]), list(pair), label, extend)
    return figure


def traction_values(surface: PileSurface) -> list[tuple[np.ndarray, Normalize, str, str]]:
    """Return contact pressure and shear (n, 3) in kPa, each with its range and its name."""
    is_buried = surface.corners[:, :, 2].mean(axis=1) < 0.0
    pressure, shear = surface.pressure / 1e3, surface.shear / 1e3
    if not is_buried.any():
        raise ValueError("no facet of the pile surface lies in the ground")
    low, high = np.percentile(pressure[is_buried], (2.0, 98.0))
    pressure_norm = Normalize(float(low), float(max(high, low + 1e-3)))
    return [
        (pressure, pressure_norm, "contact pressure (kPa)", "both"),
        (shear, positive_norm(shear[is_buried]), "shear traction (kPa)", "max"),
    ]


def mapping(cmap: str, norm: Normalize) -> Colours:
    """Return the function that gives the colours (n, 4) of values (n,)."""
    chosen = colormaps[cmap]
    return lambda values: np.asarray(chosen(norm(values)))
