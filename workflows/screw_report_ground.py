"""Pictures of the ground around an installed screw pile: a vertical and a horizontal slice."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from install_mpm.screw_programme import Pose
from install_mpm.state_file import InstalledState
from workflows.report_fields import colour_bar, positive_norm, symmetric_norm
from workflows.report_style import DIVERGING, INK, INTENSITY, panels
from workflows.screw_case import ScrewCase
from workflows.screw_frames import point_cloud
from workflows.screw_slices import (
    Slice,
    draw_arrows,
    draw_slice,
    horizontal_slice,
    mean_pressure_change,
    plate_level,
    soil_pixels,
    vertical_slice,
)


def pose_of(installed: InstalledState) -> Pose:
    """Return where the pile is."""
    return Pose(float(installed.pile.penetration), float(installed.pile.rotation))


def vertical(case: ScrewCase, installed: InstalledState) -> Figure:
    """Return displacement and change of mean pressure in the vertical plane through the axis."""
    plane = vertical_slice(
        case.pile, float(installed.pile.tip_depth), case.box.headroom, case.box.width
    )
    left, right, bottom, top = plane.extent
    height = 4.6 * (top - bottom) / (right - left) + 1.0
    figure = _pair(case, installed, plane, height)
    figure.axes[0].set(xlabel="x (m)", ylabel="z (m)")
    figure.axes[1].set(xlabel="x (m)")
    for axes in figure.axes[:2]:
        axes.plot([left, right], [0.0, 0.0], color=INK, linewidth=0.7, dashes=(6, 4))
    return figure


def horizontal(case: ScrewCase, installed: InstalledState) -> Figure:
    """Return the same in the level plane through the middle of the lowest plate."""
    level = plate_level(case.pile, pose_of(installed))
    figure = _pair(case, installed, horizontal_slice(case.pile, level, case.box.width), 5.6)
    figure.axes[0].set(xlabel="x (m)", ylabel="y (m)")
    figure.axes[1].set(xlabel="x (m)")
    return figure


def _pair(case: ScrewCase, installed: InstalledState, plane: Slice, height: float) -> Figure:
    """Return a slice twice: with the displacement in mm, and with the change of mean pressure."""
    cloud, pose = point_cloud(installed.material_points), pose_of(installed)
    soil = soil_pixels(plane, cloud, case.pile, pose)
    seen = np.unique(soil.index[soil.index >= 0])
    distance = 1e3 * np.linalg.norm(cloud.displacement, axis=1)
    pressure = mean_pressure_change(case.ground, cloud)
    figure, axes = panels(1, 2, 10.0, height, sharey=True)
    for here, values, norm, cmap, label, extend in (
        (axes[0, 0], distance, positive_norm(distance[seen]), INTENSITY,
         "displacement (mm)", "max"),
        (axes[0, 1], pressure, symmetric_norm(pressure[seen]), DIVERGING,
         "change of mean pressure (kPa)", "both"),
    ):  # fmt: skip
        drawn = draw_slice(here, plane, soil, values, norm, cmap)
        colour_bar(figure, drawn, here, label, extend)
    draw_arrows(axes[0, 0], plane, soil, cloud.displacement)
    return figure
