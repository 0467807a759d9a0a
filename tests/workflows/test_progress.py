"""Progress in a log: a line now and then with the time left, counted from where a stage resumed."""

import pytest
from rich.console import Console

from workflows import progress
from workflows.progress import Reporter


@pytest.fixture
def clock(monkeypatch):
    """A clock that is set by hand."""
    now = [0.0]
    monkeypatch.setattr(progress.time, "perf_counter", lambda: now[0])
    return now


def lines_of(steps, clock):
    """Return what a log holds after steps (time in s, done), of 100, without the closing line."""
    console = Console(record=True, quiet=False, force_terminal=False, width=200)
    with Reporter(console).stage("install", "jack the pile") as advance:
        for clock[0], done in steps:
            advance(done, 100, "note")
    return console.export_text().splitlines()[:-1]


def test_a_line_a_minute_with_the_time_left(clock):
    steps = [(0.0, 0), (30.0, 5), (61.0, 10), (90.0, 15), (130.0, 20), (500.0, 100)]
    assert lines_of(steps, clock) == [
        "install   10 of 100, about 9 min left; note",
        "install   20 of 100, about 9 min left; note",
    ]


def test_the_steps_before_a_restart_took_no_time(clock):
    steps = [(0.0, 80), (120.0, 90)]
    assert lines_of(steps, clock) == ["install   90 of 100, about 2 min left; note"]
