"""The mesh of the pile itself, inside the surface that the mesh of the ground leaves for it.

Its cells conform to the facets of the ground: every node of the ground on the pile has a twin.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from handoff.fe_mesh import FacetTag, FEMesh, pile_facets
from handoff.gmsh_triangles import fill_solid, triangulate
from install_mpm.background_mesh import facets_opposite_vertices
from install_mpm.cells import TET_EDGES, TRIANGLE_EDGES

ROOMY = 1.5
"""Wanted size of cells over the longest edge at the surface: no edge is cut."""


class PileMesh(NamedTuple):
    """Mesh of a pile, and where it meets that of the ground."""

    mesh: FEMesh
    """Its facets are the head, the axis of a pile of revolution, and what touches the ground."""
    twin: np.ndarray
    """Node of the pile (node,) at the place of each node of the ground; -1 if there is none."""


def mesh_of_pile(ground: FEMesh) -> PileMesh:
    """Return the mesh inside the pile facets of the mesh of the ``ground``.

    Raises
    ------
    MeshError
        If gmsh cannot fill the pile.
    """
    fill = _inside_line if ground.nodes.shape[1] == 2 else _inside_surface
    vertices, cells = fill(ground)
    return with_twins(pile_mesh(vertices, cells), ground)


def pile_mesh(vertices: np.ndarray, cells: np.ndarray) -> FEMesh:
    """Return the quadratic mesh of ``cells`` (n, dim + 1) on ``vertices`` (m, dim) in m.

    The uppermost facets are the head; in the plane those at x = 0 are the axis.
    """
    dim = vertices.shape[1]
    edges = np.array(TRIANGLE_EDGES if dim == 2 else TET_EDGES)
    ends = np.sort(cells[:, edges], axis=2).reshape(-1, 2)
    unique, edge = np.unique(ends, axis=0, return_inverse=True)
    nodes = np.vstack([vertices, vertices[unique].mean(axis=1)])
    middle = len(vertices) + edge.reshape(len(cells), -1)
    corners = _boundary(cells)
    facet_nodes = np.hstack([corners, _middles(corners, unique, len(vertices))])
    return FEMesh(nodes, np.hstack([cells, middle]), facet_nodes, _tags(vertices[corners]))


def with_twins(mesh: FEMesh, ground: FEMesh) -> PileMesh:
    """Return ``mesh`` with the nodes that it has in common with the ``ground``.

    Raises
    ------
    ValueError
        If a node of the ground on the pile has no twin.
    """
    on_pile = np.unique(ground.facet_nodes[pile_facets(ground)])
    distance, nearest = cKDTree(mesh.nodes).query(ground.nodes[on_pile])
    if distance.max(initial=0.0) > 1e-9 * np.ptp(ground.nodes):
        raise ValueError("the mesh of the pile does not conform to that of the ground")
    twin = np.full(len(ground.nodes), -1)
    twin[on_pile] = nearest
    return PileMesh(mesh, twin)


def _boundary(cells: np.ndarray) -> np.ndarray:
    """Return the vertices (n, dim) of the facets that belong to one cell, inside on the left."""
    if cells.shape[1] == 3:
        facets = cells[:, np.array(TRIANGLE_EDGES)].reshape(-1, 2)
    else:
        facets = facets_opposite_vertices(cells).reshape(-1, 3)
    _, first, uses = np.unique(
        np.sort(facets, axis=1), axis=0, return_index=True, return_counts=True
    )
    return np.asarray(facets[first[uses == 1]])


def _middles(corners: np.ndarray, edges: np.ndarray, n_vertices: int) -> np.ndarray:
    """Return the mid-side nodes of facets with ``corners``, by the sorted ``edges`` (n, 2)."""
    sides = ((0, 1),) if corners.shape[1] == 2 else TRIANGLE_EDGES
    ends = np.sort(corners[:, np.array(sides)], axis=2)
    key = edges[:, 0] * n_vertices + edges[:, 1]
    found = np.searchsorted(key, ends[..., 0] * n_vertices + ends[..., 1])
    return np.asarray(n_vertices + found)


def _tags(corners: np.ndarray) -> np.ndarray:
    """Return the tags (n,) of facets by their ``corners`` (n, dim, dim)."""
    height, slack = corners[:, :, -1], 1e-9 * np.ptp(corners[:, :, -1])
    tags = np.full(len(corners), int(FacetTag.SURFACE))
    if corners.shape[2] == 2:
        tags[(np.abs(corners[:, :, 0]) < slack).all(axis=1)] = FacetTag.SYMMETRY
    tags[(height > height.max() - slack).all(axis=1)] = FacetTag.PILE_HEAD
    return tags


def _inside_line(ground: FEMesh) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices and triangles of half of a wall, or of a pile of revolution."""
    ends = ground.facet_nodes[pile_facets(ground), :2]
    following = dict(map(tuple, ends))
    start = (set(following) - set(following.values())).pop()
    line = [start]
    while line[-1] in following:
        line.append(following[line[-1]])
    outline = ground.nodes[line]
    if outline[0, 0] > outline[-1, 0]:
        outline = outline[::-1]  # from the axis at the base to the shaft at the surface
    outline = np.vstack([outline, [0.0, outline[-1, 1]]])
    size = ROOMY * np.linalg.norm(np.diff(outline[:-1], axis=0), axis=1).max()
    return triangulate(outline, lambda _x, _z: float(size))


def _inside_surface(ground: FEMesh) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices and tetrahedra of a pile in space; its head is a plane section."""
    shell = ground.facet_nodes[pile_facets(ground), :3]
    used, shell = np.unique(shell, return_inverse=True)
    shell, places = shell.reshape(-1, 3), ground.nodes[used]
    rim = _rim(shell)
    outline = places[rim][:, :2]
    size = ROOMY * np.linalg.norm(outline - np.roll(outline, 1, axis=0), axis=1).max()
    inside, head = triangulate(outline, lambda _x, _y: float(size))
    added = np.column_stack([inside, np.full(len(inside), places[rim, 2].mean())])
    number = np.concatenate([rim, len(places) + np.arange(len(inside) - len(rim))])
    places = np.vstack([places, added[len(rim) :]])
    return fill_solid(places, np.vstack([shell[:, ::-1], number[head]]), float(size))


def _rim(shell: np.ndarray) -> np.ndarray:
    """Return the vertices (n,) around the open end of a surface, anticlockwise seen from above."""
    start, end = shell[:, np.array(TRIANGLE_EDGES)].reshape(-1, 2).T
    pairs = set(zip(start, end, strict=True))
    following = {a: b for a, b in pairs if (b, a) not in pairs}
    line = [next(iter(following))]
    while following[line[-1]] != line[0]:
        line.append(following[line[-1]])
    return np.array(line)
