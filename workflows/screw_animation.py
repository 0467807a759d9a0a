"""A short animation of a screw pile installation, made from its stored frames."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from PIL import Image

from install_mpm.screw_history import ScrewHistory
from install_mpm.screw_programme import Pose
from workflows.report_fields import colour_bar, positive_norm, symmetric_norm
from workflows.report_style import DIVERGING, INK, INTENSITY, panels, styled
from workflows.screw_case import ScrewCase
from workflows.screw_export import read_points, read_surface, stored_frames
from workflows.screw_frames import PointCloud
from workflows.screw_slices import (
    Slice,
    draw_slice,
    mean_pressure_change,
    soil_pixels,
    vertical_slice,
)
from workflows.screw_surface_pictures import (
    TractionField,
    draw_image,
    frame_around,
    mapping,
    surface_image,
    traction_fields,
    views_of,
)
from workflows.screw_view import Frame, View

MOST_FRAMES = 32
MOST_BYTES = 3_000_000
COLOURS = 256
"""Colours of a picture."""

DURATION, LAST_DURATION = 110, 1600
"""Of a picture and of the last one, in ms."""

PIXELS = 360
"""Across the slice."""

RESOLUTION = 100
"""Dots per inch."""


class Look(NamedTuple):
    """What all pictures of an animation have in common."""

    plane: Slice
    view: View
    frame: Frame
    displacement: Normalize
    pressure: Normalize
    field: TractionField
    """Of the last picture; the others have its colours."""


def animation(directory: Path, case: ScrewCase, history: ScrewHistory) -> bytes | None:
    """Return the animation as GIF; None if fewer than two frames are stored in ``directory``.

    It has at most ``MOST_FRAMES`` pictures, and fewer if it were larger than ``MOST_BYTES``.
    """
    stored = [number for number in stored_frames(directory) if number < len(history.travel)]
    if len(stored) < 2:
        return None
    chosen = np.unique(np.linspace(0, len(stored) - 1, min(len(stored), MOST_FRAMES)).round())
    look = _look(directory, case, history, stored[-1])
    with styled():
        pictures = [_picture(directory, case, history, stored[int(k)], look) for k in chosen]
    gif = _gif(pictures)
    while len(gif) > MOST_BYTES and len(pictures) > 2:
        pictures = [*pictures[:-1:2], pictures[-1]]
        gif = _gif(pictures)
    return gif


def _pose(history: ScrewHistory, number: int) -> Pose:
    return Pose(float(history.penetration[number]), float(history.rotation[number]))


def _look(directory: Path, case: ScrewCase, history: ScrewHistory, last: int) -> Look:
    """Return planes, views and colours that hold from the first to the last picture."""
    pile, deepest = case.pile, float(history.penetration.max())
    plane = vertical_slice(
        pile, pile.embedment + deepest, case.box.headroom, case.box.width, PIXELS
    )
    view, _ = views_of(pile, 0.0)
    upper, lower = (
        frame_around(pile, view, advance) for advance in (float(history.penetration.min()), deepest)
    )
    cloud = read_points(directory, last)
    soil = soil_pixels(plane, cloud, pile, _pose(history, last))
    seen = np.unique(soil.index[soil.index >= 0])
    return Look(
        plane,
        view,
        upper._replace(bottom=lower.bottom),
        positive_norm(1e3 * np.linalg.norm(cloud.displacement[seen], axis=1)),
        symmetric_norm(mean_pressure_change(case.ground, cloud)[seen]),
        traction_fields(read_surface(directory, last))[0],
    )


def _picture(
    directory: Path, case: ScrewCase, history: ScrewHistory, number: int, look: Look
) -> Image.Image:
    """Return the picture of one stored frame."""
    cloud, surface = read_points(directory, number), read_surface(directory, number)
    pose = _pose(history, number)
    figure, axes = panels(1, 3, 10.4, 4.3, width_ratios=(1.0, 1.0, 0.62))
    figure.set_facecolor("white")
    _draw_slices(figure, axes[0, :2], case, cloud, pose, look)
    here = axes[0, 2]
    field = look.field._replace(values=traction_fields(surface)[0].values)
    rows = round(1.2 * PIXELS)
    image = surface_image(surface, look.view, look.frame, rows, field.values, mapping(field))
    draw_image(here, image, look.frame)
    colour_bar(figure, ScalarMappable(field.norm, field.cmap), here, field.label, field.extend)
    turned = abs(pose.rotation) / (2.0 * np.pi)
    figure.suptitle(
        f"{turned:.2f} turns    tip at {case.pile.embedment + pose.advance:.2f} m    "
        f"torque {history.torque[number] / 1e3:.1f} kN m    "
        f"crowd force {history.crowd_force[number] / 1e3:.1f} kN",
        fontsize=9.5, x=0.02, ha="left",
    )  # fmt: skip
    return _drawn(figure)


def _draw_slices(
    figure: Figure, axes: Any, case: ScrewCase, cloud: PointCloud, pose: Pose, look: Look
) -> None:
    """Draw displacement and change of mean pressure in the vertical slice."""
    soil = soil_pixels(look.plane, cloud, case.pile, pose)
    distance = 1e3 * np.linalg.norm(cloud.displacement, axis=1)
    pressure = mean_pressure_change(case.ground, cloud)
    left, right, _, _ = look.plane.extent
    for here, values, norm, cmap, label, extend in (
        (axes[0], distance, look.displacement, INTENSITY, "displacement (mm)", "max"),
        (axes[1], pressure, look.pressure, DIVERGING, "change of mean pressure (kPa)", "both"),
    ):
        drawn = draw_slice(here, look.plane, soil, values, norm, cmap)
        here.plot([left, right], [0.0, 0.0], color=INK, linewidth=0.7, dashes=(6, 4))
        colour_bar(figure, drawn, here, label, extend)
    axes[1].tick_params(labelleft=False)


def _drawn(figure: Figure) -> Image.Image:
    """Return a figure as an image without transparency."""
    canvas = FigureCanvasAgg(figure)
    figure.set_dpi(RESOLUTION)
    canvas.draw()
    return Image.fromarray(np.asarray(canvas.buffer_rgba())[:, :, :3].copy())


def _gif(pictures: list[Image.Image]) -> bytes:
    """Return pictures as a GIF that repeats, each with colours of its own."""
    frames = [picture.quantize(COLOURS, dither=Image.Dither.NONE) for picture in pictures]
    buffer = io.BytesIO()
    frames[0].save(
        buffer, format="GIF", save_all=True, append_images=frames[1:], loop=0, optimize=True,
        duration=[*[DURATION] * (len(frames) - 1), LAST_DURATION],
    )  # fmt: skip
    return buffer.getvalue()
