"""Figures of the report that answer the mouse: curves with values, views that can be turned.

Each stands on a still picture, which is what a reader without JavaScript, and the printer, gets.
plotly draws them; its library is part of the page, so that the page needs no network.
"""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import Any

import numpy as np
import plotly.graph_objects as go
from matplotlib.figure import Figure
from plotly.offline import get_plotlyjs
from plotly.subplots import make_subplots

from workflows.report_html import still
from workflows.report_style import MUTED

TEMPLATES = Path(__file__).parent / "templates"

FONT = {"family": "inherit", "size": 13}

MARGIN = {"l": 10, "r": 10, "t": 30, "b": 10}

FAINT = "rgba(138, 148, 158, 0.3)"
"""Colour of grid lines: seen on light and on dark ground."""

AXIS = {"gridcolor": FAINT, "zerolinecolor": MUTED, "linecolor": MUTED}

PANEL_HEIGHT = 330
"""Height of a row of panels in pixels."""


def interactive(name: str, picture: Figure, plot: go.Figure, caption: str) -> str:
    """Return a figure that answers the mouse, over its still ``picture``; the caption is text.

    The page has to have ``scripts()``, once.
    """
    # "</" would end the element that holds the data
    data = plot.to_json(engine="json").replace("</", "<\\/")
    return (
        f'<figure id="{name}" class="interactive">'
        f'<div class="still">{still(name, picture, caption)}</div>'
        f'<div class="plot" role="img" aria-label="{escape(caption, quote=True)}"></div>'
        f'<script type="application/json">{data}</script>'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )


def scripts(html: str) -> str:
    """Return what a page with the content ``html`` needs to run: plotly only where it is used."""
    own = (TEMPLATES / "report.js").read_text(encoding="utf-8")
    library = f"<script>{get_plotlyjs()}</script>\n" if 'class="interactive"' in html else ""
    return f"{library}<script>\n{own}</script>"


def panels(rows: int, columns: int, titles: list[str] | None = None) -> go.Figure:
    """Return an empty plot of ``rows`` x ``columns`` panels in the style of the page."""
    plot = make_subplots(
        rows, columns, subplot_titles=titles, horizontal_spacing=0.1, vertical_spacing=0.35 / rows
    )
    plot.update_layout(**layout(PANEL_HEIGHT * rows))
    for update in (plot.update_xaxes, plot.update_yaxes):
        update(**AXIS, ticks="outside", automargin=True, title_font_size=FONT["size"])
    return plot


def layout(height: int) -> dict[str, Any]:
    """Return the common layout of a plot of ``height`` pixels, on the ground of the page."""
    return {
        "template": "none", "height": height, "margin": MARGIN, "font": FONT,
        "paper_bgcolor": "rgba(0,0,0,0)", "plot_bgcolor": "rgba(0,0,0,0)",
        "legend": {"orientation": "h", "y": -0.25 * PANEL_HEIGHT / height, "yref": "paper"},
        "hovermode": "closest",
    }  # fmt: skip


def line(x: np.ndarray, y: np.ndarray, name: str, colour: str, hover: str, **more: Any) -> Any:
    """Return a curve through the points (n,), (n,); ``hover`` says what the mouse is told."""
    style = {"color": colour, "dash": more.pop("dash", "solid"), "width": 2}
    return go.Scatter(
        x=single(x), y=single(y), name=name, mode=more.pop("mode", "lines"), line=style,
        hovertemplate=hover + "<extra>%{fullData.name}</extra>", **more,
    )  # fmt: skip


def single(values: np.ndarray) -> np.ndarray:
    """Return ``values`` in single precision: a page shows no more, and is half as large."""
    return np.asarray(values, dtype=np.float32)
