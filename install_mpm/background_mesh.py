"""Background mesh of straight-edged cells; it follows the pile, not the material points."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.record import Field


class BackgroundMesh(NamedTuple):
    """Nodes now and in the reference position, and cells with their neighbours."""

    nodes: Annotated[np.ndarray, Field(("node", "dim"), "m", "current node coordinates")]
    reference_nodes: Annotated[
        np.ndarray, Field(("node", "dim"), "m", "node coordinates at zero pile motion")
    ]
    cell_nodes: Annotated[
        np.ndarray, Field(("cell", "cell_node"), "", "nodes of each cell, vertices first", "int64")
    ]
    cell_neighbours: Annotated[
        np.ndarray,
        Field(
            ("cell", "facet"), "", "cell across the facet opposite each vertex, -1 outside", "int64"
        ),
    ]


def make_background_mesh(nodes: np.ndarray, cell_nodes: np.ndarray) -> BackgroundMesh:
    """Return the mesh of triangles (3 or 6 nodes) at its reference position, neighbours found."""
    return straightened(
        BackgroundMesh(
            nodes=np.ascontiguousarray(nodes, dtype=np.float64),
            reference_nodes=np.ascontiguousarray(nodes, dtype=np.float64),
            cell_nodes=np.ascontiguousarray(cell_nodes, dtype=np.int64),
            cell_neighbours=_neighbours(cell_nodes[:, :3]),
        )
    )


def facets_opposite_vertices(vertices: np.ndarray) -> np.ndarray:
    """Return the end nodes (n, 3, 2) of the facets of triangles, facet v opposite vertex v."""
    return vertices[:, [[1, 2], [2, 0], [0, 1]]]


def _neighbours(vertices: np.ndarray) -> np.ndarray:
    """Return the cell across each facet, (n_cells, 3), -1 at the boundary."""
    n_cells = len(vertices)
    facets = np.sort(facets_opposite_vertices(vertices).reshape(-1, 2), axis=1)
    order = np.lexsort((facets[:, 1], facets[:, 0]))
    is_pair = (facets[order[1:]] == facets[order[:-1]]).all(axis=1)
    first, second = order[:-1][is_pair], order[1:][is_pair]
    neighbours = np.full(3 * n_cells, -1, dtype=np.int64)
    neighbours[first], neighbours[second] = second // 3, first // 3
    return neighbours.reshape(n_cells, 3)


def straightened(mesh: BackgroundMesh) -> BackgroundMesh:
    """Return the mesh with the mid-side nodes of 6-node triangles in the middle of their edges."""
    if mesh.cell_nodes.shape[1] != 6:
        return mesh
    nodes = mesh.nodes.copy()
    for local in range(3):
        ends = mesh.cell_nodes[:, [local, (local + 1) % 3]]
        nodes[mesh.cell_nodes[:, 3 + local]] = nodes[ends].mean(axis=1)
    return mesh._replace(nodes=nodes)


def cell_quality(mesh: BackgroundMesh) -> np.ndarray:
    """Return 2 r_in / r_out of each triangle (n_cells,): 1 equilateral, 0 flat, < 0 inverted."""
    corners = mesh.nodes[mesh.cell_nodes[:, :3]]
    edges = np.roll(corners, -1, axis=1) - corners
    length = np.linalg.norm(edges, axis=2)
    area = (edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]) / 2.0
    quality: np.ndarray = (
        16.0 * area**2 * np.sign(area) / (length.sum(axis=1) * length.prod(axis=1))
    )
    return quality


def smallest_altitude(mesh: BackgroundMesh) -> float:
    """Return the smallest height of a triangle in m: the step must stay below half of it."""
    corners = mesh.nodes[mesh.cell_nodes[:, :3]]
    edges = np.roll(corners, -1, axis=1) - corners
    area = (edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]) / 2.0
    return float((2.0 * area / np.linalg.norm(edges, axis=2).max(axis=1)).min())
