"""Interface elements on the pile: which facets lie on it, and where their points are."""

from __future__ import annotations

import numpy as np

from install_mpm.background_mesh import BackgroundMesh, facets_opposite_vertices
from install_mpm.constitutive import coulomb_interface
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.conventions import Kinematics
from install_mpm.ground import GroundProfile, geostatic_stress, undrained_shear_strength
from install_mpm.interface import InterfaceElements, InterfacePoints, facet_rule
from install_mpm.interface_axes import frames
from install_mpm.pile import Pile, PilePart, surface_normals

POINTS_PER_FACET = 3
"""Integrates the traction of a linear gap against quadratic shape functions exactly."""

ON_SURFACE = 1e-9
"""Distance in m within which a mesh node counts as lying on the pile."""


def pile_elements(mesh: BackgroundMesh, pile: Pile) -> tuple[InterfaceElements, np.ndarray]:
    """Return the interface elements on the pile and the ``PilePart`` (n_elements,) of each."""
    corners = mesh.cell_nodes[:, :3]
    ends = facets_opposite_vertices(corners)
    is_boundary = mesh.cell_neighbours < 0
    x, z = np.moveaxis(mesh.reference_nodes[ends], -1, 0)
    on_base = (np.abs(z + pile.embedment) < ON_SURFACE).all(axis=-1)
    on_shaft = (np.abs(x - pile.half_width) < ON_SURFACE).all(axis=-1)
    selected, parts = [], []
    for part, is_on in ((PilePart.BASE, on_base), (PilePart.SHAFT, on_shaft)):
        found = np.argwhere(is_boundary & is_on)
        selected.append(found)
        parts.append(np.full(len(found), int(part)))
    cell, facet = np.concatenate(selected).T
    nodes = ends[cell, facet]
    if mesh.cell_nodes.shape[1] == 6:
        # the mid-side between vertices v+1 and v+2
        nodes = np.column_stack([nodes, mesh.cell_nodes[cell, 3 + (facet + 1) % 3]])
    nodes = np.ascontiguousarray(nodes)
    shape_values, weights = facet_rule(nodes.shape[1], POINTS_PER_FACET)
    return InterfaceElements(nodes, cell, shape_values, weights), np.concatenate(parts)


def place_points(
    elements: InterfaceElements,
    mesh: BackgroundMesh,
    kinematics: Kinematics = Kinematics.PLANE_STRAIN,
) -> tuple[np.ndarray, np.ndarray]:
    """Return position (n, 2) in m and area (n,) in m^2 of the interface points.

    The area is per metre run, or around the whole circumference in axisymmetry.
    """
    corners = mesh.nodes[elements.nodes]
    position = np.einsum("qa,eai->eqi", elements.shape_values, corners)
    position = position.reshape(-1, mesh.nodes.shape[1])
    length = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)
    area = np.outer(length, elements.weights).ravel()
    if kinematics == Kinematics.AXISYMMETRIC:
        area *= 2.0 * np.pi * position[:, 0]
    return position, area


def initial_interface(
    elements: InterfaceElements,
    parts: np.ndarray,
    mesh: BackgroundMesh,
    ground: GroundProfile,
    law: CoulombInterface,
    kinematics: Kinematics = Kinematics.PLANE_STRAIN,
) -> InterfacePoints:
    """Return the interface of a pile wished in place: the geostatic traction acts on it."""
    position, area = place_points(elements, mesh, kinematics)
    part = np.repeat(parts, len(elements.weights))
    normal = surface_normals(part)
    return InterfacePoints(
        position=position,
        normal=normal,
        area=area,
        traction=geostatic_traction(ground, position, normal),
        parameters=coulomb_interface.pack(law, undrained_shear_strength(ground, position[:, -1])),
        part=part,
        covered=(position[:, -1] < 0.0).astype(np.float64),
    )


def geostatic_traction(
    ground: GroundProfile, position: np.ndarray, normal: np.ndarray
) -> np.ndarray:
    """Return the local traction (n, 2) in Pa of undisturbed ground on surfaces: t = R sigma n."""
    dim = position.shape[1]
    stress = geostatic_stress(ground, position[:, -1], dim - 1)[:, :dim, :dim]
    traction: np.ndarray = np.einsum("pij,pjk,pk->pi", frames(normal, 0.0), stress, normal)
    return traction


def follow(
    interface: InterfacePoints,
    elements: InterfaceElements,
    mesh: BackgroundMesh,
    ground: GroundProfile,
    law: CoulombInterface,
    kinematics: Kinematics = Kinematics.PLANE_STRAIN,
) -> InterfacePoints:
    """Return the interface at its place on the moved mesh, with the adhesion of that level."""
    position, area = place_points(elements, mesh, kinematics)
    strength = undrained_shear_strength(ground, position[:, -1])
    return interface._replace(
        position=position, area=area, parameters=coulomb_interface.pack(law, strength)
    )
