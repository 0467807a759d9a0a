"""Pictures of what cycles of load leave behind: rotation and displacement, cycle by cycle."""

from __future__ import annotations

import numpy as np
import plotly.graph_objects as go
from matplotlib.figure import Figure

from service_fe.cycles import accumulated, peaks
from service_fe.options import Cycles
from service_fe.results import ServiceResult
from workflows.interactive import line
from workflows.interactive import panels as plot_panels
from workflows.report_style import MODEL_COLOURS, MODEL_NAMES, grid, panels

QUANTITIES = (
    ("rotation", 180.0 / np.pi, "rotation", "°"),
    ("displacement", 1e3, "displacement at the load", "mm"),
)
"""Fields of ``CycleEnds``, factor to the display unit, name and unit."""


def cyclic_programmes(result: ServiceResult) -> list[str]:
    """Return the names of the programmes that load the pile in cycles."""
    return [
        entry.programme.name for entry in result.programmes if isinstance(entry.programme, Cycles)
    ]


def cycles_picture(service: ServiceResult, wished: ServiceResult, name: str) -> Figure:
    """Return rotation and displacement against the number of the cycle, of both models.

    Full lines: at the mean load, what has accumulated; thin ones: at the peaks of the load.
    """
    figure, axes = panels(1, len(QUANTITIES), 10.0, 3.4)
    for here, (field, factor, text, unit) in zip(axes[0], QUANTITIES, strict=True):
        for model in (service, wished):
            colour, label = MODEL_COLOURS[model.model], MODEL_NAMES[model.model]
            ends, *at_peaks = _values(model, name, field, factor)
            here.plot(np.arange(len(ends)), ends, ".-", color=colour, label=label)
            for values in at_peaks:
                here.plot(np.arange(1, len(ends)), values, "--", color=colour, linewidth=0.8)
        here.set(xlabel="cycle", ylabel=f"{text} ({unit})")
        grid(here)
    axes[0, 0].legend()
    return figure


def cycles_plot(service: ServiceResult, wished: ServiceResult, name: str) -> go.Figure:
    """Return the same as a plot that tells its values under the mouse."""
    plot = plot_panels(1, len(QUANTITIES))
    for column, (field, factor, text, unit) in enumerate(QUANTITIES, start=1):
        hover = f"cycle %{{x}}<br>%{{y:.4g}} {unit}"
        for model in (service, wished):
            colour, label = MODEL_COLOURS[model.model], MODEL_NAMES[model.model]
            ends, *at_peaks = _values(model, name, field, factor)
            number = np.arange(len(ends))
            first = line(number, ends, label, colour, hover, mode="lines+markers")
            first.showlegend = column == 1
            thin = [
                line(number[1:], values, f"{label}, peaks", colour, hover, dash="dash",
                     showlegend=False)
                for values in at_peaks
            ]  # fmt: skip
            plot.add_traces([first, *thin], rows=1, cols=column)
        plot.update_xaxes(title_text="cycle", row=1, col=column)
        plot.update_yaxes(title_text=f"{text} ({unit})", row=1, col=column)
    return plot


def _values(model: ServiceResult, name: str, field: str, factor: float) -> list[np.ndarray]:
    """Return a quantity at the ends of the cycles (cycle + 1,), and at both peaks (cycle,)."""
    entry = model.programme(name)
    assert isinstance(entry.programme, Cycles)
    kinds = (accumulated(entry.programme, entry.curve), *peaks(entry.programme, entry.curve))
    return [factor * np.asarray(getattr(kind, field)) for kind in kinds]
