"""Advancement ratio of a screw pile: torque and crowd force in clay and in sand.

    python benchmarks/screw_pile_ratios.py -o DIR [--turns 0.25] [--page FILE.md]
        [--picture FILE.png]

The piles of the two quick cases turn with 0.5 to 1.2 times the advance of their pitch. One run
after the other, each in a folder of its own in DIR; runs that are there are not repeated, and one
that was interrupted goes on from its checkpoint: start the same command again. A quarter turn takes
about a minute in clay and three in sand.
"""

import argparse
from pathlib import Path

import numpy as np
from screw_pile_study import result_of

CASES = Path(__file__).parents[1] / "cases"
SOILS = {"clay": CASES / "screwpile_quick.toml", "sand": CASES / "screwpile_sand_quick.toml"}
RATIOS = (0.5, 0.8, 1.0, 1.2)


def overrides_of(turns, ratio):
    """Return the overrides of a run as ``KEY=VALUE``."""
    way = f"[{{name='screw in', turns={turns}, advancement_ratio={ratio}}}]"
    return ["installation.release=false", f"installation.phases={way}"]


def table(rows):
    """Return the table (Markdown) of (soil, ratio, result)."""
    lines = [
        "| soil | advancement ratio | torque, kN m | of it from normal traction | "
        "crowd force, kN | iterations | steps cut | J |",
        "|---|--:|--:|--:|--:|--:|--:|---|",
    ]
    lines += [
        f"| {soil} | {ratio:g} | {result['torque'] / 1e3:.2f} "
        f"| {result['normal_torque'] / 1e3:.2f} | {result['crowd_force'] / 1e3:.1f} "
        f"| {result['iterations']:.1f} | {100 * result['share_cut']:.0f} % "
        f"| {result['smallest_volume_ratio']:.3f} - {result['largest_volume_ratio']:.3f} |"
        for soil, ratio, result in rows
    ]
    return "\n".join(lines) + "\n"


def draw(rows, path):
    """Draw torque and crowd force against rotation, one row of panels for each soil."""
    import matplotlib.pyplot as plt

    figure, panels = plt.subplots(
        2, 2, figsize=(9, 6.5), sharex=True, layout="constrained", squeeze=False
    )
    for soil, ratio, result in rows:
        for axes, name in zip(
            panels[list(SOILS).index(soil)], ("torque", "crowd_force"), strict=True
        ):
            axes.plot(
                result["rotation_history"], np.array(result[f"{name}_history"]) / 1e3,
                label=f"{ratio:g}",
            )  # fmt: skip
    for soil, (torque, force) in zip(SOILS, panels, strict=True):
        torque.set_ylabel(f"{soil}: torque (kN m)")
        force.set_ylabel(f"{soil}: crowd force (kN)")
        torque.set_ylim(bottom=0.0)
        force.axhline(0.0, color="black", linewidth=0.8)
        for axes in (torque, force):
            axes.grid(alpha=0.3)
    for axes in panels[-1]:
        axes.set_xlabel("rotation (degrees)")
    panels[0, 0].legend(title="advancement ratio", fontsize=8, loc="lower right")
    figure.savefig(path, dpi=110)


def main():
    """Run what is missing and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR")
    parser.add_argument("--turns", type=float, default=0.25)
    parser.add_argument("--page", type=Path, metavar="FILE.md")
    parser.add_argument("--picture", type=Path, metavar="FILE.png")
    options = parser.parse_args()
    rows = []
    for soil, case in SOILS.items():
        for ratio in RATIOS:
            folder = options.output / f"{soil}, advancement ratio {ratio:g}"
            overrides = overrides_of(options.turns, ratio)
            rows.append((soil, ratio, result_of(folder, overrides, case)))
            print(table(rows[-1:]), flush=True)
    print(table(rows))
    if options.page:
        options.page.write_text(table(rows))
    if options.picture:
        draw(rows, options.picture)


if __name__ == "__main__":
    main()
