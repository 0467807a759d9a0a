"""How the numbers of a reference problem are written, on the console and on the page."""

from __future__ import annotations

import math

from workflows.verification.problem import Check
from workflows.verification.runner import Verified

HEADINGS = ("quantity", "computed", "reference", "error", "tolerance", "")

SMALLEST_ERROR, SMALLEST_VALUE = 1e-9, 1e-12
"""What is smaller is round-off and shown by the power of ten above it, which is repeatable."""


def cells(check: Check) -> tuple[str, str, str, str, str, str]:
    """Return the row of ``check`` under ``HEADINGS``."""
    return (
        check.quantity,
        number_text(check.computed, ".5g", SMALLEST_VALUE),
        number_text(check.reference, ".5g", SMALLEST_VALUE),
        number_text(check.error, "+.2g", SMALLEST_ERROR),
        "none" if check.tolerance is None else f"{check.tolerance:.2g}",
        "shown" if check.tolerance is None else "met" if check.is_met else "FAILED",
    )


def number_text(value: float, digits: str, smallest: float) -> str:
    """Return ``value`` in the format ``digits``, but what is below ``smallest`` by its power."""
    if value == 0.0:
        return "0"
    if abs(value) >= smallest or math.isnan(value):
        return f"{value:{digits}}"
    return f"< 1e{max(math.ceil(math.log10(abs(value))), -15)}"


def inputs_text(result: Verified) -> str:
    """Return all parameters with their values."""
    inputs = (f"{one.name} = {one.format(result.values[one.name])}" for one in result.parameters)
    return ", ".join(inputs) or "none"


def count_text(results: list[Verified]) -> str:
    """Return how many problems are within tolerance."""
    n_met = sum(result.is_met for result in results)
    failed = ", ".join(result.name for result in results if not result.is_met)
    ending = f"; not met: {failed}" if failed else ""
    plural = "s" if len(results) > 1 else ""
    return f"{n_met} of {len(results)} reference problem{plural} within tolerance{ending}"
