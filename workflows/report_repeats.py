"""What the report says of the range of the ratios: how it was found, the ratios of the repeats."""

from __future__ import annotations

from html import escape
from typing import Any

from workflows.report_html import Cell, details, number, table
from workflows.report_tables import group_row, spaced
from workflows.report_units import significant

NOTE = """<p>Ratio: installed over wished in place. It is a prediction: what is published
verifies such a ratio no better than its sign and some 30 %. {range}</p>"""

WITH_RANGE = """± is the largest deviation of the repeats from the run: {repeats}. It holds the
error of these finite elements and of the transfer; that of the installation's mesh, and of the
assumptions, is not in it."""

WITHOUT_RANGE = """It has no range: <code>[comparison]</code> in the case has hand-over and service
repeated on a second mesh and with a second transfer."""


def ratio_note(results: dict[str, Any]) -> str:
    """Return what a ratio is worth, and the ratios of the repeats if there are any."""
    repeats = results.get("repeats")
    if not repeats:
        return NOTE.format(range=WITHOUT_RANGE)
    changes = "; ".join(escape(repeat["what"]) for repeat in repeats.values())
    return NOTE.format(range=WITH_RANGE.format(repeats=changes)) + details(
        "Ratios of the repeats", repeats_table(results) + _failed(repeats)
    )


def repeats_table(results: dict[str, Any]) -> str:
    """Return each ratio in the run and in every repeat."""
    repeats = results["repeats"].values()
    head: list[str | Cell] = ["", number("run"), *(number(repeat["what"]) for repeat in repeats)]
    rows: list[list[str | Cell]] = []
    for name, figures in results["service"].items():
        if "ratio" not in figures:
            continue
        rows.append(group_row(spaced(name)))
        for key, value in figures["ratio"].items():
            values = [value, *(repeat["ratio"][name][key] for repeat in repeats)]
            rows.append([spaced(key), *(number(_shown(ratio)) for ratio in values)])
    return table(head, rows)


def _shown(ratio: float | None) -> str:
    return "–" if ratio is None else significant(ratio, 3)


def _failed(repeats: dict[str, dict[str, Any]]) -> str:
    """Return which repeats do not keep their certificate; they widen the range all the same."""
    return "".join(
        f"<p>The certificate of the repeat with {escape(repeat['what'])} does not keep its limits"
        f" in {escape(', '.join(map(spaced, repeat['failed_checks'])))}.</p>"
        for repeat in repeats.values()
        if repeat["failed_checks"]
    )
