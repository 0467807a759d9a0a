"""Pieces of HTML: tables, figures, badges; everything that comes from data is escaped."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import NamedTuple

from matplotlib.figure import Figure

from workflows.report_style import svg_of


class Cell(NamedTuple):
    """Content of a table cell that is HTML already, with its CSS class."""

    html: str
    css: str = ""


def cell(content: str | Cell) -> Cell:
    """Return ``content`` as a cell; text is escaped."""
    return content if isinstance(content, Cell) else Cell(escape(content))


def number(text: str) -> Cell:
    """Return a cell for a number, set flush right."""
    return Cell(escape(text), "number")


def badge(is_met: bool) -> Cell:
    """Return the mark of a check that is passed or failed."""
    return Cell("pass", "pass") if is_met else Cell("FAIL", "fail")


def table(head: Sequence[str | Cell], rows: Iterable[Sequence[str | Cell]], css: str = "") -> str:
    """Return a table; with an empty ``head`` it has none."""
    lines = [f'<div class="scroll"><table class="{css}">' if css else '<div class="scroll"><table>']
    if head:
        lines.append(f"<thead>{_row(head, 'th')}</thead>")
    lines.append("<tbody>")
    lines.extend(_row(row, "td") for row in rows)
    lines.append("</tbody></table></div>")
    return "\n".join(lines)


def _row(cells: Iterable[str | Cell], tag: str) -> str:
    parts = []
    for content in cells:
        html, css = cell(content)
        parts.append(f'<{tag} class="{css}">{html}</{tag}>' if css else f"<{tag}>{html}</{tag}>")
    return f"<tr>{''.join(parts)}</tr>"


def still(name: str, picture: Figure, caption: str) -> str:
    """Return a picture as inline SVG, at most as wide as it was made; the caption is plain text."""
    width = picture.get_size_inches()[0]
    svg = svg_of(picture, name).replace(
        "<svg ", f'<svg role="img" aria-label="{escape(caption, quote=True)}" ', 1
    )
    return f'<div style="max-width: {width:.1f}in">{svg}</div>'


def figure(name: str, picture: Figure, caption: str) -> str:
    """Return a picture with its caption (plain text)."""
    return (
        f'<figure id="{name}">{still(name, picture, caption)}'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )


def details(summary: str, html: str) -> str:
    """Return a part of the page that the reader opens."""
    return f"<details><summary>{escape(summary)}</summary>\n{html}\n</details>"


def code(text: str) -> str:
    """Return text set as code."""
    return f"<pre><code>{escape(text)}</code></pre>"
