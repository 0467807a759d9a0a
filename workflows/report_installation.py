"""Pictures of the installation: mesh and points, stresses, force against depth, convergence."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from install_mpm.history import History
from install_mpm.material_points import MaterialPoints, cauchy_stress
from install_mpm.state_file import InstalledState
from workflows.case import Case
from workflows.compare import QUADRATIC_ORDER
from workflows.report_fields import (
    Window,
    colour_bar,
    draw_mesh,
    draw_pile,
    draw_points,
    finish,
    initial_position,
    nearest_index,
    picture_height,
    positive_norm,
    pressure_change,
    shear_measure,
    symmetric_norm,
    tip_window,
    window_of,
)
from workflows.report_style import (
    DIVERGING,
    INK,
    INSTALLED,
    INTENSITY,
    MUTED,
    SAND,
    SEQUENTIAL,
    WISHED,
    grid,
    panels,
)
from workflows.report_units import FORCE_UNIT

BAND = 0.5
"""Thickness of the layers that make the deformation visible, over the pile's width."""


def mesh_and_points(case: Case, installed: InstalledState) -> Figure:
    """Return background mesh and material points before and after; bands of points show strain."""
    window, mesh = window_of(case), installed.background_mesh
    before = installed._replace(
        background_mesh=mesh._replace(nodes=mesh.reference_nodes),
        material_points=installed.material_points._replace(
            position=initial_position(installed.material_points)
        ),
    )
    tips = case.pile.embedment, float(installed.pile.tip_depth)
    figure, axes = panels(1, 3, 10.0, picture_height(window, 3, 10.0))
    for here, title, part, state, tip in (
        (axes[0, 0], "before", window, before, tips[0]),
        (axes[0, 1], "after", window, installed, tips[1]),
        (axes[0, 2], "after, beside the tip", tip_window(case), installed, tips[1]),
    ):
        size = 2.0 * (window.right / part.right) ** 2
        draw_bands(here, case, state, initial_position(installed.material_points)[:, 1], size)
        draw_pile(here, case.pile.half_width, tip, part)
        finish(here, part, title, with_height=here is not axes[0, 1])
    return figure


def draw_bands(
    axes: Any, case: Case, state: InstalledState, initial_height: np.ndarray, size: float = 2.0
) -> None:
    """Draw mesh and points of ``state``, coloured in bands of ``initial_height`` (n,)."""
    draw_mesh(axes, state.background_mesh.nodes, state.background_mesh.cell_nodes[:, :3])
    band = np.floor(-initial_height / (BAND * case.pile.width)) % 2.0
    dots = axes.scatter(
        *state.material_points.position.T,
        c=np.where(band, WISHED, SAND),
        s=size,
        linewidths=0.0,
    )
    dots.set_rasterized(True)


def stresses(case: Case, installed: InstalledState) -> Figure:
    """Return pressure change, mobilised strength and displacement at the material points."""
    window, points = window_of(case), installed.material_points
    stress = cauchy_stress(points)
    pressure = pressure_change(case.ground, stress, points.position[:, 1])
    shear = shear_measure(case.ground, stress, points.material, points.state_variables)
    distance = 1e3 * np.linalg.norm(points.displacement, axis=1)
    index, near = nearest_index(points, case, window), is_inside(points, window)
    shear_norm = Normalize(0.0, shear.limit) if shear.limit else positive_norm(shear.values[near])
    figure, axes = panels(1, 3, 10.0, picture_height(window, 3, 10.0) + 0.6)
    for column, (values, norm, cmap, label, extend) in enumerate(
        (
            (pressure, symmetric_norm(pressure[near]), DIVERGING, "change of mean pressure (kPa)",
             "both"),
            (shear.values, shear_norm, SEQUENTIAL, shear.label, "neither"),
            (distance, positive_norm(distance[near]), INTENSITY, "displacement (mm)", "max"),
        )
    ):  # fmt: skip
        here = axes[0, column]
        drawn = draw_points(here, index, values, window, norm, cmap)
        draw_pile(here, case.pile.half_width, float(installed.pile.tip_depth), window)
        finish(here, window, "", with_height=column == 0)
        colour_bar(figure, drawn, here, label, extend)
    return figure


def is_inside(points: MaterialPoints, window: Window) -> np.ndarray:
    """Return which material points (n,) lie in the window."""
    x, z = points.position.T
    inside: np.ndarray = (x < window.right) & (z > window.bottom)
    return inside


