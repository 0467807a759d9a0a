"""The problem of an installation: what does not change while the pile goes down, and its start."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from install_mpm import pile_surface
from install_mpm.assembly import sparsity_pattern
from install_mpm.background_mesh import BackgroundMesh
from install_mpm.cells import CellType, reference_cell
from install_mpm.constitutive import dispatch
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.conventions import Kinematics
from install_mpm.discretisation import Discretisation, GeostaticGradient, Scheme
from install_mpm.geostatic import geostatic_gradient
from install_mpm.ground import GroundProfile, boundary_depths, soils_of
from install_mpm.history import History, empty_history
from install_mpm.interface import InterfacePoints
from install_mpm.linear_solvers import SOLVERS
from install_mpm.mesh_generation import generate_background_mesh
from install_mpm.options import (
    BackgroundMeshOptions,
    Box,
    DiscretisationOptions,
    InstallationProgramme,
    Numerics,
)
from install_mpm.pile import Pile
from install_mpm.seeding import seed_points
from install_mpm.state_file import STEPS_BEFORE_GROWTH, InstalledState, PileState, StepControl

ON_BOUNDARY = 1e-9
"""Distance in m within which a node counts as lying on a side of the box."""


DEFAULT_DISCRETISATION = DiscretisationOptions()


class Installation(NamedTuple):
    """The problem: everything that does not change while the pile goes down."""

    ground: GroundProfile
    pile: Pile
    law: CoulombInterface
    box: Box
    mesh_options: BackgroundMeshOptions
    programme: InstallationProgramme
    numerics: Numerics
    model: Discretisation
    parts: np.ndarray
    supports: np.ndarray
    gradient: GeostaticGradient
    discretisation: DiscretisationOptions
    reference_depth: float
    """Depth of the tip in m at which the mesh was made: its nodes are then the reference nodes."""


def set_up(
    ground: GroundProfile,
    pile: Pile,
    law: CoulombInterface,
    box: Box,
    mesh_options: BackgroundMeshOptions,
    programme: InstallationProgramme,
    numerics: Numerics,
    mesh: BackgroundMesh,
    kinematics: Kinematics = Kinematics.PLANE_STRAIN,
    discretisation: DiscretisationOptions = DEFAULT_DISCRETISATION,
) -> Installation:
    """Return the problem on a given mesh: interface, sparsity, solver and supports."""
    reference_depth = tip_depth_of_reference(mesh)
    elements, parts = pile_surface.pile_elements(mesh, replace(pile, embedment=reference_depth))
    scheme = Scheme(discretisation.scheme)
    pattern = sparsity_pattern([mesh.cell_nodes, elements.nodes], len(mesh.nodes), 2)
    model = Discretisation(
        cell=reference_cell(cell_type_of(discretisation)),
        elements=elements,
        materials=dispatch.pack(soils_of(ground)),
        pattern=pattern,
        solve=SOLVERS[numerics.linear_solver](pattern),
        numerics=numerics,
        kinematics=kinematics,
        has_mean_dilatation=scheme == Scheme.CARRIERS,
        scheme=scheme,
        is_cell_weighted=discretisation.cell_weighted,
    )
    return Installation(
        ground, pile, law, box, mesh_options, programme, numerics, model, parts,
        supports=_supports(mesh, box),
        gradient=geostatic_gradient(ground, vertical=1),
        discretisation=discretisation,
        reference_depth=reference_depth,
    )  # fmt: skip


def set_up_at(
    problem: Installation, tip_depth: float
) -> tuple[Installation, BackgroundMesh, InterfacePoints]:
    """Return problem, mesh and interface anew, with the mesh made for the tip at ``tip_depth`` m.

    The interface carries the geostatic traction.
    """
    kinematics, discretisation = problem.model.kinematics, problem.discretisation
    pile = replace(problem.pile, embedment=tip_depth)
    mesh = generate_background_mesh(
        pile,
        problem.box,
        problem.mesh_options,
        boundary_depths(problem.ground),
        cell_type_of(discretisation),
    )
    renewed = set_up(
        problem.ground, problem.pile, problem.law, problem.box, problem.mesh_options,
        problem.programme, problem.numerics, mesh, kinematics, discretisation,
    )  # fmt: skip
    interface = pile_surface.initial_interface(
        renewed.model.elements, renewed.parts, mesh, problem.ground, problem.law, kinematics
    )
    return renewed, mesh, interface


def cell_type_of(discretisation: DiscretisationOptions) -> CellType:
    """Return the type of the cells of the background mesh."""
    return CellType[discretisation.cells.upper()]


def tip_depth_of_reference(mesh: BackgroundMesh) -> float:
    """Return the depth in m of the pile's tip in the reference mesh: the top of its axis."""
    x, z = mesh.reference_nodes.T
    return float(-z[np.abs(x) < ON_BOUNDARY].max())


def _supports(mesh: BackgroundMesh, box: Box) -> np.ndarray:
    """Return which dofs are held, (n_nodes, 2): rollers on axis and side, fixed bottom."""
    x, z = mesh.reference_nodes.T
    is_held = np.zeros(mesh.nodes.shape, dtype=bool)
    is_held[:, 0] = (np.abs(x) < ON_BOUNDARY) | (np.abs(x - box.width) < ON_BOUNDARY)
    is_held[np.abs(z + box.depth) < ON_BOUNDARY] = True
    return is_held


def geostatic_state(
    problem: Installation, mesh: BackgroundMesh, per_direction: int, case_text: str
) -> InstalledState:
    """Return the undisturbed ground with the pile wished in place at its starting depth."""
    model = problem.model
    interface = pile_surface.initial_interface(
        model.elements, problem.parts, mesh, problem.ground, problem.law, model.kinematics
    )
    return InstalledState(
        material_points=seed_points(
            mesh, model.cell, problem.ground, per_direction, kinematics=model.kinematics
        ),
        background_mesh=mesh,
        interface=interface,
        pile=PileState(np.array(0.0), np.array(0.0), np.array(problem.pile.embedment), np.zeros(2)),
        history=empty_history(History),
        control=StepControl(
            np.array(problem.programme.step),
            np.array(0),
            np.array(STEPS_BEFORE_GROWTH),
            np.array(STEPS_BEFORE_GROWTH),
            np.zeros_like(mesh.nodes),
        ),
        case_text=case_text,
        kinematics=model.kinematics,
    )
