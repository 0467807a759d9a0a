"""Convergence study of a screw pile: torque and crowd force against mesh, step and parameters.

    python benchmarks/screw_pile_study.py -o DIR [--turns 1] [--mesh fine] [--only NAME ...]
        [--page FILE.md] [--picture FILE.png]

One run after the other, each in a folder of its own in DIR. A run that is there already is not
repeated, and one that was interrupted goes on from its checkpoint: start the same command again.
``--only`` takes groups ("volumetric term") and runs of them ("volumetric term 0.05 E").
``--mesh`` is the mesh on which everything but the mesh itself is varied; a study of a whole turn
on the fine mesh takes some three hours of one processor, one of 15 degrees on the coarse mesh
(``--turns 0.0417 --mesh coarse``) some minutes.
"""

import argparse
import json
import os
import sys
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("MPLBACKEND", "Agg")

import numpy as np

from install_mpm.state_file import read_installed_state
from workflows.case import read_case, sections_text
from workflows.directory import INSTALL_KEYS, INSTALLED
from workflows.runner import run_from_case
from workflows.screw_theory import part_torques

CASE = Path(__file__).parents[1] / "cases" / "screwpile_quick.toml"
RESULT = "result.json"

MESHES = {
    "coarse": ("0.2 m", "0.4 m", "0.35 m"),
    "medium": ("0.14 m", "0.3 m", "0.25 m"),
    "fine": ("0.1 m", "0.25 m", "0.18 m"),
}
"""Cell sizes at edges, plate and shaft."""

GROUPS = {
    "mesh": {name: {} for name in MESHES},
    "seed of the mesh": {"1": {"background_mesh.random_seed": "1"}},
    "step": {"11 mm": {"installation.step": "'11 mm'"}},
    "volumetric term": {
        "0.05 E": {"numerics.volumetric_term": "0.05"},
        "0.2 E": {"numerics.volumetric_term": "0.2"},
    },
    "interface stiffness": {
        "halved": {
            "interface.normal_stiffness": "'50 MPa/m'",
            "interface.shear_stiffness": "'5 MPa/m'",
        },
        "doubled": {
            "interface.normal_stiffness": "'200 MPa/m'",
            "interface.shear_stiffness": "'20 MPa/m'",
        },
    },
    "fill threshold": {"0.5": {"numerics.fill_threshold": "0.5"}},
    "soft stiffness": {"0.01": {"numerics.soft_stiffness": "0.01"}},
    "reset angle": {"15 deg": {"installation.reset_angle": "'15 deg'"}},
    "points per cell": {"4": {"background_mesh.points_per_direction": "1"}},
    "advancement ratio": {ratio: {"ratio": ratio} for ratio in ("0.5", "0.8", "1.2")},
}
"""What is varied: per group and value the keys of the case, beside those of the reference run."""

NAMES = [*GROUPS, *(f"{group} {value}" for group in GROUPS for value in GROUPS[group])]
"""What ``--only`` takes."""


def overrides_of(mesh, turns, changes):
    """Return the overrides of a run as ``KEY=VALUE``."""
    ratio = changes.get("ratio", "1.0")
    sizes = zip(("edges", "plate", "shaft"), MESHES[mesh], strict=True)
    values = {f"background_mesh.size_at_{place}": f"'{size}'" for place, size in sizes}
    values["installation.release"] = "false"
    values["installation.phases"] = (
        f"[{{name='screw in', turns={turns}, advancement_ratio={ratio}}}]"
    )
    values |= {key: value for key, value in changes.items() if key != "ratio"}
    return [f"{key}={value}" for key, value in values.items()]


def runs(mesh, turns, only):
    """Return the runs as (group, value, folder, overrides); the reference run comes first."""
    found = [("mesh", mesh, mesh, overrides_of(mesh, turns, {}))]
    for group, values in GROUPS.items():
        for value, changes in values.items():
            if only and not {group, f"{group} {value}"} & set(only):
                continue
            own = value if group == "mesh" else mesh
            folder = own if group == "mesh" else f"{mesh}, {group} {value}"
            if folder != mesh:
                found.append((group, value, folder, overrides_of(own, turns, changes)))
    return found


def result_of(directory, overrides, case_file=CASE):
    """Return the figures of a run, which is made first if it is not there."""
    case, _ = read_case(case_file, overrides)
    file, text = directory / RESULT, sections_text(case, INSTALL_KEYS)
    if file.exists():
        stored = json.loads(file.read_text())
        if stored["case"] != text:
            sys.exit(f"{file} belongs to another study; give another output directory")
        return stored
    run_from_case("install", case, directory, resume=True)
    result = figures_of(case.pile, read_installed_state(directory / INSTALLED)) | {"case": text}
    file.write_text(json.dumps(result, indent=2) + "\n")
    return result


