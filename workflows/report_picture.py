"""One picture of a run, for the documentation.

python -m workflows.report_picture DIR FILE.png
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from install_mpm.material_points import cauchy_stress
from workflows.environment import prepare
from workflows.report_data import Results, read_results
from workflows.report_fields import (
    colour_bar,
    draw_pile,
    draw_points,
    draw_polygons,
    finish,
    initial_position,
    nearest_index,
    picture_height,
    pressure_change,
    sub_regions,
    symmetric_norm,
    window_of,
)
from workflows.report_installation import draw_bands
from workflows.report_style import (
    DIVERGING,
    MODEL_COLOURS,
    MODEL_NAMES,
    grid,
    panels,
    png_of,
    styled,
)
from workflows.report_units import FORCE_UNIT


def overview(results: Results) -> Figure:
    """Return the installed ground in both models, and what it does to the pile in service."""
    case, installed, handed_off = results.case, results.installed, results.handed_off
    window, points = window_of(case), installed.material_points
    tip_depth = float(installed.pile.tip_depth)
    places = handed_off.integration.position
    before = pressure_change(case.ground, cauchy_stress(points), points.position[:, 1])
    after = pressure_change(case.ground, handed_off.state.cauchy_stress, places[:, 1])
    norm = symmetric_norm(before[np.abs(points.position[:, 0]) < window.right])
    figure, axes = panels(
        1, 4, 13.0, picture_height(window, 4, 12.0) + 0.5, width_ratios=(1.0, 1.0, 1.0, 1.25)
    )
    draw_bands(axes[0, 0], case, installed, initial_position(points)[:, 1])
    index = nearest_index(points, case, window)
    draw_points(axes[0, 1], index, before, window, norm, DIVERGING)
    drawn = draw_polygons(axes[0, 2], sub_regions(handed_off.mesh, places), after, norm, DIVERGING)
    titles = ("installed: material points", "their stress", "handed over: finite elements")
    for column, title in enumerate(titles):
        draw_pile(axes[0, column], case.pile.half_width, tip_depth, window)
        finish(axes[0, column], window, title, with_height=column == 0)
    colour_bar(figure, drawn, axes[0, :3], "change of mean pressure (kPa)", "both")
    _draw_curves(axes[0, 3], results)
    return figure


def _draw_curves(axes: Any, results: Results) -> None:
    """Draw the programmes that start from the released pile, both models."""
    for model in (results.service, results.wished):
        label: str | None = MODEL_NAMES[model.model]
        for result in model.programmes:
            if getattr(result.programme, "start", None) == "released":
                curve = result.curve
                axes.plot(
                    1e3 * curve.displacement,
                    curve.head_load / 1e3,
                    color=MODEL_COLOURS[model.model],
                    label=label,
                )
                label = None
    unit = FORCE_UNIT[results.case.kinematics]
    axes.set(xlabel="displacement, downward (mm)", ylabel=f"head load ({unit})", title="in service")
    axes.legend(loc="upper left")
    grid(axes)


def main() -> None:
    """Write the picture of a results directory."""
    if len(sys.argv) != 3:
        sys.exit("usage: python -m workflows.report_picture DIR FILE.png")
    prepare()
    with styled():
        picture = overview(read_results(Path(sys.argv[1])))
    Path(sys.argv[2]).write_bytes(png_of(picture))


if __name__ == "__main__":
    main()
