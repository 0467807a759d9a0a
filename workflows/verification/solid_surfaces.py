"""Interface elements between soil and a rigid body of revolution or a helicoid, in space.

Every surface here is swept: a rotation of the body maps it onto itself, so the soil meets the exact
normal of the place where it is, and the normals follow from the places alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from install_mpm.background_mesh import (
    BackgroundMesh,
    facet_edge_nodes,
    facets_opposite_vertices,
)
from install_mpm.constitutive import coulomb_interface
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.interface import InterfaceElements, InterfacePoints, facet_rule
from install_mpm.screw_surface import place_points

Normals = Callable[[np.ndarray], np.ndarray]
"""Exact normals (n, 3), from soil to body, at places (n, 3) in m."""


def surface_elements(
    mesh: BackgroundMesh, is_on: np.ndarray, *, is_swept: bool = True
) -> InterfaceElements:
    """Return the elements of boundary facets whose vertices all are nodes with ``is_on``."""
    vertices = facets_opposite_vertices(mesh.cell_nodes[:, :4])
    cell, facet = np.nonzero(is_on[vertices].all(axis=-1) & (mesh.cell_neighbours < 0))
    nodes = np.hstack([vertices[cell, facet], facet_edge_nodes(mesh, cell, facet)])
    elements = InterfaceElements(nodes, cell, *facet_rule(6, 3))
    return elements._replace(is_swept=np.full(3 * len(cell), is_swept))


def rigid_surface(
    mesh: BackgroundMesh,
    elements: InterfaceElements,
    normals: Normals,
    law: CoulombInterface,
    strength: float = 0.0,
    pressure: float = 0.0,
) -> InterfacePoints:
    """Return interface points beside soil of undrained ``strength`` under ``pressure``, in Pa."""
    position, area, _ = place_points(elements, mesh)
    n_points = len(position)
    traction = np.zeros((n_points, 3))
    traction[:, 2] = -pressure
    return InterfacePoints(
        position=position,
        normal=normals(position),
        area=area,
        traction=traction,
        parameters=coulomb_interface.pack(law, np.full(n_points, strength)),
        part=np.zeros(n_points, dtype=np.int64),
        covered=np.ones(n_points),
    )


def placed(
    points: InterfacePoints, elements: InterfaceElements, mesh: BackgroundMesh, normals: Normals
) -> InterfacePoints:
    """Return the interface at its place on the moved mesh."""
    position, area, _ = place_points(elements, mesh)
    return points._replace(position=position, area=area, normal=normals(position))


def inward(position: np.ndarray) -> np.ndarray:
    """Return the normals of a cylinder around the z axis, from soil to body."""
    normals = np.zeros_like(position)
    normals[:, :2] = -position[:, :2] / np.linalg.norm(position[:, :2], axis=1)[:, None]
    return normals