def force_against_depth(case: Case, history: History) -> Figure:
    """Return the installation force and its share of base and shaft against penetration."""
    figure, axes = panels(1, 1, 6.2, 4.2)
    here = axes[0, 0]
    penetration = 1e3 * history.penetration
    for force, colour, label in (
        (history.crowd_force, INK, "installation force\n(base + shaft − weight)"),
        (history.base_force, INSTALLED, "base"),
        (history.shaft_force, WISHED, "shaft"),
    ):
        here.plot(force / 1e3, penetration, color=colour, label=label)
    here.set_ylim(float(penetration[-1]), 0.0)
    here.set_xlim(left=min(0.0, float(history.crowd_force.min()) / 1e3))
    here.set_xlabel(f"force on the whole pile ({FORCE_UNIT[case.kinematics]})")
    here.set_ylabel("penetration (mm)")
    depth = here.twinx()
    start = case.pile.embedment
    depth.set_ylim(start + here.get_ylim()[0] / 1e3, start)
    depth.set_ylabel("tip depth (m)")
    depth.spines["right"].set_visible(True)
    grid(here)
    here.legend(loc="upper left", bbox_to_anchor=(1.14, 1.0))
    return figure


def convergence(history: History) -> Figure:
    """Return residuals of all steps, orders of convergence, and iterations against penetration."""
    figure, axes = panels(1, 3, 10.0, 3.2, width_ratios=(1.25, 1.0, 1.25))
    draw_residuals(axes[0, 0], history.residual_history)
    draw_orders(axes[0, 1], history.convergence_order)
    here = axes[0, 2]
    here.step(
        1e3 * history.penetration, history.iterations, where="mid", color=INK, label="iterations"
    )
    here.step(
        1e3 * history.penetration, history.cuts, where="mid", color=INSTALLED, label="halvings"
    )
    here.set(xlabel="penetration (mm)", ylabel="per step", title="iterations and halvings")
    here.set_ylim(bottom=0.0)
    here.legend()
    grid(here)
    return figure


def draw_residuals(axes: Any, residual_history: np.ndarray) -> None:
    """Draw the residuals (n_steps, n_iterations, NaN-padded) of all steps over one another."""
    for residuals in residual_history:
        known = residuals[np.isfinite(residuals) & (residuals > 0.0)]
        axes.semilogy(known, color=INSTALLED, alpha=0.35, linewidth=0.8)
    axes.set(
        xlabel="iteration", ylabel="out-of-balance force / forces", title="residuals, all steps"
    )
    grid(axes)


def draw_orders(axes: Any, order: np.ndarray) -> None:
    """Draw how many steps ended with which order of convergence."""
    known = np.clip(order[np.isfinite(order)], 0.0, 4.0)
    axes.hist(known, bins=np.arange(0.0, 4.1, 0.2), color=WISHED)
    axes.axvline(QUADRATIC_ORDER, color=INSTALLED, linewidth=1.0, linestyle="--")
    axes.set(xlabel="order of the last iterations", ylabel="steps", title="order of convergence")
    grid(axes, "y")


def irregularities(history: History) -> Figure:
    """Return what was irregular in each step: cells and points, and the shape of the worst cell."""
    figure, axes = panels(1, 3, 10.0, 2.6)
    penetration = 1e3 * history.penetration
    rows = (
        ("cells", ((history.partly_filled_cells, "partly filled", WISHED),
                   (history.empty_cells, "empty beside filled", INSTALLED))),
        ("points", ((history.injected_points, "made by splitting", WISHED),
                    (history.empty_integration_points, "integration points without", INSTALLED),
                    (history.projected_points, "brought back into the mesh", MUTED))),
        ("$2\\, r_{in} / r_{out}$", ((history.smallest_cell_quality, "worst cell", INK),)),
    )  # fmt: skip
    for here, (label, series) in zip(axes[0], rows, strict=True):
        for values, name, colour in series:
            here.step(penetration, values, where="mid", color=colour, label=name, linewidth=1.2)
        here.set(xlabel="penetration (mm)", ylabel=label)
        here.set_ylim(
            0.0, 1.7 * max(1e-9, *(float(values.max()) for values, _, _ in series)) + 0.02
        )
        here.legend(loc="upper right")
        grid(here)
    return figure
