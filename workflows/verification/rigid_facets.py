"""Interface elements between soil and a rigid body along any boundary of a mesh."""

from __future__ import annotations

import numpy as np

from install_mpm.background_mesh import BackgroundMesh, facets_opposite_vertices
from install_mpm.constitutive import coulomb_interface
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.interface import InterfaceElements, InterfacePoints, facet_rule
from install_mpm.pile import PilePart
from install_mpm.pile_surface import POINTS_PER_FACET


def facet_elements(mesh: BackgroundMesh, is_on: np.ndarray) -> InterfaceElements:
    """Return the elements of boundary facets whose ends both are nodes with ``is_on`` (n_nodes,).

    The mesh is one of 6-node triangles.
    """
    ends = facets_opposite_vertices(mesh.cell_nodes[:, :3])
    cell, facet = np.nonzero(is_on[ends].all(axis=-1) & (mesh.cell_neighbours < 0))
    middle = mesh.cell_nodes[cell, 3 + (facet + 1) % 3]
    nodes = np.column_stack([ends[cell, facet], middle])
    return InterfaceElements(nodes, cell, *facet_rule(3, POINTS_PER_FACET))


def facet_points(elements: InterfaceElements, mesh: BackgroundMesh) -> np.ndarray:
    """Return the positions (n_points, 2) in m of the integration points on the facets."""
    position = np.einsum("qa,eai->eqi", elements.shape_values, mesh.nodes[elements.nodes])
    return position.reshape(-1, 2)


def rigid_interface(
    position: np.ndarray,
    normal: np.ndarray,
    area: np.ndarray,
    law: CoulombInterface,
    strength: float = 0.0,
    normal_traction: np.ndarray | float = 0.0,
) -> InterfacePoints:
    """Return interface points of a rigid body beside soil of undrained ``strength`` (Pa).

    ``normal`` (n_points, 2) points from the soil to the body; ``normal_traction`` in Pa is that at
    the start, tension positive.
    """
    n_points = len(position)
    traction = np.zeros((n_points, 2))
    traction[:, 1] = normal_traction
    return InterfacePoints(
        position=position,
        normal=normal,
        area=area,
        traction=traction,
        parameters=coulomb_interface.pack(law, np.full(n_points, strength)),
        part=np.full(n_points, int(PilePart.SHAFT)),
        covered=np.ones(n_points),
    )
