"""Results of reference problems as a page: ``screwpile verify --report FILE``.

The page holds nothing of the machine and no time but a rounded total, so that it can be kept under
version control; pictures go to ``images/<name of the page>`` beside it.
"""

from __future__ import annotations

import inspect
import math
from pathlib import Path
from string import Template
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from workflows.directory import write_text
from workflows.report_style import INSTALLED, WISHED, grid, panels, png_of, styled
from workflows.verification.problem import Check, Series
from workflows.verification.runner import Verified
from workflows.verification_kept import source_module
from workflows.verification_numbers import HEADINGS, cells, count_text, inputs_text

TEMPLATE = Path(__file__).parent / "templates" / "verification.md"

COLUMNS = 3
"""Pictures side by side."""

FEW = 6
"""Abscissas of a study of convergence that are all written at the axis."""

MINUTES = 5
"""The total time is rounded up to a multiple of this."""


def write_report(results: list[Verified], path: Path) -> None:
    """Write the page to ``path`` and its pictures beside it; pictures of other runs are removed."""
    pictures = path.parent / "images" / path.stem
    pictures.mkdir(parents=True, exist_ok=True)
    for old in pictures.glob("*.png"):
        old.unlink()
    sections = []
    for result in results:
        section = _section(result)
        if result.outcome is not None and result.outcome.series:
            picture = pictures / f"{anchor(result)}.png"
            picture.write_bytes(png_of(draw(result.outcome.series)))
            titles = "; ".join(_title(series) for series in result.outcome.series)
            section += f"\n![{titles}]({picture.relative_to(path.parent).as_posix()})\n"
        section += _pictures(result, pictures, path.parent)
        sections.append(section)
    minutes = MINUTES * math.ceil(sum(result.seconds for result in results) / 60.0 / MINUTES)
    page = Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        count=count_text(results),
        minutes=minutes,
        overview="\n".join(_overview(result) for result in results),
        sections="\n".join(sections),
    )
    write_text(path, page)


def _pictures(result: Verified, folder: Path, page_folder: Path) -> str:
    """Write the pictures of states of a problem into ``folder``; return the links to them."""
    lines = ""
    for picture in result.outcome.pictures if result.outcome else ():
        file = folder / f"{anchor(result)}-{picture.name}.png"
        file.write_bytes(picture.png())
        lines += f"\n![{picture.caption}]({file.relative_to(page_folder).as_posix()})\n"
    return lines


def anchor(result: Verified) -> str:
    """Return the name of a problem or case in links and files."""
    return result.name.lower()


def _overview(result: Verified) -> str:
    """Return the row of a problem: its check that comes closest to the tolerance."""
    link = f"[{result.name}](#{anchor(result)})"
    verdict = "met" if result.is_met else "**FAILED**"
    worst = max(result.checks, key=_use_of_tolerance, default=None)
    if worst is None:
        return f"| {link} | {result.title} | not solved | | | {verdict} |"
    quantity, _, _, error, tolerance, _ = map(_escaped, cells(worst))
    return f"| {link} | {result.title} | {quantity} | {error} | {tolerance} | {verdict} |"


def _use_of_tolerance(check: Check) -> float:
    """Return the error over the tolerance; what has no tolerance counts only if it fails."""
    if not check.is_met:
        return math.inf
    return abs(check.error) / check.tolerance if check.tolerance else 0.0


def _section(result: Verified) -> str:
    """Return statement, source, inputs, checks and convergence of a problem."""
    lines = [
        f'<a id="{anchor(result)}"></a>',
        "",
        f"### {result.name}: {result.title}",
        "",
        f"{_statement(result)} (`{_source(result)}`)",
        "",
        f"With {inputs_text(result)}.",
        "",
    ]
    if result.outcome is None:
        return "\n".join([*lines, f"**Not solved**: {result.failure}", ""])
    lines += [
        _row(HEADINGS),
        "|---|---:|---:|---:|---:|---|",
        *(_row(cells(check)) for check in result.checks),
        "",
    ]
    if result.newton is not None:
        lines += [f"Newton's method: {result.newton.text}.", ""]
    for remark in result.outcome.remarks:
        lines += [_escaped(remark), ""]
    return "\n".join(lines)


def _statement(result: Verified) -> str:
    """Return the docstring of the problem's function up to its sections, as one paragraph."""
    text = inspect.getdoc(result.problem.run) or result.problem.title
    for heading in ("Parameters", "Returns", "Raises", "Notes"):
        text = text.split(f"\n{heading}\n---", 1)[0]
    return " ".join(text.replace("``", "`").split())


def _source(result: Verified) -> str:
    return source_module(result.problem).replace(".", "/") + ".py"


def _row(texts: tuple[str, ...]) -> str:
    return f"| {' | '.join(map(_escaped, texts))} |"


def _escaped(text: str) -> str:
    """Return ``text`` without what Markdown takes for a column, emphasis or HTML."""
    for character in "|*_<":
        text = text.replace(character, f"\\{character}")
    return text


def draw(series: tuple[Series, ...]) -> Figure:
    """Return the picture of a problem: one panel for each series."""
    columns = min(len(series), COLUMNS)
    rows = math.ceil(len(series) / COLUMNS)
    with styled():
        figure, axes = panels(rows, columns, 3.9 * columns, 2.9 * rows)
        for panel in axes.flat[len(series) :]:
            panel.remove()
        for panel, one in zip(axes.flat, series, strict=False):
            _draw(panel, one)
    return figure


ROUND_OFF = 1e-9
"""A curve that varies by less than this share is drawn as the constant that it is."""


def _draw(axes: Any, series: Series) -> None:
    x, computed = np.array(series.x), np.array(series.computed)
    if series.reference:
        axes.plot(x, series.reference, color=WISHED, linewidth=2.2, label="reference")
    label = "computed"
    if series.is_logarithmic:
        _make_logarithmic(axes, x)
        label += _slope(x, computed)
    else:
        axes.ticklabel_format(scilimits=(-3, 5))
        axes.locator_params(nbins=6)
    marker = {"marker": "o", "markersize": 3.5} if len(x) <= 60 else {}
    axes.plot(x, computed, color=INSTALLED, linewidth=1.0, label=label, **marker)
    level = float(np.abs(computed).max())
    if not series.is_logarithmic and np.ptp(computed) < ROUND_OFF * level:
        axes.set_ylim(0.0, 1.3 * level) if computed[0] > 0.0 else axes.set_ylim(-1.3 * level, 0.0)
    axes.set(title=series.title, xlabel=series.abscissa, ylabel=series.ordinate)
    grid(axes)
    axes.legend()


def _make_logarithmic(axes: Any, x: np.ndarray) -> None:
    """Make both axes logarithmic, with ticks at the abscissas of a study of few sizes."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    if len(x) <= FEW:
        axes.set_xticks(x, [f"{value:.3g}" for value in x])
        axes.tick_params(axis="x", which="minor", bottom=False, labelbottom=False)


def _slope(x: np.ndarray, y: np.ndarray) -> str:
    """Return the slope of the straight line through the logarithms, in words."""
    is_positive = (x > 0.0) & (y > 0.0)
    if is_positive.sum() < 2:
        return ""
    slope = np.polyfit(np.log(x[is_positive]), np.log(y[is_positive]), 1)[0]
    return f", slope {slope:.2f}"


def _title(series: Series) -> str:
    return f"{series.title}: {series.ordinate} over {series.abscissa}".replace("]", ")").replace(
        "[", "("
    )
