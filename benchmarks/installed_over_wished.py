"""Installed over wished in place: stiffness and capacity of a screw pile at two advances.

    python benchmarks/installed_over_wished.py -o DIR [--soils clay sand] [--ratios 1 0.5]
        [--turns 0.25] [--page FILE.md]

The pile of each quick case, in clay and in sand, is screwed in at the advance of its pitch and at
half of it, handed over, and loaded in compression, uplift and sideways, beside the same pile wished
in place. Each run makes a repeat with smaller finite elements and one with another transfer of the
state: the range of a ratio is the larger of what they differ by. One run after the other, each in a
folder of its own in DIR; stages that are there are not repeated.
"""

import argparse
import json
from dataclasses import replace
from pathlib import Path

from screw_pile_ratios import SOILS, overrides_of

from workflows.case import read_case
from workflows.directory import SUMMARY
from workflows.runner import run_case

RATIOS = (1.0, 0.5)
PROGRAMMES = ("release", "compression", "uplift", "lateral")
FIGURES = {"initial_stiffness": "initial stiffness", "capacity": "capacity at 0.1 D"}


def case_of(soil, ratio, turns):
    """Return the case of a run: the quick one's without the programmes that have no ratio."""
    case, _ = read_case(SOILS[soil], overrides_of(turns, ratio))
    programmes = tuple(p for p in case.service.programmes if p.name in PROGRAMMES)
    return replace(
        case,
        installation=replace(case.installation, release=True),
        service=replace(case.service, programmes=programmes),
    )


def summary_of(case, directory):
    """Return what ``summary.json`` holds of a case after all stages; what is there is kept."""
    run_case(case, directory, resume=True)
    return json.loads((directory / SUMMARY).read_text())


def rows_of(soil, ratio, summary):
    """Return the lines of the table of one run."""
    installation = summary["results"]["installation"]
    rig = f"{installation['torque_N m'] / 1e3:.1f} | {installation['crowd_force_N'] / 1e3:.0f}"
    lines = []
    for name in PROGRAMMES[1:]:
        figures = summary["results"]["service"][name]
        ratios = " | ".join(
            f"{figures['ratio'][figure]:.3f} ± {figures['ratio_range'][figure]:.3f}"
            for figure in FIGURES
        )
        lines.append(f"| {soil} | {ratio:g} | {rig} | {name} | {ratios} |")
    return lines


def main():
    """Run what is missing and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR")
    parser.add_argument("--soils", nargs="+", choices=SOILS, default=list(SOILS))
    parser.add_argument("--ratios", nargs="+", type=float, default=RATIOS)
    parser.add_argument("--turns", type=float, default=0.25)
    parser.add_argument("--page", type=Path, metavar="FILE.md")
    options = parser.parse_args()
    lines = [
        "| soil | advancement ratio | torque, kN m | crowd force, kN | load | "
        + " | ".join(FIGURES.values()) + " |",
        "|---|--:|--:|--:|---|--:|--:|",
    ]  # fmt: skip
    for soil in options.soils:
        for ratio in options.ratios:
            folder = options.output / f"{soil}, advancement ratio {ratio:g}"
            lines += rows_of(soil, ratio, summary_of(case_of(soil, ratio, options.turns), folder))
            print("\n".join(lines), flush=True)
    if options.page:
        options.page.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
