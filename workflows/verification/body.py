"""A body of material points on a background mesh: what the reference problems of MPM are made of.

Everything goes through the step of the installation stage; a problem adds its mesh, its soil, what
it drives and how its mesh moves.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from install_mpm.assembly import sparsity_pattern
from install_mpm.background_mesh import BackgroundMesh
from install_mpm.cells import CellType, reference_cell
from install_mpm.constitutive import dispatch
from install_mpm.conventions import GRAVITY, Kinematics
from install_mpm.discretisation import Discretisation, GeostaticGradient, Scheme
from install_mpm.equilibrium import Prescribed
from install_mpm.geostatic import geostatic_gradient
from install_mpm.ground import Ground
from install_mpm.interface import InterfaceElements, InterfacePoints, no_interface
from install_mpm.linear_solvers import mumps
from install_mpm.material_points import MaterialPoints
from install_mpm.options import Numerics
from install_mpm.pile import PileMotion
from install_mpm.seeding import seed_points
from install_mpm.step import StepResult, step

AT_REST = PileMotion(np.zeros(2))
CELL_TYPES = {3: CellType.TRI3, 6: CellType.TRI6, 4: CellType.TET4, 10: CellType.TET10}
"""By number of nodes."""

MoveMesh = Callable[[BackgroundMesh], BackgroundMesh]


class ProblemNotSolvedError(RuntimeError):
    """A step of a reference problem does not converge; the message says which."""


class Body(NamedTuple):
    """State between steps, and what does not change."""

    points: MaterialPoints
    mesh: BackgroundMesh
    interface: InterfacePoints
    start: np.ndarray
    """First trial displacement of the next step, (n_nodes, dim) in m."""
    model: Discretisation
    gradient: GeostaticGradient


def make_body(
    mesh: BackgroundMesh,
    ground: Ground,
    *,
    kinematics: Kinematics | None = None,
    scheme: Scheme = Scheme.CARRIERS,
    is_cell_weighted: bool = False,
    numerics: Numerics | None = None,
    per_direction: int = 2,
    is_soil: np.ndarray | None = None,
    interface: tuple[InterfaceElements, InterfacePoints] | None = None,
    gravity: float = GRAVITY,
) -> Body:
    """Return a body of ``ground`` in the cells ``is_soil`` (n_cells,) of ``mesh`` (default z < 0).

    Cells of two dimensions are in plane strain unless ``kinematics`` says otherwise.  With
    ``Scheme.QUADRATURE`` there is no mean dilatation and no volumetric term, as in the paper.
    """
    dim = mesh.nodes.shape[1]
    cell = reference_cell(CELL_TYPES[mesh.cell_nodes.shape[1]])
    if kinematics is None:
        kinematics = Kinematics.PLANE_STRAIN if dim == 2 else Kinematics.THREE_D
    elements, points = interface or no_interface(dim)
    pattern = sparsity_pattern([mesh.cell_nodes, elements.nodes], len(mesh.nodes), dim)
    model = Discretisation(
        cell, elements, dispatch.pack([ground.soil]), pattern, mumps(pattern),
        numerics or Numerics(), kinematics=kinematics, scheme=scheme, gravity=gravity,
        has_mean_dilatation=scheme == Scheme.CARRIERS, is_cell_weighted=is_cell_weighted,
    )  # fmt: skip
    return Body(
        seed_points(
            mesh, cell, ground, per_direction, kinematics=kinematics, is_soil=is_soil,
            gravity=gravity,
        ),
        mesh,
        points,
        np.zeros_like(mesh.nodes),
        model,
        geostatic_gradient(ground, vertical=dim - 1),
    )  # fmt: skip


def stay(mesh: BackgroundMesh) -> BackgroundMesh:
    """Return the mesh where it is."""
    return mesh


def advance(
    body: Body,
    prescribed: Prescribed,
    *,
    motion: PileMotion | None = None,
    move_mesh: MoveMesh = stay,
    name: str = "body",
) -> tuple[Body, StepResult]:
    """Return the body after a step, and the step.

    The displacement of the step is the first trial of the next one.  Without ``motion`` a pile, if
    there is one, is at rest.

    Raises
    ------
    ProblemNotSolvedError
        If the step does not converge.
    """
    motion = motion or PileMotion(np.zeros(body.mesh.nodes.shape[1]))
    result = step(
        body.points, body.mesh, body.interface, motion, prescribed, body.start,
        lambda mesh, _: move_mesh(mesh), body.model, body.gradient,
    )  # fmt: skip
    if not result.is_converged:
        residuals = " ".join(f"{value:.1e}" for value in result.equilibrium.newton.residuals)
        raise ProblemNotSolvedError(f"{name}: a step does not converge (residuals {residuals})")
    moved = body._replace(
        points=result.points,
        mesh=result.mesh,
        interface=result.interface,
        start=result.equilibrium.displacement,
    )
    return moved, result
