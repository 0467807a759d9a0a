"""Progress in a log: a line now and then with the time left, counted from where a stage resumed."""

from types import SimpleNamespace

import pytest
from rich.console import Console

from install_mpm.conventions import Kinematics
from service_fe.options import Displace, Load, Rotate
from workflows import progress
from workflows.progress import Reporter, service_observer
from workflows.report_service import shown_as


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


def test_service_tells_a_load_in_its_unit():
    case = SimpleNamespace(
        service=SimpleNamespace(programmes=("down", "round")), kinematics=Kinematics.THREE_D
    )
    told = []
    observe = service_observer(case, lambda *shown: told.append(shown))
    for programme, step, load_unit, head_load in (
        ("down", 2, "N", 88_900.0), ("round", 1, "N m", -7_640.0),
    ):  # fmt: skip
        observe(SimpleNamespace(programme=programme, step=step, n_steps=2,
                                load_unit=load_unit, head_load=head_load))  # fmt: skip
    assert told == [(50, 100, "down, 88.9 kN"), (75, 100, "round, −7.64 kN m")]


@pytest.mark.parametrize(
    ("programme", "labels"),
    [
        (Displace("down", 0.1, 0.1), ("displacement, downward (mm)", "head load (kN)")),
        (Rotate("round", 0.1, 0.1), ("rotation (°)", "moment (kN m)")),
        (Load("by torque", vertical=1.0, torque=1.0), ("rotation (°)", "moment (kN m)")),
    ],
)
def test_curves_of_rotations_have_moments(programme, labels):
    assert shown_as(programme, Kinematics.THREE_D)[1:] == labels
