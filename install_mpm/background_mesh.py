"""Background mesh of straight-edged cells; it follows the pile, not the material points."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from install_mpm.cells import TET_EDGES, TRIANGLE_EDGES
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
            ("cell", "facet"),
            "",
            "cell across the facet opposite each vertex, -1 outside, -2 - cell across a cut",
            "int64",
        ),
    ]


def make_background_mesh(nodes: np.ndarray, cell_nodes: np.ndarray) -> BackgroundMesh:
    """Return the mesh of simplices at its reference position, neighbours found.

    Triangles have 3 or 6 nodes, tetrahedra 4 or 10.
    """
    dim = nodes.shape[1]
    mesh = straightened(
        BackgroundMesh(
            nodes=np.ascontiguousarray(nodes, dtype=np.float64),
            reference_nodes=np.ascontiguousarray(nodes, dtype=np.float64),
            cell_nodes=np.ascontiguousarray(cell_nodes, dtype=np.int64),
            cell_neighbours=_neighbours(cell_nodes[:, : dim + 1]),
        )
    )
    return mesh._replace(reference_nodes=mesh.nodes.copy())


def size_at_nodes(mesh: BackgroundMesh) -> np.ndarray:
    """Return the size of the smallest cell at each node, (n_nodes,) in m.

    The size of a cell, about the length of its sides, is the root of the determinant of the edges
    from a vertex.
    """
    dim = mesh.nodes.shape[1]
    vertices = mesh.nodes[mesh.cell_nodes[:, : dim + 1]]
    size = np.abs(np.linalg.det(vertices[:, 1:] - vertices[:, :1])) ** (1.0 / dim)
    smallest = np.full(len(mesh.nodes), np.inf)
    for nodes in mesh.cell_nodes.T:
        np.minimum.at(smallest, nodes, size)
    return smallest


FACETS_OPPOSITE = {3: [[1, 2], [2, 0], [0, 1]], 4: [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]]}
"""Vertices of the facet opposite each vertex, by number of vertices; outward in a tetrahedron."""


def facets_opposite_vertices(vertices: np.ndarray) -> np.ndarray:
    """Return the vertices (n, n_vertices, dim) of the facets of simplices.

    Facet v lies opposite vertex v.
    """
    return vertices[:, FACETS_OPPOSITE[vertices.shape[1]]]


def facet_edge_nodes(mesh: BackgroundMesh, cell: np.ndarray, facet: np.ndarray) -> np.ndarray:
    """Return the mid-side nodes (n, n_edges) of facets of quadratic cells.

    The node of the edge from the first to the second vertex of the facet comes first.
    """
    n_vertices = mesh.nodes.shape[1] + 1
    edges = _edges(n_vertices)
    index = {frozenset(edge): n_vertices + local for local, edge in enumerate(edges)}
    rows = []
    for corners in FACETS_OPPOSITE[n_vertices]:
        n_edges = len(corners) if len(corners) > 2 else 1
        following = corners[1:] + corners[:1]
        pairs = list(zip(corners, following, strict=True))[:n_edges]
        rows.append([index[frozenset(pair)] for pair in pairs])
    return mesh.cell_nodes[cell[:, None], np.array(rows)[facet]]


def _edges(n_vertices: int) -> tuple[tuple[int, int], ...]:
    """Return the vertices at the ends of each mid-side node of a quadratic simplex."""
    return TRIANGLE_EDGES if n_vertices == 3 else TET_EDGES


def _neighbours(vertices: np.ndarray) -> np.ndarray:
    """Return the cell across each facet, (n_cells, n_vertices), -1 at the boundary."""
    n_cells, n_vertices = vertices.shape
    facets = np.sort(facets_opposite_vertices(vertices).reshape(-1, n_vertices - 1), axis=1)
    order = np.lexsort(facets.T[::-1])
    is_pair = (facets[order[1:]] == facets[order[:-1]]).all(axis=1)
    first, second = order[:-1][is_pair], order[1:][is_pair]
    neighbours = np.full(n_vertices * n_cells, -1, dtype=np.int64)
    neighbours[first], neighbours[second] = second // n_vertices, first // n_vertices
    return neighbours.reshape(n_cells, n_vertices)


def cut_along(mesh: BackgroundMesh, is_cut: np.ndarray) -> BackgroundMesh:
    """Return the mesh cut open along inner facets: each side has its own nodes, at the same place.

    ``is_cut`` (n_cells, n_vertices) tells the facets, from both of their cells.  A node goes into
    as many as there are groups of cells around it that hang together across other facets; so the
    free boundary of the cut keeps its nodes.
    """
    n_local = mesh.cell_nodes.shape[1]
    cell, facet = np.nonzero((mesh.cell_neighbours >= 0) & ~is_cut)
    beside = mesh.cell_neighbours[cell, facet]
    is_same = mesh.cell_nodes[cell][:, :, None] == mesh.cell_nodes[beside][:, None, :]
    pair, own, other = np.nonzero(is_same)
    links = (cell[pair] * n_local + own, beside[pair] * n_local + other)
    size = mesh.cell_nodes.size
    graph = coo_array((np.ones(len(pair), dtype=bool), links), shape=(size, size))
    _, group = connected_components(graph, directed=False)
    _, first, cell_nodes = np.unique(
        np.column_stack([mesh.cell_nodes.ravel(), group]), axis=0, return_index=True,
        return_inverse=True,
    )  # fmt: skip
    origin = mesh.cell_nodes.ravel()[first]
    return BackgroundMesh(
        nodes=mesh.nodes[origin],
        reference_nodes=mesh.reference_nodes[origin],
        cell_nodes=cell_nodes.reshape(mesh.cell_nodes.shape),
        cell_neighbours=np.where(is_cut, -2 - mesh.cell_neighbours, mesh.cell_neighbours),
    )


def straightened(mesh: BackgroundMesh) -> BackgroundMesh:
    """Return the mesh with the mid-side nodes of quadratic cells in the middle of their edges."""
    n_vertices = mesh.nodes.shape[1] + 1
    if mesh.cell_nodes.shape[1] == n_vertices:
        return mesh
    nodes = mesh.nodes.copy()
    for local, ends in enumerate(_edges(n_vertices)):
        nodes[mesh.cell_nodes[:, n_vertices + local]] = nodes[mesh.cell_nodes[:, ends]].mean(axis=1)
    return mesh._replace(nodes=nodes)


def cell_quality(mesh: BackgroundMesh) -> np.ndarray:
    """Return dim r_in / r_out of each cell (n_cells,): 1 regular, 0 flat, < 0 inverted."""
    volume, facet_area = _measures(mesh)
    dim = mesh.nodes.shape[1]
    inradius = dim * np.abs(volume) / facet_area.sum(axis=1)
    quality: np.ndarray = np.sign(volume) * dim * inradius / _circumradius(mesh)
    return quality


def smallest_altitude(mesh: BackgroundMesh) -> float:
    """Return the smallest height of a cell in m: the step must stay below half of it."""
    volume, facet_area = _measures(mesh)
    return float((mesh.nodes.shape[1] * volume / facet_area.max(axis=1)).min())


def _measures(mesh: BackgroundMesh) -> tuple[np.ndarray, np.ndarray]:
    """Return the volume (n_cells,) of the cells and the areas (n_cells, n_vertices) of facets."""
    dim = mesh.nodes.shape[1]
    vertices = mesh.cell_nodes[:, : dim + 1]
    corners = mesh.nodes[vertices]
    volume = np.linalg.det(corners[:, 1:] - corners[:, :1]) / (2.0 if dim == 2 else 6.0)
    facets = mesh.nodes[facets_opposite_vertices(vertices)]
    if dim == 2:
        return volume, np.linalg.norm(facets[:, :, 1] - facets[:, :, 0], axis=2)
    first, second = facets[:, :, 1] - facets[:, :, 0], facets[:, :, 2] - facets[:, :, 0]
    return volume, np.linalg.norm(np.cross(first, second), axis=2) / 2.0


def _circumradius(mesh: BackgroundMesh) -> np.ndarray:
    """Return the radius (n_cells,) in m of the circle or sphere through the vertices."""
    dim = mesh.nodes.shape[1]
    corners = mesh.nodes[mesh.cell_nodes[:, : dim + 1]]
    edges = corners[:, 1:] - corners[:, :1]
    is_flat = np.abs(np.linalg.det(edges)) < 1e-300
    edges = np.where(is_flat[:, None, None], np.eye(dim), edges)
    centre = np.linalg.solve(edges, (edges**2).sum(axis=2)[:, :, None] / 2.0)[:, :, 0]
    radius: np.ndarray = np.where(is_flat, np.inf, np.linalg.norm(centre, axis=1))
    return radius
