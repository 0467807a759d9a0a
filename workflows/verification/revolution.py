"""Elastic or plastic half space under a load on a circle: mesh, supports and loads.

Of the half space only its part inside a cylinder is modelled; the problems state its size.
"""

from __future__ import annotations

import numpy as np

from handoff.fe_mesh import FacetTag, FEMesh
from handoff.gmsh_triangles import triangulate
from install_mpm.interface import facet_rule


def half_space_mesh(radius: float, extent: float, size_at_edge: float, growth: float) -> FEMesh:
    """Return the mesh (r, z) of the ground under a load of ``radius`` in m on its surface.

    ``extent`` in m is radius and depth of the modelled part; the size of the cells is
    ``size_at_edge`` in m at the edge of the load and grows by ``growth`` per metre of distance.
    """
    outline = np.array(
        [(0.0, -extent), (extent, -extent), (extent, 0.0), (radius, 0.0), (0.0, 0.0)]
    )

    def size(r: float, z: float) -> float:
        return size_at_edge + growth * float(np.hypot(r - radius, z))

    nodes, cell_nodes, facet_nodes = quadratic(*triangulate(outline, size))
    tags = outer_tags(nodes[facet_nodes[:, 2]], extent)
    return FEMesh(nodes, cell_nodes, facet_nodes, tags)


def outer_tags(places: np.ndarray, extent: float, depth: float | None = None) -> np.ndarray:
    """Return the tags (n,) of boundary facets by their middles (n, 2) in m.

    The ground is a cylinder of radius ``extent`` and ``depth``, by default the same, in m.
    """
    (r, z), depth = places.T, extent if depth is None else depth
    tags = np.full(len(r), int(FacetTag.SURFACE))
    tags[np.abs(z + depth) < 1e-9 * extent] = FacetTag.BOTTOM
    tags[np.abs(r - extent) < 1e-9 * extent] = FacetTag.SIDE
    tags[np.abs(r) < 1e-9 * extent] = FacetTag.SYMMETRY
    return tags


def quadratic(
    vertices: np.ndarray, triangles: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return nodes with mid-sides at the end, six-node cells, and the edges on the boundary."""
    ends = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    unique, edge = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True)
    cell_nodes = np.column_stack([triangles, len(vertices) + edge.reshape(-1, 3)])
    nodes = np.concatenate([vertices, vertices[unique].mean(axis=1)])
    return nodes, cell_nodes, boundary_edges(cell_nodes)


def boundary_edges(cell_nodes: np.ndarray) -> np.ndarray:
    """Return the edges (n, 3) of six-node cells that belong to one cell: ends, then mid-side."""
    start = cell_nodes[:, [0, 1, 2]].ravel()
    end, middle = cell_nodes[:, [1, 2, 0]].ravel(), cell_nodes[:, 3:].ravel()
    _, first, uses = np.unique(middle, return_index=True, return_counts=True)
    return np.stack([start, end, middle], axis=1)[first[uses == 1]]


def pressure_force(mesh: FEMesh, facets: np.ndarray) -> np.ndarray:
    """Return the nodal forces (node, 2) in N of 1 Pa on ``facets`` (facet,) bool, whole circle."""
    nodes = mesh.facet_nodes[facets]
    start, end = mesh.nodes[nodes[:, 0]], mesh.nodes[nodes[:, 1]]
    inward = np.column_stack([start[:, 1] - end[:, 1], end[:, 0] - start[:, 0]])  # times length
    shape, weights = facet_rule(3, 3)
    around = 2.0 * np.pi * mesh.nodes[nodes][:, :, 0] @ shape.T * weights
    force = np.zeros_like(mesh.nodes)
    np.add.at(force, nodes, (around @ shape)[:, :, None] * inward[:, None])
    return force
