"""How large the case of a screw pile is and how long it takes: the mesh is really made."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from rich.console import Console
from rich.table import Table

from install_mpm.background_mesh import cell_quality
from install_mpm.cells import CellType, reference_cell, sub_region_points
from install_mpm.edge_resistance import edge_resistance
from install_mpm.screw_pile_mesh import generate_screw_mesh
from install_mpm.screw_programme import phase_length, phase_motion
from install_mpm.screw_setup import mesh_zones
from workflows.forecast import BASE_MEMORY, duration
from workflows.screw_case import ScrewCase
from workflows.screw_theory import edge_remark

# Cost model, measured with 11 500 to 27 000 unknowns on one core; good to a factor of two.
ITERATIONS = 5
"""Newton iterations of a step."""
SECONDS = 3.5e-5
"""Per iteration and unknown: kernels, assembly, factorisation."""
MEMORY_PER_DOF = 3e4
MEMORY_PER_POINT = 1.5e3


class ScrewForecast(NamedTuple):
    """Sizes and expected cost of a case."""

    nodes: int
    cells: int
    points: int
    dofs: int
    steps: int
    worst_quality: float
    memory: float
    """In bytes."""
    seconds: float


def screw_forecast(case: ScrewCase) -> ScrewForecast:
    """Return the sizes of a case and an estimate of its memory and time."""
    mesh = generate_screw_mesh(case.pile, case.box, case.background_mesh)
    centre = mesh.nodes[mesh.cell_nodes[:, :4]].mean(axis=1)
    is_soil = centre[:, 2] < 0.0
    is_far = np.linalg.norm(centre[:, :2], axis=1) > mesh_zones(case.pile, case.box).outer_radius
    cell = reference_cell(CellType.TET10)
    _, shares = sub_region_points(cell, case.background_mesh.points_per_direction)
    points = int((is_soil & ~is_far).sum()) * len(shares) + int((is_soil & is_far).sum()) * 4
    programme, dofs = case.installation, 3 * len(mesh.nodes)
    steps = sum(
        math.ceil(round(phase_length(case.pile, programme, phase) / programme.step, 9))
        for phase in programme.phases
    )
    return ScrewForecast(
        nodes=len(mesh.nodes),
        cells=len(mesh.cell_nodes),
        points=points,
        dofs=dofs,
        steps=steps,
        worst_quality=float(cell_quality(mesh).min()),
        memory=BASE_MEMORY + MEMORY_PER_DOF * dofs + MEMORY_PER_POINT * points,
        seconds=steps * ITERATIONS * dofs * SECONDS,
    )


def print_screw_forecast(
    case: ScrewCase, sizes: ScrewForecast, console: Console | None = None
) -> None:
    """Print a table of the forecast."""
    table = Table(
        title=f"{case.title}: the case is valid", title_justify="left", title_style="bold"
    )
    table.add_column("")
    table.add_column("installation (MPM)", justify="right")
    for name, value in (
        ("nodes", f"{sizes.nodes}"),
        ("quadratic tetrahedra", f"{sizes.cells}"),
        ("worst quality (1 is regular)", f"{sizes.worst_quality:.2f}"),
        ("material points", f"{sizes.points}"),
        ("degrees of freedom", f"{sizes.dofs}"),
        ("load steps", f"{sizes.steps}"),
    ):
        table.add_row(name, value)
    console = console or Console()
    console.print(table)
    first = phase_motion(case.pile, case.installation.phases[0])
    edges = edge_resistance(case.pile, case.ground, case.interface, 0.0, first)
    for remark in edge_remark(*edges):
        console.print(remark)
    console.print(
        f"memory about {sizes.memory / 1e9:.1f} GB, time about {duration(sizes.seconds)} "
        "on one core (the first run also compiles, some minutes)"
    )
