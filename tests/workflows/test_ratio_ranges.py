"""A ratio is that of the run, its range the largest deviation of the repeats from it."""

from workflows.ratio_ranges import ranges, with_ranges
from workflows.report_repeats import ratio_note
from workflows.report_units import value_and_range


def service(stiffness, capacity):
    return {
        "release": {"installed": {}},
        "push": {"ratio": {"initial_stiffness": stiffness, "capacity": capacity}},
    }


def repeat(what, stiffness, capacity, failed=()):
    return {
        "what": what,
        "failed_checks": list(failed),
        "service": service(stiffness, capacity),
        "continuity": {},
    }


RESULTS = {"service": service(0.9, 1.0), "continuity": {}}
REPEATED = {
    "mesh": repeat("finite elements 0.8 times as large", 0.95, 1.0),
    "transfer": repeat("state transferred by nearest", 0.87, 1.02, ["synthetic_error"]),
}


def test_the_range_is_the_largest_deviation():
    found = with_ranges(RESULTS, REPEATED)
    deviations = found["service"]["push"]["ratio_range"]
    assert abs(deviations["initial_stiffness"] - 0.05) < 1e-12
    assert abs(deviations["capacity"] - 0.02) < 1e-12
    assert "ratio_range" not in found["service"]["release"]
    assert found["repeats"]["mesh"]["ratio"]["push"]["initial_stiffness"] == 0.95
    assert "ratio_range" not in RESULTS["service"]["push"]


def test_a_figure_that_a_repeat_lacks_has_no_range():
    base = {"push": {"capacity": 1.0, "tangent_capacity": None}}
    assert ranges(base, [{"push": {"capacity": None, "tangent_capacity": 1.0}}]) == {
        "push": {"capacity": None, "tangent_capacity": None}
    }


def test_the_report_tells_what_the_range_is_worth():
    note = ratio_note(with_ranges(RESULTS, REPEATED))
    assert "prediction" in note
    assert "finite elements 0.8 times as large; state transferred by nearest" in note
    assert "does not keep its limits in synthetic error" in note
    assert "0.870" in note
    assert "no range" in ratio_note(RESULTS)
    assert value_and_range(0.9, 0.05) == "0.900 ± 0.050"
    assert value_and_range(0.9, None) == "0.900"
    assert value_and_range(None, None) == "–"
