"""Repeats of hand-over and service, from which the ratios installed over wished get a range.

A ratio of one run carries the error of its finite elements and of the way in which the state came
to them.  Both are changed in turn: a second mesh for both models, and a second transfer for the
installed one (undisturbed ground comes out exactly by any).  The installation stays as it is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

from annotated_types import Ge, Le

from handoff.options import Transfer
from service_fe.loading import RELEASED
from service_fe.options import (
    Displace,
    Lateral,
    Programme,
    Release,
    Resume,
    Rotate,
    ServiceOptions,
)
from workflows.continuity import is_moved_on
from workflows.errors import CaseError

if TYPE_CHECKING:
    from workflows.case import AnyCase


@dataclass(frozen=True)
class ComparisonOptions:
    """Repeats of hand-over and service that give each ratio a range; without it there is none."""

    size_factor: Annotated[float, Ge(0.5), Le(2)] = 0.8
    """Sizes of the finite elements on the second mesh over those in ``handoff``; not 1."""
    transfer: Transfer = "nearest"
    """Second way from material points to finite elements, other than ``handoff.transfer``."""


class Repeat(NamedTuple):
    """One repeat: the case with one thing changed, and the stages that depend on it."""

    name: str
    what: str
    """What is changed, in words."""
    case: AnyCase
    stages: tuple[str, ...]


def has_ratio(programme: Programme) -> bool:
    """Return whether the figures of a programme are compared: it starts without head load."""
    return isinstance(programme, Displace | Lateral | Rotate) and programme.start == RELEASED


def repeats_of(case: AnyCase) -> tuple[Repeat, ...]:
    """Return the repeats of a case that has all of [handoff], [service] and [comparison]."""
    options, handoff = case.comparison, case.handoff
    assert options is not None
    assert handoff is not None
    assert case.service is not None
    rated = replace(case, service=_rated(case.service), comparison=None)
    factor = options.size_factor
    mesh = replace(
        handoff, size_at_pile=factor * handoff.size_at_pile, size_far=factor * handoff.size_far
    )
    transfer = replace(handoff, transfer=options.transfer)
    spaced = options.transfer.replace("_", " ")
    return (
        Repeat("mesh", f"finite elements {factor:g} times as large",
               replace(rated, handoff=mesh), ("hand_off", "serve", "wished")),
        Repeat("transfer", f"state transferred by {spaced}",
               replace(rated, handoff=transfer), ("hand_off", "serve")),
    )  # fmt: skip


def _rated(service: ServiceOptions) -> ServiceOptions:
    """Return the service stage with nothing but what ratios and continuity need."""
    kept = tuple(
        programme
        for programme in service.programmes
        if isinstance(programme, Release | Resume) or has_ratio(programme) or is_moved_on(programme)
    )
    return replace(service, programmes=kept)


def check_comparison(case: AnyCase, check_repeat: Callable[[Any], None]) -> None:
    """Check that the repeats differ from the run, and that there is something to compare.

    ``check_repeat`` checks the case of a repeat as it does any case.

    Raises
    ------
    CaseError
        Naming the keys, their values and the remedy.
    """
    options = case.comparison
    if options is None:
        return
    if case.handoff is None or case.service is None:
        raise CaseError("[comparison] is there without [handoff] and [service]; give all three")
    if options.size_factor == 1.0:
        raise CaseError("comparison.size_factor is 1, which is no second mesh; take e.g. 0.8")
    if options.transfer == case.handoff.transfer:
        raise CaseError(
            f"comparison.transfer is {options.transfer!r}, as handoff.transfer; take the other one"
        )
    if not any(map(has_ratio, case.service.programmes)):
        raise CaseError(
            "[comparison] is there, but no programme has a ratio: put one of kind "
            '"displace", "lateral" or "rotate" after a release'
        )
    for repeat in repeats_of(case):
        try:
            check_repeat(repeat.case)
        except CaseError as error:
            raise CaseError(f"[comparison], repeat with {repeat.what}: {error}") from error
