"""How large a case is and how long it takes: meshes are really made, the rest is estimated."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from rich.console import Console
from rich.table import Table

from install_mpm.conventions import dimension
from service_fe.loading import imposed_steps
from service_fe.rigid_pile import n_motions
from workflows.case import Case

# Cost model, measured with 4 300 to 28 100 unknowns on a 2-core machine that was also doing other
# work; everything compiled, OpenBLAS, MUMPS.  Good to a factor of two; cut steps come on top.
INSTALL_ITERATIONS = 6
"""Newton iterations of a step of the installation."""
INSTALL_SECONDS = 1.5e-5
"""Per iteration and unknown: assembly, factorisation, stress update."""
SERVICE_ITERATIONS = 3
SERVICE_SECONDS = 6.5e-6
OTHER_SECONDS = 15.0
"""Loading libraries, meshes, hand-over, report."""
BASE_MEMORY = 7e8
"""Python with all libraries, in bytes."""
MEMORY_PER_DOF = 2e3
MEMORY_PER_POINT = 5e2


class Forecast(NamedTuple):
    """Sizes and expected cost of a case."""

    background_nodes: int
    background_cells: int
    material_points: int
    install_dofs: int
    install_steps: int
    fe_nodes: int
    fe_cells: int
    service_dofs: int
    service_steps: int
    memory: float
    """Largest memory in bytes."""
    seconds: float
    """Wall time on two cores once everything is compiled."""


def forecast(case: Case) -> Forecast:
    """Return the sizes of a case and an estimate of its memory and time."""
    from handoff.fe_mesh import make_mesh
    from handoff.surface import level_surface
    from install_mpm.cells import CellType, reference_cell, sub_region_points
    from install_mpm.ground import boundary_depths
    from install_mpm.mesh_generation import generate_background_mesh

    layers, cells = boundary_depths(case.ground), CellType[case.discretisation.cells.upper()]
    mesh = generate_background_mesh(case.pile, case.box, case.background_mesh, layers, cells)
    fe_mesh = make_mesh(
        case.pile, case.final_tip_depth, case.box, case.handoff, level_surface(), layers
    )
    heights = mesh.nodes[mesh.cell_nodes[:, :3], 1].mean(axis=1)
    _, shares = sub_region_points(reference_cell(cells), case.background_mesh.points_per_direction)
    n_points = int((heights < 0.0).sum()) * len(shares)
    dim = dimension(case.kinematics)
    dofs, fe_dofs = dim * len(mesh.nodes), dim * len(fe_mesh.nodes)
    steps = math.ceil(round(case.installation.penetration / case.installation.step, 9))
    load = np.ones(n_motions(2))
    service_steps = sum(
        len(imposed_steps(programme, load)) for programme in case.service.programmes
    )
    install_time = steps * INSTALL_ITERATIONS * dofs * INSTALL_SECONDS
    service_time = 2 * service_steps * SERVICE_ITERATIONS * fe_dofs * SERVICE_SECONDS
    return Forecast(
        background_nodes=len(mesh.nodes),
        background_cells=len(mesh.cell_nodes),
        material_points=n_points,
        install_dofs=dofs,
        install_steps=steps,
        fe_nodes=len(fe_mesh.nodes),
        fe_cells=len(fe_mesh.cell_nodes),
        service_dofs=fe_dofs,
        service_steps=service_steps,
        memory=BASE_MEMORY + MEMORY_PER_DOF * max(dofs, fe_dofs) + MEMORY_PER_POINT * n_points,
        seconds=OTHER_SECONDS + install_time + service_time,
    )


def print_forecast(case: Case, sizes: Forecast, console: Console | None = None) -> None:
    """Print a table of the forecast."""
    table = Table(
        title=f"{case.title}: the case is valid", title_justify="left", title_style="bold"
    )
    table.add_column("")
    table.add_column("installation (MPM)", justify="right")
    table.add_column("service (FE)", justify="right")
    rows = (
        ("nodes", sizes.background_nodes, sizes.fe_nodes),
        ("cells", sizes.background_cells, sizes.fe_cells),
        ("material points", sizes.material_points, ""),
        ("degrees of freedom", sizes.install_dofs, sizes.service_dofs),
        ("load steps", sizes.install_steps, f"2 x {sizes.service_steps}"),
    )
    for name, install, service in rows:
        table.add_row(name, str(install), str(service))
    console = console or Console()
    console.print(table)
    console.print(
        f"memory about {sizes.memory / 1e9:.1f} GB, time about {duration(sizes.seconds)} "
        "on two cores (the first run also compiles, a minute or two)"
    )


def duration(seconds: float) -> str:
    """Return a time in s as text, in minutes if it is long."""
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.1f} min"
