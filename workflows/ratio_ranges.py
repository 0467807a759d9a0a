"""Ratios installed over wished in place as value and range, from the repeats of a run."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

Ratios = dict[str, dict[str, float | None]]
"""Ratio by programme and figure; None where a curve has no such figure."""


def ratios_of(service: dict[str, dict[str, Any]]) -> Ratios:
    """Return the ratios of all programmes that have some."""
    return {name: figures["ratio"] for name, figures in service.items() if "ratio" in figures}


def ranges(ratios: Ratios, repeated: Iterable[Ratios]) -> Ratios:
    """Return by how much the repeats deviate from the ``ratios`` of the run, at most.

    The value of a ratio is that of the run, its range this deviation to both sides.  None where
    the run or one of the repeats has no such figure.
    """
    repeats = list(repeated)
    return {
        programme: {
            figure: _largest_deviation(value, [ratio[programme][figure] for ratio in repeats])
            for figure, value in figures.items()
        }
        for programme, figures in ratios.items()
    }


def _largest_deviation(value: float | None, others: list[float | None]) -> float | None:
    known = [other for other in others if other is not None]
    if value is None or len(known) < len(others):
        return None
    return max(abs(other - value) for other in known)


def with_ranges(results: dict[str, Any], repeated: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """Return the headline ``results`` with the range of each ratio, and the ratios of each repeat.

    ``repeated`` is the content of ``repeated.json``.
    """
    of_repeats = {name: ratios_of(repeat["service"]) for name, repeat in repeated.items()}
    found = ranges(ratios_of(results["service"]), of_repeats.values())
    service = {
        name: {**figures, "ratio_range": found[name]} if name in found else figures
        for name, figures in results["service"].items()
    }
    repeats = {
        name: {
            "what": repeat["what"],
            "failed_checks": repeat["failed_checks"],
            "ratio": of_repeats[name],
            "continuity": repeat["continuity"],
        }
        for name, repeat in repeated.items()
    }
    return {**results, "service": service, "repeats": repeats}
