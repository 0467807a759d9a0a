"""The first row of the table of results is what the main case gives."""

from pathlib import Path

import pytest

from workflows.case import read_case
from workflows.report_data import read_results
from workflows.runner import run_case

ROOT = Path(__file__).parents[2]


def first_row():
    """The numbers of the row "as it stands" of the page."""
    page = (ROOT / "docs" / "installation_case.md").read_text(encoding="utf-8")
    row = next(line for line in page.splitlines() if line.startswith("| as it stands |"))
    return [float(text.replace("−", "-")) for text in row.strip("|").split("|")[1:]]


@pytest.mark.slow
def test_the_page_tells_what_the_main_case_gives(tmp_path):
    case, _ = read_case(ROOT / "cases" / "jacked_pile_clay.toml")
    run_case(case, tmp_path / "out")
    results = read_results(tmp_path / "out").summary["results"]
    service = results["service"]
    found = [results["installation"]["crowd_force_N"] / 1e3]
    for name in ("compression", "uplift"):
        for model in ("installed", "wished_in_place"):
            found.append(service[name][model]["capacity_N"] / 1e3)
        found.append(service[name]["ratio"]["capacity"])
    found += results["continuity"]["push_on"].values()
    assert found == pytest.approx(first_row(), rel=2e-3)
