"""Structured meshes of rectangles: every rectangle of a grid is cut into two or four triangles."""

from __future__ import annotations

import numpy as np

from install_mpm.background_mesh import BackgroundMesh, make_background_mesh


def rectangle_mesh(
    x: np.ndarray, y: np.ndarray, *, is_crossed: bool = False, is_quadratic: bool = True
) -> BackgroundMesh:
    """Return the mesh of the grid lines ``x`` and ``y`` (m, ascending).

    Each rectangle is cut by its rising diagonal, or with ``is_crossed`` by both.
    """
    vertices = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    columns = len(x) - 1
    first = (np.arange(len(y) - 1)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    corners = np.stack([first, first + 1, first + columns + 2, first + columns + 1])
    if is_crossed:
        centre = len(vertices) + np.arange(len(first))
        vertices = np.concatenate([vertices, vertices[corners].mean(axis=0)])
        ends = zip(corners, np.roll(corners, -1, axis=0), strict=True)
        cells = np.concatenate([np.stack([start, end, centre], axis=1) for start, end in ends])
    else:
        cells = np.concatenate([corners[[0, 1, 2]].T, corners[[0, 2, 3]].T])
    if not is_quadratic:
        return make_background_mesh(vertices, cells)
    edges = np.sort(np.stack([cells, np.roll(cells, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    unique, edge = np.unique(edges, axis=0, return_inverse=True)
    nodes = np.concatenate([vertices, vertices[unique].mean(axis=1)])
    middle = len(vertices) + edge.reshape(-1, 3)
    return make_background_mesh(nodes, np.concatenate([cells, middle], axis=1))