def figures_of(pile, state):
    """Return what a run found, in its last step of full size and over its steps.

    What is left for the very last step is shorter, and the volumetric term less in it.
    """
    history = state.history
    size = np.diff(history.travel)
    last = int(np.flatnonzero(size > 0.99 * size.max())[-1]) + 1
    parts = part_torques(pile, state, None)
    return {
        "smallest_volume_ratio": float(history.smallest_volume_ratio.min()),
        "largest_volume_ratio": float(history.largest_volume_ratio.max()),
        "deviations": {part.name: part.deviation for part in parts if part.closed_form is not None},
        "degrees": abs(float(np.degrees(history.rotation[last]))),
        "torque": float(history.torque[last]),
        "normal_torque": float(history.part_normal_torque[last].sum()),
        "crowd_force": float(history.crowd_force[last]),
        "cells": len(state.background_mesh.cell_nodes),
        "points": len(state.material_points.mass),
        "iterations": float(history.iterations[1:].mean()),
        "share_cut": float(np.mean(history.cuts[1:] > 0)),
        "largest_residual": float(history.residual.max()),
        "rotation_history": np.abs(np.degrees(history.rotation)).tolist(),
        "torque_history": history.torque.tolist(),
        "crowd_force_history": history.crowd_force.tolist(),
    }


def table(rows):
    """Return the table (Markdown) of (group, value, result); the first row is the reference."""
    lines = [
        "| varied | value | cells | torque, kN m | change | of it from normal traction | "
        "crowd force, kN | change | part farthest from its closed form | iterations | steps cut |",
        "|---|---|--:|--:|--:|--:|--:|--:|---|--:|--:|",
    ]
    reference = rows[0][2]
    for group, value, result in rows:
        lines.append(
            f"| {group} | {value} | {result['cells']:,} | {result['torque'] / 1e3:.2f} "
            f"| {_change(result, reference, 'torque')} | {result['normal_torque'] / 1e3:.2f} "
            f"| {result['crowd_force'] / 1e3:.2f} | {_change(result, reference, 'crowd_force')} "
            f"| {_farthest(result['deviations'])} | {result['iterations']:.1f} "
            f"| {100 * result['share_cut']:.0f} % |"
        )
    return "\n".join(lines) + "\n"


def _farthest(deviations):
    name = max(deviations, key=lambda part: abs(deviations[part]))
    return f"{name} {100 * deviations[name]:+.1f} %"


def _change(result, reference, name):
    if result is reference:
        return ""
    return f"{100 * (result[name] / reference[name] - 1):+.1f} %"


def draw(rows, path):
    """Draw torque and crowd force of all runs against rotation."""
    import matplotlib.pyplot as plt

    figure, panels = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    labels = (("torque_history", "torque (kN m)"), ("crowd_force_history", "crowd force (kN)"))
    for axes, (name, label) in zip(panels, labels, strict=True):
        for number, (group, value, result) in enumerate(rows):
            axes.plot(
                result["rotation_history"], np.array(result[name]) / 1e3,
                color=plt.get_cmap("tab20")(number % 20), label=f"{group} {value}",
                linewidth=2.5 if number == 0 else 1.0,
            )  # fmt: skip
        axes.set_xlabel("rotation (degrees)")
        axes.set_ylabel(label)
        axes.grid(alpha=0.3)
    panels[0].set_ylim(bottom=0.0)
    panels[1].legend(fontsize=7, loc="center left", bbox_to_anchor=(1.0, 0.5))
    figure.savefig(path, dpi=110)


def main():
    """Run what is missing and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR")
    parser.add_argument("--turns", type=float, default=1.0)
    parser.add_argument("--mesh", choices=MESHES, default="fine")
    parser.add_argument("--only", nargs="+", choices=NAMES, metavar="NAME")
    parser.add_argument("--page", type=Path, metavar="FILE.md")
    parser.add_argument("--picture", type=Path, metavar="FILE.png")
    options = parser.parse_args()
    rows = []
    for group, value, folder, overrides in runs(options.mesh, options.turns, options.only):
        rows.append((group, value, result_of(options.output / folder, overrides)))
        print(table(rows[:1] if len(rows) == 1 else [rows[0], rows[-1]]), flush=True)
    text = table(rows)
    print(text)
    if options.page:
        options.page.write_text(text)
    if options.picture:
        draw(rows, options.picture)


if __name__ == "__main__":
    main()
