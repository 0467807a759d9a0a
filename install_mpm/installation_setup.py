"""The problem of an installation: what does not change while the pile goes down, and its start."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm import pile_surface
from install_mpm.assembly import sparsity_pattern
from install_mpm.background_mesh import BackgroundMesh
from install_mpm.cells import CellType, reference_cell
from install_mpm.constitutive import dispatch
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.conventions import Kinematics
from install_mpm.discretisation import Discretisation, GeostaticGradient
from install_mpm.geostatic import geostatic_gradient
from install_mpm.ground import GroundProfile, soils_of
from install_mpm.history import empty_history
from install_mpm.linear_solvers import SOLVERS
from install_mpm.options import BackgroundMeshOptions, Box, InstallationProgramme, Numerics
from install_mpm.pile import Pile
from install_mpm.seeding import seed_points
from install_mpm.state_file import InstalledState, PileState, StepControl

ON_BOUNDARY = 1e-9
"""Distance in m within which a node counts as lying on a side of the box."""


class Installation(NamedTuple):
    """The problem: everything that does not change while the pile goes down."""

    ground: GroundProfile
    pile: Pile
    law: CoulombInterface
    box: Box
    rigid_zone: float
    programme: InstallationProgramme
    numerics: Numerics
    model: Discretisation
    parts: np.ndarray
    supports: np.ndarray
    gradient: GeostaticGradient


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
) -> Installation:
    """Return the problem on a given mesh: interface, sparsity, solver and supports."""
    elements, parts = pile_surface.pile_elements(mesh, pile)
    pattern = sparsity_pattern([mesh.cell_nodes, elements.nodes], len(mesh.nodes), 2)
    model = Discretisation(
        cell=reference_cell(CellType.TRI6),
        elements=elements,
        materials=dispatch.pack(soils_of(ground)),
        pattern=pattern,
        solve=SOLVERS[numerics.linear_solver](pattern),
        numerics=numerics,
        kinematics=kinematics,
    )
    return Installation(
        ground, pile, law, box, mesh_options.rigid_zone, programme, numerics, model, parts,
        supports=_supports(mesh, box),
        gradient=geostatic_gradient(ground, vertical=1),
    )  # fmt: skip


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
        history=empty_history(),
        control=StepControl(
            np.array(problem.programme.step), np.array(0), np.array(0), np.zeros_like(mesh.nodes)
        ),
        case_text=case_text,
        kinematics=model.kinematics,
    )
