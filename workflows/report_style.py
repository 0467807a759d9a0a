"""Look of the report's pictures: colours, units of display, and how a figure enters the page.

A figure becomes inline SVG.  Everything drawn in ``INK`` takes the text colour of the page, so the
same picture is readable on light and dark ground; fields with many cells are raster images in it.
"""

from __future__ import annotations

import io
import re
from contextlib import AbstractContextManager
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

INK = "#1b2a38"
"""Stands for the text colour of the page."""

INSTALLED, WISHED = "#c8553d", "#3d7ea6"
"""Colours of the installed and of the wished-in-place pile; contrast 4:1 on white and on black."""

SAND, MUTED, PILE = "#c79a2b", "#8a949e", "#8a949e"

MODEL_NAMES = {"installed": "installed", "wished_in_place": "wished in place"}
MODEL_COLOURS = {"installed": INSTALLED, "wished_in_place": WISHED}

DIVERGING, SEQUENTIAL, INTENSITY = "RdBu_r", "viridis", "magma_r"
"""Perceptual colour maps: signed change, share or distance, and strain."""

RESOLUTION = 150
"""Dots per inch of the raster parts."""

PAGE_RESOLUTION = 110
"""Dots per inch of pictures for the documentation."""

STYLE = {
    "figure.facecolor": "none",
    "axes.facecolor": "none",
    "savefig.facecolor": "none",
    "svg.fonttype": "path",
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.labelsize": 9.0,
    "legend.fontsize": 8.5,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "axes.linewidth": 0.7,
    "lines.linewidth": 1.6,
    "axes.titlelocation": "left",
    "axes.titlepad": 7.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "image.composite_image": False,
    **dict.fromkeys(
        ("text.color", "axes.edgecolor", "axes.labelcolor", "xtick.color", "ytick.color"), INK
    ),
}


def styled() -> AbstractContextManager[None]:
    """Return the context in which figures are made and written; nothing outside it changes."""
    context: AbstractContextManager[None] = mpl.rc_context(STYLE)
    return context


def panels(rows: int, columns: int, width: float, height: float, **options: Any) -> Any:
    """Return a figure of ``width`` x ``height`` inches and its axes (rows, columns)."""
    figure = Figure(figsize=(width, height), layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False, **options)


def grid(axes: Any, axis: str = "both") -> None:
    """Draw faint grid lines behind the data."""
    axes.grid(True, axis=axis, color=MUTED, alpha=0.3, linewidth=0.6)
    axes.set_axisbelow(True)


def svg_of(figure: Figure, name: str) -> str:
    """Return a figure as inline SVG; ``name`` keeps its ids apart from those of other figures."""
    buffer = io.StringIO()
    with mpl.rc_context({"svg.hashsalt": name}):
        figure.savefig(buffer, format="svg", dpi=RESOLUTION, metadata={"Date": None})
    svg = buffer.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    svg = re.sub(r'\bid="', f'id="{name}-', svg)
    svg = re.sub(r'(href="|url\()#', rf"\1#{name}-", svg)
    svg = re.sub(r' width="[\d.]+pt" height="[\d.]+pt"', "", svg, count=1)
    return svg.replace(INK, "currentColor").replace(INK.upper(), "currentColor")


def png_of(figure: Figure) -> bytes:
    """Return a figure as PNG on white ground, e.g. for the documentation."""
    buffer = io.BytesIO()
    with styled():
        figure.savefig(buffer, format="png", dpi=PAGE_RESOLUTION, facecolor="white")
    return buffer.getvalue()
