"""Pictures of the paper's penetrating pile, drawn like the figures that they stand for.

python -m workflows.verification.paper_figures [DIRECTORY]
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.discretisation import Scheme
from install_mpm.material_points import MaterialPoints
from workflows.environment import prepare
from workflows.report_style import MUTED, grid, panels, png_of, styled
from workflows.verification.paper_friction import friction_law, friction_problem
from workflows.verification.paper_penetration import elastic_law
from workflows.verification.penetration import Penetration, PenetrationResult, penetrate

DIRECTORY = Path("docs/images/paper")
COLOURS = "jet"
"""The paper's own colour map, so that the pictures can be laid side by side."""


def draw_state(
    axes: Any, problem: Penetration, points: MaterialPoints, mesh: BackgroundMesh, tip_depth: float
) -> Any:
    """Draw mesh, pile and material points by vertical displacement; heights from the bottom."""
    shift = np.array([0.0, problem.depth])
    cells = mesh.nodes[mesh.cell_nodes[:, :3]] + shift
    axes.add_collection(PolyCollection(cells, facecolors="none", edgecolors=MUTED, linewidths=0.3))
    axes.add_patch(
        Rectangle((0.0, problem.depth - tip_depth), problem.half_width, tip_depth, color="black")
    )
    x, y = (points.position + shift).T
    drawn = axes.scatter(
        x, y, c=points.displacement[:, 1], s=2.0, cmap=COLOURS, vmin=-4.0, vmax=0.0, linewidths=0
    )
    axes.set(xlim=(0.0, problem.width), ylim=(0.0, problem.depth), aspect="equal", xlabel="x (m)")
    return drawn


def states(panel_list: list[tuple[str, Penetration, PenetrationResult]], *, has_start: bool) -> Any:
    """Return the figure of the final states of runs, the first one's initial state before them."""
    columns = len(panel_list) + has_start
    figure, axes = panels(1, columns, 2.1 * columns + 0.9, 5.6, sharey=True)
    row = list(axes[0])
    if has_start:
        _, problem, result = panel_list[0]
        draw_state(row[0], problem, *result.start, problem.embedment)
        row[0].set_title("initial")
    for place, (title, problem, result) in zip(row[has_start:], panel_list, strict=True):
        depth = problem.embedment + result.penetration[-1]
        drawn = draw_state(place, problem, result.body.points, result.body.mesh, depth)
        place.set_title(title)
    row[0].set_ylabel("y (m)")
    figure.colorbar(drawn, ax=row, label="vertical displacement (m)", shrink=0.7)
    return figure


def curves(runs: list[tuple[str, PenetrationResult]]) -> Figure:
    """Return the reactions over penetration."""
    figure, axes = panels(1, 1, 5.5, 3.6)
    for name, result in runs:
        axes[0, 0].plot(
            np.append(0.0, result.penetration), np.append(0.0, result.reaction) / 1e3, label=name
        )
    axes[0, 0].set(xlabel="penetration (m)", ylabel="reaction on the half pile (kN/m)")
    axes[0, 0].legend()
    grid(axes[0, 0])
    return figure


def pictures() -> dict[str, Figure]:
    """Return all pictures by file name."""
    problems = {
        "roller side": Penetration(),
        "fixed side": Penetration(is_side_fixed=True),
        "roller side, TRI6 carriers": Penetration(scheme=Scheme.CARRIERS),
        "large $k_s$": Penetration(law=elastic_law(1e8, 1e7)),
        "small $k_s$": Penetration(law=elastic_law(1e8, 1e1)),
        "friction, h = 0.5 m": friction_problem(friction_law()),
        "friction, h = 1/3 m": friction_problem(friction_law(), h=1.0 / 3.0),
    }
    results = {name: penetrate(problem) for name, problem in problems.items()}
    made = {}
    names = list(problems)
    for file, chosen, has_start in (
        ("fig6.png", names[:3], True),
        ("fig8.png", names[3:5], False),
        ("friction.png", names[5:], False),
    ):
        runs = [(name, problems[name], results[name]) for name in chosen]
        made[file] = states(runs, has_start=has_start)
    made["reactions.png"] = curves(list(results.items()))
    return made


def main() -> None:
    """Write the pictures."""
    directory = Path(sys.argv[1]) if len(sys.argv) > 1 else DIRECTORY
    prepare()
    directory.mkdir(parents=True, exist_ok=True)
    with styled():
        for name, figure in pictures().items():
            (directory / name).write_bytes(png_of(figure))


if __name__ == "__main__":
    main()
