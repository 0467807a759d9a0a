"""One number of the certificate, beside the limit that it has to keep."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    """One number of the certificate; it keeps its limit if it is not larger."""

    value: float
    unit: str
    meaning: str
    limit: float | None = None

    @property
    def is_met(self) -> bool:
        """Whether the limit is kept; a figure without limit is for information."""
        return self.limit is None or bool(self.value <= self.limit)


def relative_difference(value: float, reference: float) -> float:
    """Return |value - reference| over |reference|; zero where both are zero."""
    difference = abs(value - reference)
    return difference / abs(reference) if reference else difference
