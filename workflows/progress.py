"""What a run shows: a bar with the time left on a terminal; in a log, lines that say the same."""

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

from workflows.ranks import is_first
from workflows.report_units import shown

if TYPE_CHECKING:
    from workflows.case import AnyCase

LINE_INTERVAL = 60.0
"""Seconds between the lines of a stage in a log."""

Advance = Callable[[int, int, str], None]
"""Show that ``done`` of ``total`` steps are complete, with a short note."""


def no_progress(_done: int, _total: int, _note: str) -> None:
    """Show nothing."""


def service_observer(case: AnyCase, advance: Advance) -> Callable[[Any], None]:
    """Return an observer of the service stage that shows all programmes as one count.

    Each programme counts as 100, because its number of steps is not known before it starts.
    """
    assert case.service is not None
    n_programmes = len(case.service.programmes)
    finished = 0

    def observe(progress: Any) -> None:
        nonlocal finished
        share = 100 * progress.step // progress.n_steps
        load = shown(progress.head_load, progress.load_unit, 3, case.kinematics)
        note = f"{progress.programme}, {load}"
        advance((100 * finished + share) // n_programmes, 100, note)
        finished += progress.step == progress.n_steps

    return observe


class Reporter:
    """Shows the progress of stages on a console, by default that of the first rank."""

    def __init__(self, console: Console | None = None) -> None:
        self.console = console or Console(highlight=False, quiet=not is_first())

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
            yield self._lines(name)
        self.say(f"{name:<9} {doing}: {time.perf_counter() - start:.1f} s")

    def _lines(self, name: str) -> Advance:
        """Return what prints how far a stage is, once in ``LINE_INTERVAL``.

        A resumed stage begins at the step that it was resumed from.
        """
        first: tuple[int, float] | None = None
        last = time.perf_counter()

        def advance(done: int, total: int, note: str) -> None:
            nonlocal first, last
            now = time.perf_counter()
            first = first or (done, now)
            if now - last < LINE_INTERVAL or not first[0] < done < total:
                return
            last = now
            left = (now - first[1]) * (total - done) / (done - first[0])
            self.say(f"{name:<9} {done} of {total}, about {left / 60.0:.0f} min left; {note}")

        return advance

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
