"""Pictures of the hand-over: finite-element mesh, and stress before and after it."""

from __future__ import annotations

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from handoff.fe_state_file import HandedOffState
from install_mpm.interface import InterfacePoints
from install_mpm.material_points import cauchy_stress
from install_mpm.pile import PilePart
from install_mpm.state_file import InstalledState
from workflows.case import Case
from workflows.report_fields import (
    colour_bar,
    draw_mesh,
    draw_pile,
    draw_points,
    draw_polygons,
    finish,
    nearest_index,
    picture_height,
    pressure_change,
    sub_regions,
    symmetric_norm,
    window_of,
)
from workflows.report_style import DIVERGING, INSTALLED, PILE, WISHED, grid, panels


def stress_handed_over(case: Case, installed: InstalledState, handed_off: HandedOffState) -> Figure:
    """Return the FE mesh, and the pressure change in material points and in finite elements."""
    window, mesh, points = window_of(case), handed_off.mesh, installed.material_points
    tip_depth = float(installed.pile.tip_depth)
    before = pressure_change(case.ground, cauchy_stress(points), points.position[:, 1])
    places = handed_off.integration.position
    after = pressure_change(case.ground, handed_off.state.cauchy_stress, places[:, 1])
    is_near = (places[:, 0] < window.right) & (places[:, 1] > window.bottom)
    norm = symmetric_norm(after[is_near])
    figure, axes = panels(1, 3, 10.0, picture_height(window, 3, 10.0) + 0.5)
    axes[0, 0].add_collection(
        PolyCollection(mesh.nodes[mesh.cell_nodes[:, :3]], facecolor=PILE, alpha=0.12)
    )
    draw_mesh(axes[0, 0], mesh.nodes, mesh.cell_nodes[:, :3])
    index = nearest_index(points, case, window)
    draw_points(axes[0, 1], index, before, window, norm, DIVERGING)
    drawn = draw_polygons(axes[0, 2], sub_regions(mesh, places), after, norm, DIVERGING)
    titles = ("finite-element mesh", "material points", "finite elements, in equilibrium")
    for column, title in enumerate(titles):
        draw_pile(axes[0, column], case.pile.half_width, tip_depth, window)
        finish(axes[0, column], window, title, with_height=column == 0)
    colour_bar(figure, drawn, axes[0], "change of mean pressure (kPa)", "both")
    return figure


def tractions(installed: InstalledState, handed_off: HandedOffState) -> Figure:
    """Return the contact pressure on the base and the shear on the shaft in both models."""
    figure, axes = panels(1, 2, 10.0, 3.2)
    points, places = installed.interface, handed_off.interface
    state = handed_off.state
    for part, here, component, axis in (
        (PilePart.BASE, axes[0, 0], 1, 0),
        (PilePart.SHAFT, axes[0, 1], 0, 1),
    ):
        sign = -1e-3 if part is PilePart.BASE else 1e-3
        for place, traction, marker, colour, label in (
            (*_active(points, part, axis), ".", WISHED, "material points"),
            (
                places.position[places.part == part, axis],
                state.interface_traction[places.part == part],
                "-",
                INSTALLED,
                "finite elements",
            ),
        ):
            order = np.argsort(place)
            values = sign * traction[order, component]
            pair = (place[order], values) if axis == 0 else (values, place[order])
            here.plot(*pair, marker, color=colour, label=label, markersize=4.0, linewidth=1.1)
        grid(here)
    axes[0, 0].set(xlabel="x (m)", ylabel="contact pressure (kPa)", title="base")
    axes[0, 1].set(xlabel="downward shear on the soil (kPa)", ylabel="z (m)", title="shaft")
    axes[0, 0].set_ylim(bottom=min(0.0, axes[0, 0].get_ylim()[0]))
    axes[0, 1].set_xlim(left=min(0.0, axes[0, 1].get_xlim()[0]))
    axes[0, 0].legend()
    return figure


def _active(points: InterfacePoints, part: PilePart, axis: int) -> tuple[np.ndarray, np.ndarray]:
    """Return coordinate (n,) and traction (n, 2) of the points of ``part`` beside soil."""
    chosen = (points.part == part) & (points.covered > 0.0)
    return points.position[chosen, axis], points.traction[chosen]
