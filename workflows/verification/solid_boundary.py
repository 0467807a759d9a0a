"""Structured meshes of solids for the service stage: boundary facets, their tags, surface loads."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from handoff.fe_mesh import FEMesh
from install_mpm.background_mesh import (
    BackgroundMesh,
    facet_edge_nodes,
    facets_opposite_vertices,
)
from install_mpm.interface import facet_rule
from service_fe.interface_forms import facet_geometry


def fe_mesh(mesh: BackgroundMesh, tag_of: Callable[[np.ndarray], np.ndarray]) -> FEMesh:
    """Return a mesh of tetrahedra with the facets of its boundary.

    ``tag_of`` tells the ``FacetTag`` (n,) of facets by their centres (n, 3) in m.
    """
    cell, facet = np.argwhere(mesh.cell_neighbours < 0).T
    vertices = facets_opposite_vertices(mesh.cell_nodes[:, :4])[cell, facet]
    nodes = np.hstack([vertices, facet_edge_nodes(mesh, cell, facet)])
    return FEMesh(mesh.nodes, mesh.cell_nodes, nodes, tag_of(mesh.nodes[vertices].mean(axis=1)))


def nodal_areas(mesh: FEMesh, facets: np.ndarray) -> np.ndarray:
    """Return the integrals (node,) in m^2 of the shape functions over ``facets`` (n,)."""
    nodes = mesh.facet_nodes[facets]
    sizes, _ = facet_geometry(mesh, nodes)
    shape, weights = facet_rule(nodes.shape[1], 3)
    areas = np.zeros(len(mesh.nodes))
    np.add.at(areas, nodes, np.outer(sizes, weights @ shape))
    return areas
