"""Curves of the report that tell their values under the mouse."""

from __future__ import annotations

import numpy as np
import plotly.graph_objects as go

from install_mpm.history import History
from install_mpm.screw_history import ScrewHistory
from service_fe.results import ProgrammeResult, ServiceResult
from workflows.case import Case
from workflows.interactive import line, panels
from workflows.report_service import capacity_marks, title_of
from workflows.report_style import INK, INSTALLED, MODEL_COLOURS, MODEL_NAMES, WISHED
from workflows.report_units import FORCE_UNIT
from workflows.screw_case import ScrewCase
from workflows.screw_report_curves import turns

SYMBOLS = {"o": "circle", "x": "x-thin-open"}
"""Names that plotly has for the marks of the still pictures."""

COLUMNS = 2
"""Panels beside each other."""


def force_against_depth(case: Case, history: History) -> go.Figure:
    """Return the installation force and its share of base and shaft against penetration."""
    plot, unit = panels(1, 1), FORCE_UNIT[case.kinematics]
    penetration = 1e3 * history.penetration
    hover = f"%{{x:.4g}} {unit}<br>%{{y:.4g}} mm penetration"
    for force, colour, name in (
        (history.crowd_force, INK, "installation force (base + shaft - weight)"),
        (history.base_force, INSTALLED, "base"),
        (history.shaft_force, WISHED, "shaft"),
    ):
        plot.add_trace(line(force / 1e3, penetration, name, colour, hover))
    plot.update_xaxes(title_text=f"force on the whole pile ({unit})", rangemode="tozero")
    plot.update_yaxes(title_text="penetration (mm)", autorange="reversed")
    return plot


def service_curves(case: Case, service: ServiceResult, wished: ServiceResult) -> go.Figure:
    """Return head load against displacement of every programme, installed and wished in place."""
    unit, width = FORCE_UNIT[case.kinematics], case.pile.width
    rows = -(-len(service.programmes) // COLUMNS)
    plot = panels(rows, COLUMNS, [title_of(result) for result in service.programmes])
    hover = f"%{{x:.4g}} mm<br>%{{y:.4g}} {unit}"
    for number, result in enumerate(service.programmes):
        place = {"row": number // COLUMNS + 1, "col": number % COLUMNS + 1}
        for model in (service, wished):
            here = model.programme(result.programme.name)
            traces = [_curve(here, model.model, hover), _marks(here, model.model, width, hover)]
            traces[0].showlegend = number == 0
            plot.add_traces(traces, rows=place["row"], cols=place["col"])
        plot.update_xaxes(title_text="displacement, downward (mm)", **place)
        plot.update_yaxes(title_text=f"head load ({unit})", **place)
    return plot


def _curve(result: ProgrammeResult, model: str, hover: str) -> go.Scatter:
    curve = result.curve
    return line(
        1e3 * curve.displacement, curve.head_load / 1e3, MODEL_NAMES[model], MODEL_COLOURS[model],
        hover, mode="lines+markers", legendgroup=model,
    )  # fmt: skip


def _marks(result: ProgrammeResult, model: str, width: float, hover: str) -> go.Scatter:
    """Return the capacities of a curve as marks."""
    marks = capacity_marks(result, width)
    drawn = line(
        np.array([1e3 * mark.displacement for mark in marks]),
        np.array([mark.head_load / 1e3 for mark in marks]),
        f"{MODEL_NAMES[model]}, capacity", MODEL_COLOURS[model], hover, mode="markers",
        legendgroup=model, showlegend=False,
    )  # fmt: skip
    drawn.marker = {"size": 11, "symbol": [SYMBOLS[mark.symbol] for mark in marks]}
    return drawn


def torque_and_force(case: ScrewCase, history: ScrewHistory) -> go.Figure:
    """Return torque and crowd force of a screw pile against the depth of its tip.

    Dotted: the rig lets go.
    """
    plot = panels(1, 2)
    depth = case.pile.embedment + history.penetration
    is_driven = history.release_share == 0.0
    n = int(is_driven.sum())
    turned = np.asarray(turns(case.pile, history))
    for column, (values, colour, name, unit) in enumerate(
        (
            (history.torque / 1e3, INSTALLED, "torque", "kN m"),
            (history.crowd_force / 1e3, WISHED, "crowd force, downward", "kN"),
        ),
        start=1,
    ):
        hover = f"%{{x:.4g}} {unit}<br>tip at %{{y:.4g}} m<br>%{{customdata:.3f}} turns"
        for part, label, dash in (
            (slice(0, n), name, "solid"),
            (slice(n - 1, None), f"{name}, rig lets go", "dot"),
        ):
            drawn = line(
                values[part], depth[part], label, colour, hover,
                dash=dash, customdata=turned[part],
            )  # fmt: skip
            plot.add_trace(drawn, row=1, col=column)
        plot.update_xaxes(title_text=f"{name} ({unit})", row=1, col=column)
        plot.update_yaxes(
            title_text="depth of the tip (m)", autorange="reversed", row=1, col=column
        )
    return plot
