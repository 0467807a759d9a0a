"""The load-settlement curve of a footing, and its pictures beside an exact bearing factor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workflows.verification.problem import Series


@dataclass(frozen=True)
class FootingCurve:
    """Load-settlement curve of a rigid footing."""

    settlement: np.ndarray
    """Settlement over width or diameter (step,)."""
    bearing_factor: np.ndarray
    """Mean pressure over what carries the footing, a strength or a pressure, (step,)."""
    residuals: tuple[tuple[float, ...], ...]
    """Relative residuals of each step."""

    @property
    def plateau(self) -> float:
        """Bearing capacity factor at the end of the curve."""
        return float(self.bearing_factor[-1])

    @property
    def slope(self) -> float:
        """Relative change of the load over the last quarter of the curve."""
        late = self.bearing_factor[self.settlement >= 0.75 * self.settlement[-1]]
        return float(late[-1] / late[0] - 1.0)


def curve_on_finest_mesh(
    title: str,
    fine: FootingCurve,
    exact: float,
    *,
    width: str,
    factor: str,
    way: str = "settlement",
) -> Series:
    """Return the curve of the finest mesh; ``width`` and ``factor`` are symbols of the axes."""
    return Series(
        title,
        f"{way} / {width}",
        factor,
        tuple(fine.settlement),
        tuple(fine.bearing_factor),
        tuple(np.full(len(fine.settlement), exact)),
    )


def error_over_size(
    title: str,
    results: Sequence[FootingCurve],
    exact: float,
    sizes: Sequence[float],
    *,
    width: str,
    place: str = "edge of the footing",
) -> Series:
    """Return the error of the plateau over the ``sizes`` of the elements at the ``place``."""
    return Series(
        title,
        f"size at the {place} / {width}",
        "relative error",
        tuple(sizes),
        tuple(abs(result.plateau / exact - 1.0) for result in results),
        is_logarithmic=True,
    )
