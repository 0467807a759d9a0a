"""Pictures of the paper's demonstrations, drawn like the figures that they stand for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.material_points import MaterialPoints
from workflows.report_style import INK, INSTALLED, MUTED, WISHED, grid, panels
from workflows.verification.penetration import Penetration, PenetrationResult

COLOURS = "jet"
"""The paper's own colour map, so that the pictures can be laid side by side."""

BODY, FOLLOWS, ABOVE = "pink", "red", "blue"
"""Colours of body, stretched and compressed mesh in the paper's Fig. 3."""

State = tuple[MaterialPoints, BackgroundMesh]


def draw_mesh(axes: Any, mesh: BackgroundMesh, shift: float = 0.0, **style: Any) -> None:
    """Draw the edges of the cells, ``shift`` m higher."""
    cells = mesh.nodes[mesh.cell_nodes[:, :3]] + [0.0, shift]
    options = {"facecolors": "none", "edgecolors": MUTED, "linewidths": 0.3} | style
    axes.add_collection(PolyCollection(cells, **options))


# --- Figs 6 and 8: the pile -----------------------------------------------------------------------


def draw_pile_state(axes: Any, problem: Penetration, state: State, tip_depth: float) -> Any:
    """Draw mesh, pile and material points by vertical displacement; heights from the bottom."""
    points, mesh = state
    draw_mesh(axes, mesh, problem.depth)
    axes.add_patch(
        Rectangle((0.0, problem.depth - tip_depth), problem.half_width, tip_depth, color="black")
    )
    drawn = axes.scatter(
        points.position[:, 0],
        points.position[:, 1] + problem.depth,
        c=points.displacement[:, 1],
        s=2.0,
        cmap=COLOURS,
        vmin=-problem.steps * problem.step,
        vmax=0.0,
        linewidths=0,
    )
    axes.set(
        xlim=(0.0, problem.width),
        ylim=(0.0, problem.depth + problem.headroom),
        aspect="equal",
        xlabel="x (m)",
    )
    return drawn


def pile_states(runs: Sequence[tuple[str, Penetration, PenetrationResult]]) -> Figure:
    """Return the figure of the initial state of the first run and the final states of all."""
    columns = len(runs) + 1
    figure, axes = panels(1, columns, 2.1 * columns + 0.9, 5.6, sharey=True)
    row = list(axes[0])
    _, problem, result = runs[0]
    draw_pile_state(row[0], problem, result.start, problem.embedment)
    row[0].set(title="initial", ylabel="y (m)")
    for place, (title, problem, result) in zip(row[1:], runs, strict=True):
        depth = problem.embedment + result.penetration[-1]
        state = result.body.points, result.body.mesh
        drawn = draw_pile_state(place, problem, state, depth)
        place.set_title(title)
    figure.colorbar(drawn, ax=row, label="vertical displacement (m)", shrink=0.7)
    return figure


# --- Fig 3: the stretched body --------------------------------------------------------------------


def stretched_states(states: Sequence[tuple[str, State, float]]) -> Figure:
    """Return the figure of a body and the meshes below and above its top, at the given heights."""
    figure, axes = panels(1, len(states), 2.4 * len(states), 4.2, sharey=True)
    for place, (title, (points, mesh), top) in zip(axes[0], states, strict=True):
        height = mesh.nodes[mesh.cell_nodes[:, :3], 1].mean(axis=1)
        width = mesh.nodes[:, 0].max()
        place.add_patch(Rectangle((0.0, 0.0), width, top, color=BODY, linewidth=0.0))
        for colour, chosen in ((FOLLOWS, height < top), (ABOVE, height > top)):
            part = mesh._replace(cell_nodes=mesh.cell_nodes[chosen])
            draw_mesh(place, part, edgecolors=colour, linewidths=0.9)
        place.scatter(*points.position.T, s=3.0, color=INK, linewidths=0)
        place.set(
            title=title, aspect="equal", xlabel="x (m)",
            xlim=(-0.1 * width, 1.1 * width), ylim=(0.0, 1.02 * mesh.nodes[:, 1].max()),
        )  # fmt: skip
    axes[0, 0].set_ylabel("y (m)")
    return figure


# --- Figs 4 and 7: the ellipse --------------------------------------------------------------------


def turned_states(states: Sequence[tuple[str, State, np.ndarray]]) -> Figure:
    """Return the figure of rotations: mesh, body (corners (n, 2) in m) and material points.

    Points are coloured by their horizontal displacement, where they have moved.
    """
    figure, axes = panels(1, len(states), 3.4 * len(states) + 0.8, 3.6, sharey=True)
    largest = max(np.abs(points.displacement[:, 0]).max() for _, (points, _), _ in states)
    for place, (title, (points, mesh), corners) in zip(axes[0], states, strict=True):
        draw_mesh(place, mesh)
        place.add_patch(Polygon(corners, color="black"))
        is_moved = points.displacement.any()
        style = {"c": points.displacement[:, 0]} if is_moved else {"color": INSTALLED}
        scale = {"cmap": COLOURS, "vmin": -largest, "vmax": largest} if is_moved else {}
        drawn = place.scatter(*points.position.T, s=1.5, linewidths=0, **style, **scale)
        radius = np.abs(mesh.nodes).max()
        limits = (-1.02 * radius, 1.02 * radius)
        place.set(title=title, aspect="equal", xlabel="x (m)", xlim=limits, ylim=limits)
    axes[0, 0].set_ylabel("y (m)")
    figure.colorbar(drawn, ax=list(axes[0]), label="horizontal displacement (m)", shrink=0.8)
    return figure


# --- Fig 9: two blocks ----------------------------------------------------------------------------


def sheared_blocks(lower: float, slip: float, top: float, curve: np.ndarray) -> Figure:
    """Return the figure of two unit blocks before and after, and of their force.

    ``lower`` is the displacement of the top of the lower block, ``slip`` that between the blocks
    and ``top`` that of the top of the upper one, in m; ``curve`` (n, 2) has displacement in m and
    force in N.
    """
    figure, axes = panels(1, 3, 9.0, 3.0, width_ratios=(1.0, 1.0, 1.5))
    for place, title, moves in zip(
        axes[0, :2], ("(a) initial", "(b) deformed"), ((0.0,) * 3, (lower, slip, top)), strict=True
    ):
        bottom, jump, upper = moves
        for base, ends, colour in (
            (0.0, (0.0, bottom), INSTALLED), (1.0, (bottom + jump, upper), WISHED)
        ):  # fmt: skip
            corners = [(ends[0], base), (1 + ends[0], base), (1 + ends[1], base + 1),
                       (ends[1], base + 1)]  # fmt: skip
            place.add_patch(Polygon(corners, facecolor=colour, alpha=0.35, edgecolor=colour))
        place.set(title=title, aspect="equal", xlim=(-0.1, 1.2 + top), ylim=(-0.1, 2.1),
                  xlabel="x (m)", ylabel="y (m)")  # fmt: skip
    place = axes[0, 2]
    place.plot(*np.vstack([[0.0, 0.0], curve]).T, "o-", color=INK, markersize=3.0)
    place.set(title="(c) reaction", xlabel="displacement (m)", ylabel="force (N/m)")
    place.set_ylim(bottom=0.0)
    grid(place)
    return figure
