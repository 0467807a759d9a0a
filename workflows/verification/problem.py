"""What a reference problem is, and what it returns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from importlib.util import find_spec
from typing import Any

from install_mpm.newton import ROUND_OFF


@dataclass(frozen=True)
class Check:
    """One computed quantity beside its reference."""

    quantity: str
    """What is compared, in words, with unit."""
    computed: float
    reference: float
    error: float
    """What is compared with the tolerance: relative unless ``quantity`` says otherwise."""
    tolerance: float | None
    """None if the quantity is shown without a demand."""

    @property
    def is_met(self) -> bool:
        """Return whether the error lies within the tolerance (a NaN does not)."""
        return self.tolerance is None or abs(self.error) <= self.tolerance


@dataclass(frozen=True)
class Series:
    """A curve for the report: computed beside reference over one abscissa."""

    title: str
    abscissa: str
    ordinate: str
    x: tuple[float, ...]
    computed: tuple[float, ...]
    reference: tuple[float, ...] = ()
    is_logarithmic: bool = False
    """Draw both axes logarithmically: convergence studies."""


@dataclass(frozen=True)
class Picture:
    """A picture of a state for the report; it is drawn only if a report is written."""

    name: str
    """Of its file, after the name of the problem or case."""
    caption: str
    draw: Callable[[], Any]
    """Return the figure (matplotlib), or the bytes of a PNG that was drawn before."""

    def png(self) -> bytes:
        """Return the picture as PNG."""
        from workflows.report_style import png_of, styled

        with styled():
            drawn = self.draw()
        return drawn if isinstance(drawn, bytes) else png_of(drawn)


@dataclass(frozen=True)
class Outcome:
    """Result of a reference problem."""

    checks: tuple[Check, ...]
    series: tuple[Series, ...] = ()
    remarks: tuple[str, ...] = ()
    residual_histories: tuple[tuple[float, ...], ...] = field(default=(), repr=False)
    """Relative Newton residuals of every step, for the statement on convergence."""
    round_off: float = ROUND_OFF
    """Relative residual below which nothing shows but round-off: stiff ground, small loads."""
    pictures: tuple[Picture, ...] = field(default=(), repr=False)


@dataclass(frozen=True)
class Problem:
    """A named reference problem; ``run`` takes its physical parameters as keywords with defaults.

    The keywords are the symbols of the reference (a, b, E, nu, su, ...), annotated with their SI
    unit; the reference is evaluated with the same values, so a changed parameter moves both.
    """

    identifier: str
    title: str
    run: Callable[..., Outcome]
    is_quick: bool
    """Part of ``screwpile verify --quick``: a few seconds."""
    needs: str = ""
    """Package of an extra, whose code is the reference; without it the problem is left out."""

    @property
    def is_available(self) -> bool:
        """Return whether the package that the problem needs is installed."""
        return not self.needs or find_spec(self.needs) is not None


def relative(quantity: str, computed: float, reference: float, tolerance: float) -> Check:
    """Return the check of a relative error."""
    return Check(quantity, computed, reference, computed / reference - 1.0, tolerance)


def shown(quantity: str, computed: float, reference: float) -> Check:
    """Return the row of a relative error that is shown and not demanded."""
    return Check(quantity, computed, reference, computed / reference - 1.0, None)


def absolute(quantity: str, computed: float, reference: float, tolerance: float) -> Check:
    """Return the check of an absolute difference."""
    return Check(quantity, computed, reference, computed - reference, tolerance)


def at_most(quantity: str, computed: float, bound: float) -> Check:
    """Return the check that a quantity does not exceed ``bound``."""
    return Check(quantity, computed, 0.0, computed, bound)


def at_least(quantity: str, computed: float, bound: float) -> Check:
    """Return the check that a quantity, such as an order of convergence, reaches ``bound``."""
    return Check(quantity, computed, bound, max(bound - computed, 0.0), 0.0)
