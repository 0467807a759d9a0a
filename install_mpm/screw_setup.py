"""The problem of a screw pile installation: what does not change while the pile goes down."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm import screw_surface
from install_mpm.assembly import sparsity_pattern
from install_mpm.background_mesh import BackgroundMesh
from install_mpm.cells import CellType, reference_cell
from install_mpm.constitutive import dispatch
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.conventions import Kinematics
from install_mpm.discretisation import Discretisation, GeostaticGradient
from install_mpm.exact_patches import strength_shares
from install_mpm.geostatic import geostatic_gradient
from install_mpm.ground import GroundProfile, soils_of
from install_mpm.history import empty_history
from install_mpm.linear_solvers import SOLVERS
from install_mpm.material_points import MaterialPoints
from install_mpm.mesh_motion import ScrewZones, screw
from install_mpm.options import Box, Numerics, ScrewMeshOptions
from install_mpm.screw_history import ScrewHistory
from install_mpm.screw_pile import ScrewPile
from install_mpm.screw_pile_mesh import WALL_SIDES
from install_mpm.screw_programme import Pose, ScrewProgramme, rim_radius
from install_mpm.seeding import seed_points
from install_mpm.state_file import STEPS_BEFORE_GROWTH, InstalledState, PileState, StepControl

ON_BOUNDARY = 1e-9
"""Distance in m within which a node counts as lying on a side of the box."""

RIGID_MARGIN = 0.25
"""Diameters of the largest plate around the pile within which the mesh moves as one with it."""


class ScrewInstallation(NamedTuple):
    """The problem: everything that does not change while the pile goes down."""

    ground: GroundProfile
    pile: ScrewPile
    law: CoulombInterface
    box: Box
    programme: ScrewProgramme
    numerics: Numerics
    model: Discretisation
    gradient: GeostaticGradient
    supports: np.ndarray
    zones: ScrewZones
    part: np.ndarray
    """Part of the pile surface of each interface element, (n_elements,)."""
    normals: np.ndarray
    """Of the interface points at zero pile motion, (n_points, 3)."""
    strength_share: np.ndarray
    """Of the exact surface at the interface points, (n_points,), see ``exact_patches``."""


def set_up(
    ground: GroundProfile,
    pile: ScrewPile,
    law: CoulombInterface,
    box: Box,
    programme: ScrewProgramme,
    numerics: Numerics,
    mesh: BackgroundMesh,
) -> ScrewInstallation:
    """Return the problem on a given mesh: interface, sparsity, solver and supports."""
    elements, part, normals = screw_surface.pile_elements(mesh, pile)
    pattern = sparsity_pattern([mesh.cell_nodes, elements.nodes], len(mesh.nodes), 3)
    model = Discretisation(
        cell=reference_cell(CellType.TET10),
        elements=elements,
        materials=dispatch.pack(soils_of(ground)),
        pattern=pattern,
        solve=SOLVERS[numerics.linear_solver](pattern),
        numerics=numerics,
        kinematics=Kinematics.THREE_D,
        compares_resultants=True,
    )
    return ScrewInstallation(
        ground, pile, law, box, programme, numerics, model,
        gradient=geostatic_gradient(ground, vertical=2),
        supports=_supports(mesh, box),
        zones=mesh_zones(pile, box),
        part=part,
        normals=normals,
        strength_share=strength_shares(pile, elements, part, mesh.reference_nodes),
    )  # fmt: skip


def mesh_zones(pile: ScrewPile, box: Box) -> ScrewZones:
    """Return where the mesh moves with the pile: all around it, tapering to the outer wall."""
    rim = rim_radius(pile)
    margin = RIGID_MARGIN * 2.0 * rim
    inner = rim + margin
    tops = [pile.leading_level(helix) + helix.pitch * helix.turns for helix in pile.helices]
    upper = max([-pile.embedment + pile.tip_length, *tops])
    wall = box.width * np.cos(np.pi / WALL_SIDES)
    return ScrewZones(
        inner_radius=inner,
        outer_radius=wall - margin,
        rigid_levels=(-pile.embedment - margin, upper + margin),
        fixed_levels=(-box.depth, box.headroom),
    )


def lowest_tip(pile: ScrewPile, box: Box) -> float:
    """Return the largest depth in m of the tip: a diameter above the bottom of the box."""
    return box.depth - 2.0 * rim_radius(pile)


def move_mesh(problem: ScrewInstallation, mesh: BackgroundMesh, pose: Pose) -> BackgroundMesh:
    """Return the mesh of a pile in a ``pose``, wound back by whole reset angles."""
    wound = wound_back(problem, pose.rotation)
    return screw(mesh, pose.advance, pose.rotation, wound, problem.zones)


def wound_back(problem: ScrewInstallation, rotation: float) -> float:
    """Return the angle in rad by which the mesh of a pile that has turned is wound back."""
    reset = problem.programme.reset_angle
    return float(reset * np.round(rotation / reset))


def _supports(mesh: BackgroundMesh, box: Box) -> np.ndarray:
    """Return which dofs are held, (n_nodes, 3): horizontally at the outer wall, all at the base."""
    x, y, z = mesh.reference_nodes.T
    half_side = np.pi / WALL_SIDES
    angle = np.mod(np.arctan2(y, x), 2.0 * half_side) - half_side
    distance = np.hypot(x, y) * np.cos(angle)
    is_held = np.zeros(mesh.nodes.shape, dtype=bool)
    is_held[distance > box.width * np.cos(half_side) - ON_BOUNDARY, :2] = True
    is_held[np.abs(z + box.depth) < ON_BOUNDARY] = True
    return is_held


def geostatic_state(
    problem: ScrewInstallation, mesh: BackgroundMesh, options: ScrewMeshOptions, case_text: str
) -> InstalledState:
    """Return the undisturbed ground with the pile wished in place at its starting depth."""
    return InstalledState(
        material_points=seed(problem, mesh, options.points_per_direction),
        background_mesh=mesh,
        interface=screw_surface.initial_interface(
            problem.model.elements, problem.part, problem.normals, mesh, problem.ground,
            problem.law, problem.strength_share,
        ),
        pile=PileState(np.array(0.0), np.array(0.0), np.array(problem.pile.embedment), np.zeros(3)),
        history=empty_history(ScrewHistory),
        control=StepControl(
            np.array(problem.programme.step), np.array(0), np.array(STEPS_BEFORE_GROWTH),
            np.array(STEPS_BEFORE_GROWTH), np.zeros_like(mesh.nodes),
        ),
        case_text=case_text,
        kinematics=Kinematics.THREE_D,
    )  # fmt: skip


def seed(problem: ScrewInstallation, mesh: BackgroundMesh, per_direction: int) -> MaterialPoints:
    """Return the material points: as many as asked where the mesh moves, few in the far field."""
    vertices = mesh.nodes[mesh.cell_nodes[:, :4]]
    is_soil = vertices[:, :, 2].mean(axis=1) < 0.0
    radius = np.linalg.norm(vertices.mean(axis=1)[:, :2], axis=1)
    is_far = radius > problem.zones.outer_radius
    cell, ground = problem.model.cell, problem.ground
    near = seed_points(
        mesh, cell, ground, per_direction, kinematics=Kinematics.THREE_D, is_soil=is_soil & ~is_far
    )
    if not is_far.any():
        return near
    far = seed_points(
        mesh, cell, ground, 1, kinematics=Kinematics.THREE_D, is_soil=is_soil & is_far
    )
    return MaterialPoints(*(np.concatenate(pair) for pair in zip(near, far, strict=True)))
