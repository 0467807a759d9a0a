"""What a run shows: a progress bar with time left on a terminal, else one line per stage."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    SpinnerColumn,
    TaskProgressColumn,
    TextColumn,
    TimeRemainingColumn,
)

from workflows.report_units import FORCE_UNIT

if TYPE_CHECKING:
    from workflows.case import AnyCase

Advance = Callable[[int, int, str], None]
"""Show that ``done`` of ``total`` steps are complete, with a short note."""


def no_progress(_done: int, _total: int, _note: str) -> None:
    """Show nothing."""


def service_observer(case: AnyCase, advance: Advance) -> Callable[[Any], None]:
    """Return an observer of the service stage that shows all programmes as one count.

    Each programme counts as 100, because its number of steps is not known before it starts.
    """
    assert case.service is not None
    n_programmes, unit = len(case.service.programmes), FORCE_UNIT[case.kinematics]
    finished = 0

    def observe(progress: Any) -> None:
        nonlocal finished
        share = 100 * progress.step // progress.n_steps
        note = f"{progress.programme}, {progress.head_load / 1e3:.0f} {unit}"
        advance((100 * finished + share) // n_programmes, 100, note)
        finished += progress.step == progress.n_steps

    return observe


class Reporter:
    """Shows the progress of stages on a console."""

    def __init__(self, console: Console | None = None) -> None:
        self.console = console or Console(highlight=False)

    @contextmanager
    def stage(self, name: str, doing: str) -> Iterator[Advance]:
        """Show one stage while it runs; yields the function that shows its steps."""
        start = time.perf_counter()
        if self.console.is_terminal:
            with _bar(self.console) as progress:
                task = progress.add_task(name, total=None, note=doing)

                def advance(done: int, total: int, note: str) -> None:
                    progress.update(task, completed=done, total=total, note=note)

                yield advance
        else:
            yield no_progress
        self.say(f"{name:<9} {doing}: {time.perf_counter() - start:.1f} s")

    def say(self, text: str) -> None:
        """Print one line."""
        self.console.print(text, markup=False, soft_wrap=True)


def _bar(console: Console) -> Progress:
    return Progress(
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(bar_width=20),
        TaskProgressColumn(),
        TimeRemainingColumn(),
        TextColumn("left; {task.fields[note]}"),
        console=console,
        transient=True,
    )
