"""Curves of a screw pile installation: torque, crowd force, their parts, work and side forces."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from install_mpm.screw_history import ScrewHistory
from install_mpm.screw_pile import ScrewPile
from workflows.report_installation import draw_orders, draw_residuals
from workflows.report_style import INK, INSTALLED, MUTED, SAND, WISHED, grid, panels
from workflows.screw_case import ScrewCase
from workflows.screw_theory import PartTorque, totals_by_kind

KIND_COLOURS = {
    "tip": "#5f6b76", "cone": "#5f6b76", "shaft": "#a9b4bd",
    "lower face": "#c8553d", "upper face": "#e39a82", "rim": "#c79a2b",
    "leading edge": "#3d7ea6", "trailing edge": "#9cc3da",
}  # fmt: skip

SMALL = 0.002
"""Share of the largest torque below which a kind of part is left out of a picture."""


def turns(pile: ScrewPile, history: ScrewHistory) -> np.ndarray:
    """Return the rotation (n_steps,) in turns, positive in the sense that drives the pile down."""
    turned: np.ndarray = -pile.sense * history.rotation / (2.0 * np.pi)
    return turned


def abscissa(pile: ScrewPile, history: ScrewHistory) -> tuple[np.ndarray, str]:
    """Return what curves of all steps are drawn over: turns, for a pile that turns, else travel."""
    turned = turns(pile, history)
    if len(turned) > 1 and (np.diff(turned) > 0.0).all():
        return turned, "rotation (turns)"
    return history.travel, "travel of the rim (m)"


def torque_and_force(case: ScrewCase, history: ScrewHistory) -> Figure:
    """Return torque and crowd force against the depth of the tip, and against rotation.

    Dotted: the rig lets go.
    """
    figure, axes = panels(2, 2, 10.0, 6.0, height_ratios=(1.35, 1.0))
    depth, turned = case.pile.embedment + history.penetration, turns(case.pile, history)
    n = int((history.release_share == 0.0).sum())
    for column, (values, colour, label) in enumerate(
        (
            (history.torque / 1e3, INSTALLED, "torque (kN m)"),
            (history.crowd_force / 1e3, WISHED, "crowd force, downward (kN)"),
        )
    ):
        upper, lower = axes[:, column]
        for here, x, y in ((upper, values, depth), (lower, turned, values)):
            here.plot(x[:n], y[:n], color=colour)
            here.plot(x[n - 1], y[n - 1], "o", color=colour, markersize=4.0)
            here.plot(x[n - 1 :], y[n - 1 :], ":", color=colour, linewidth=1.1)
            grid(here)
        upper.set_ylim(*_padded(depth)[::-1])
        upper.set(xlabel=label, ylabel="depth of the tip (m)")
        lower.set(xlabel="rotation (turns)", ylabel=label)
        upper.axvline(0.0, color=MUTED, linewidth=0.8)
        lower.axhline(0.0, color=MUTED, linewidth=0.8)
    return figure


def _padded(values: np.ndarray) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    margin = 0.03 * (high - low) or 0.01
    return low - margin, high + margin


def torque_by_part(pile: ScrewPile, history: ScrewHistory, parts: list[PartTorque]) -> Figure:
    """Return the torque of the parts, stacked over all steps, and beside the closed forms."""
    figure, axes = panels(1, 3, 10.0, 3.9, width_ratios=(1.0, 1.0, 1.1))
    along, label = abscissa(pile, history)
    tangential = totals_by_kind(pile, history.part_torque - history.part_normal_torque)
    normal = totals_by_kind(pile, history.part_normal_torque)
    largest = float(np.abs(history.torque).max())
    shown = [
        kind
        for kind in tangential
        if max(np.abs(tangential[kind]).max(), np.abs(normal[kind]).max()) > SMALL * largest
    ]
    for here, values, title in (
        (axes[0, 0], tangential, "from traction along the surface"),
        (axes[0, 1], normal, "from normal traction"),
    ):
        _stack(here, along, {kind: values[kind] / 1e3 for kind in shown})
        here.set(xlabel=label, title=title, xlim=(float(along[0]), float(along[-1])))
    axes[0, 0].set_ylabel("torque (kN m)")
    axes[0, 1].sharey(axes[0, 0])
    forms = [part.closed_form for part in parts if part.closed_form is not None]
    if forms:
        axes[0, 0].axhline(sum(forms) / 1e3, color=INK, linestyle="--", linewidth=1.1,
                           label="closed forms, last step")  # fmt: skip
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=5)
    _draw_bars(axes[0, 2], parts)
    return figure


def _stack(axes: Any, along: np.ndarray, values: dict[str, np.ndarray]) -> None:
    """Draw series stacked over one another, positive ones upward and negative ones downward."""
    above, below = np.zeros(len(along)), np.zeros(len(along))
    for kind, series in values.items():
        up, down = above + np.maximum(series, 0.0), below + np.minimum(series, 0.0)
        colour = KIND_COLOURS[kind]
        axes.fill_between(along, above, up, color=colour, label=kind, linewidth=0.0)
        axes.fill_between(along, below, down, color=colour, linewidth=0.0)
        above, below = up, down
    axes.plot(along, above + below, color=INK, linewidth=1.0)
    axes.axhline(0.0, color=INK, linewidth=0.7)
    grid(axes, "y")


def _draw_bars(axes: Any, parts: list[PartTorque]) -> None:
    """Draw the torque of each part at the end, its two shares, and the closed form of one."""
    place = np.arange(len(parts))[::-1]
    along = np.array([part.tangential for part in parts]) / 1e3
    across = np.array([part.normal for part in parts]) / 1e3
    axes.barh(place + 0.19, along, 0.36, color=INSTALLED, label="along the surface")
    axes.barh(place - 0.19, across, 0.36, color=WISHED, label="normal")
    form = [
        (row + 0.19, part.closed_form / 1e3)
        for row, part in zip(place, parts, strict=True)
        if part.closed_form is not None
    ]
    if form:
        rows, values = np.array(form).T
        axes.plot(values, rows, "|", color=INK, markersize=13.0, markeredgewidth=1.8,
                  label="closed form")  # fmt: skip
    axes.set_yticks(place, [part.name for part in parts])
    axes.set(xlabel="torque (kN m)", title="at the end, part by part")
    axes.axvline(0.0, color=INK, linewidth=0.7)
    axes.legend(loc="lower right", fontsize=7.5).set_gid("bar_legend")  # ids are unique in a page
    grid(axes, "x")


def balance_error(history: ScrewHistory) -> np.ndarray:
    """Return the error of the power balance of each step over the work of the rig in it, (n,)."""
    taken = history.interface_work + history.soil_work - history.weight_work
    largest = np.maximum(np.abs(history.rig_work), np.abs(history.interface_work))
    error: np.ndarray = np.abs(history.rig_work - taken) / np.where(largest > 0.0, largest, np.inf)
    return error


def work(pile: ScrewPile, history: ScrewHistory) -> Figure:
    """Return the work of rig, interface, soil and weight since the start, and the error of it."""
    figure, axes = panels(1, 2, 10.0, 3.4, width_ratios=(1.3, 1.0))
    along, label = abscissa(pile, history)
    here = axes[0, 0]
    for values, colour, name, style in (
        (history.rig_work, INK, "rig: torque and vertical force", "-"),
        (history.interface_work, INSTALLED, "slip on the pile surface", "-"),
        (history.soil_work, WISHED, "deformation of the soil", "-"),
        (-history.weight_work, SAND, "lifting the soil", "-"),
        (history.interface_work + history.soil_work - history.weight_work, MUTED,
         "sum of the three", ":"),
    ):  # fmt: skip
        here.plot(along, np.cumsum(values) / 1e3, style, color=colour, label=name)
    here.set(xlabel=label, ylabel="work (kJ)", title="work since the start")
    here.legend()
    error = balance_error(history)
    there = axes[0, 1]
    there.semilogy(along[error > 0.0], error[error > 0.0], color=INSTALLED, linewidth=1.1)
    there.set(
        xlabel=label, ylabel="error / work of the rig", title="error of the balance, each step"
    )
    for each in (here, there):
        grid(each)
    return figure


def side_forces(pile: ScrewPile, history: ScrewHistory) -> Figure:
    """Return the horizontal force and the moment about the horizontal axes on the pile."""
    figure, axes = panels(1, 2, 10.0, 2.9)
    along, label = abscissa(pile, history)
    for here, values, name in (
        (axes[0, 0], history.lateral_force, "lateral force (kN)"),
        (axes[0, 1], history.overturning_moment, "overturning moment (kN m)"),
    ):
        here.plot(along, values[:, 0] / 1e3, color=INSTALLED, label="x", linewidth=1.2)
        here.plot(along, values[:, 1] / 1e3, color=WISHED, label="y", linewidth=1.2)
        size = np.linalg.norm(values, axis=1) / 1e3
        here.plot(along, size, color=INK, label="magnitude", linewidth=1.2, linestyle="--")
        here.axhline(0.0, color=MUTED, linewidth=0.8)
        here.set(xlabel=label, ylabel=name)
        here.legend(ncols=3)
        grid(here)
    return figure


def convergence(pile: ScrewPile, history: ScrewHistory) -> Figure:
    """Return residuals of all steps, orders of convergence, iterations and halvings."""
    figure, axes = panels(1, 3, 10.0, 3.2, width_ratios=(1.25, 1.0, 1.25))
    draw_residuals(axes[0, 0], history.residual_history)
    draw_orders(axes[0, 1], history.convergence_order)
    along, label = abscissa(pile, history)
    series = (
        (history.iterations, "iterations", INK),
        (history.cuts, "halvings", INSTALLED),
    )
    _steps(axes[0, 2], along, series)
    axes[0, 2].set(xlabel=label, ylabel="per step", title="iterations and halvings")
    return figure


def irregularities(pile: ScrewPile, history: ScrewHistory) -> Figure:
    """Return what was irregular in each step: cells, points, volume ratio, shape of the cells."""
    figure, axes = panels(2, 2, 10.0, 4.6, sharex=True)
    along, label = abscissa(pile, history)
    _steps(axes[0, 0], along, (
        (history.partly_filled_cells, "partly filled", WISHED),
        (history.empty_cells, "empty beside filled", INSTALLED),
    ))  # fmt: skip
    _steps(axes[0, 1], along, (
        (history.injected_points, "made by splitting", WISHED),
        (history.merged_points, "merged", SAND),
        (history.projected_points, "brought back into the mesh", INSTALLED),
        (history.empty_integration_points, "integration points without", MUTED),
    ))  # fmt: skip
    here = axes[1, 0]
    here.fill_between(along, history.smallest_volume_ratio, history.largest_volume_ratio,
                      color=WISHED, alpha=0.35, linewidth=0.0)  # fmt: skip
    for values in (history.smallest_volume_ratio, history.largest_volume_ratio):
        here.plot(along, values, color=WISHED, linewidth=1.1)
    here.axhline(1.0, color=INK, linewidth=0.7)
    grid(here)
    _steps(axes[1, 1], along, ((history.smallest_cell_quality, "worst cell", INK),))
    for there, name in zip(
        axes.ravel(), ("cells", "points", "volume ratio J", "$3\\, r_{in} / r_{out}$"), strict=True
    ):
        there.set_ylabel(name)
    for there in axes[1]:
        there.set_xlabel(label)
    return figure


def _steps(axes: Any, along: np.ndarray, series: tuple[tuple[np.ndarray, str, str], ...]) -> None:
    """Draw what happened in each step, from zero, with room for the legend."""
    for values, name, colour in series:
        axes.step(along, values, where="mid", color=colour, label=name, linewidth=1.2)
    highest = max(float(values.max()) for values, _, _ in series)
    axes.set_ylim(0.0, 1.6 * max(highest, 1e-9) + 0.02)
    axes.legend(loc="upper right", fontsize=7.5, ncols=2)
    grid(axes)


def far_field(case: ScrewCase, history: ScrewHistory) -> Figure:
    """Return how far the resultants on the pile are from those of supports and weight."""
    figure, axes = panels(1, 1, 6.2, 3.0)
    here = axes[0, 0]
    along, label = abscissa(case.pile, history)
    for values, colour, name in (
        (history.far_moment_mismatch, INSTALLED, "moment"),
        (history.far_force_mismatch, WISHED, "force"),
        (history.residual, MUTED, "residual of Newton's method"),
    ):
        known = values > 0.0
        here.semilogy(along[known], values[known], color=colour, label=name, linewidth=1.2)
    here.axhline(case.numerics.tolerance, color=INK, linestyle="--", linewidth=0.9,
                 label="tolerance of the case")  # fmt: skip
    here.set(xlabel=label, ylabel="mismatch, relative")
    here.legend(loc="upper left", bbox_to_anchor=(1.02, 1.0))
    grid(here)
    return figure
