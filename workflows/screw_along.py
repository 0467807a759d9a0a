"""Pictures of what a screw pile feels along its axis under a lateral load, and its p-y curves."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from service_fe.options import Lateral
from service_fe.results import AlongPile, ProgrammeResult, ServiceResult
from workflows.report_style import INK, MODEL_COLOURS, MODEL_NAMES, grid, panels

N_DEPTHS = 4
"""Levels whose p-y curves are shown."""

PROFILES = (
    ("deflection", 1e3, "deflection (mm)"),
    ("reaction", -1e-3, "p (kN/m)"),
    ("shear_force", 1e-3, "shear force (kN)"),
    ("bending_moment", 1e-3, "bending moment (kN m)"),
)
"""Fields of ``AlongPile``, factor to the display unit, and label; p resists the load."""


def lateral_programmes(result: ServiceResult) -> list[str]:
    """Return the names of the programmes that push a pile in space sideways."""
    return [
        entry.programme.name
        for entry in result.programmes
        if isinstance(entry.programme, Lateral) and entry.along is not None
    ]


def along_pile(service: ServiceResult, wished: ServiceResult, name: str) -> Figure:
    """Return profiles at the end of a programme, and p-y curves, of both models.

    Changes since the start of the programme, in the direction of the load.  What a pile does not
    have is left out: a rigid one shear force and bending moment, a bonded one p.
    """
    first = service.programme(name)
    profiles = [entry for entry in PROFILES if np.isfinite(in_direction(first, entry[0])[-1]).any()]
    has_py = "reaction" in [field for field, _, _ in profiles]
    n_panels = len(profiles) + has_py
    figure, axes = panels(1, n_panels, 2.5 * n_panels, 4.0)
    for model in (service, wished):
        entry = model.programme(name)
        along = entry.along
        assert along is not None
        colour, label = MODEL_COLOURS[model.model], MODEL_NAMES[model.model]
        for here, (field, factor, _) in zip(axes[0], profiles, strict=False):
            values = factor * in_direction(entry, field)[-1]
            here.plot(values, along.height, color=colour, label=label)
        if has_py:
            _draw_py(axes[0, -1], entry, along, colour, with_depth=model is service)
    for here, (_, _, text) in zip(axes[0], profiles, strict=False):
        here.set(xlabel=text)
        grid(here)
    axes[0, 0].set(ylabel="z (m)")
    axes[0, 0].legend()
    if has_py:
        axes[0, -1].set(xlabel="y (mm)", ylabel="p (kN/m)", title="p-y curves, by depth")
        axes[0, -1].margins(x=0.2)
        grid(axes[0, -1])
    return figure


def in_direction(entry: ProgrammeResult, field: str) -> np.ndarray:
    """Return the change (load_step, level) of a field of ``AlongPile`` along the load."""
    programme = entry.programme
    assert isinstance(programme, Lateral)
    values = getattr(entry.along, field)
    along = np.array([np.cos(programme.direction), np.sin(programme.direction)])
    change: np.ndarray = (values - values[:1]) @ along
    return change


def _draw_py(
    here: Any, entry: ProgrammeResult, along: AlongPile, colour: str, *, with_depth: bool
) -> None:
    """Draw the p-y curves of some levels, darker with the depth, which may stand at their ends."""
    levels = np.unique(np.linspace(1, len(along.height) - 1, N_DEPTHS).round().astype(int))[::-1]
    y, p = 1e3 * in_direction(entry, "deflection"), -1e-3 * in_direction(entry, "reaction")
    for number, level in enumerate(levels):
        share = 0.35 + 0.65 * (number + 1) / len(levels)
        here.plot(y[:, level], p[:, level], color=colour, alpha=share)
        if with_depth:
            depth = f" {abs(along.height[level]):.1f} m"
            here.annotate(depth, (y[-1, level], p[-1, level]), fontsize=7, color=INK)
