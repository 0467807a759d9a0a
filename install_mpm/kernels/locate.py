"""Which triangle holds a point, by walking through neighbours; exact for straight edges."""

from __future__ import annotations

from install_mpm._jit import jit

INSIDE_TOLERANCE = 1e-12
"""Barycentric coordinates down to minus this count as inside: points on edges find a cell."""

INWARD_SHARE = 0.02
"""A point brought back from outside is put this share of the way to the centroid of its cell."""

FOUND, PROJECTED = 0, 1


@jit
def barycentric(nodes, cell_nodes, point, values):
    """Fill ``values`` (3,) with the barycentric coordinates of ``point`` (2,) in a triangle."""
    x0, y0 = nodes[cell_nodes[0], 0], nodes[cell_nodes[0], 1]
    a, b = nodes[cell_nodes[1], 0] - x0, nodes[cell_nodes[2], 0] - x0
    c, d = nodes[cell_nodes[1], 1] - y0, nodes[cell_nodes[2], 1] - y0
    determinant = a * d - b * c
    values[1] = (d * (point[0] - x0) - b * (point[1] - y0)) / determinant
    values[2] = (a * (point[1] - y0) - c * (point[0] - x0)) / determinant
    values[0] = 1.0 - values[1] - values[2]


@jit
def locate_points(
    nodes, cell_nodes, cell_neighbours, position, cell, reference_coordinates, status, scratch
):
    """Fill ``cell`` (n,), ``reference_coordinates`` (n, 2) and ``status`` (n,) of all points.

    ``cell`` holds a first guess.  A point outside the mesh is moved (``position`` changes) to the
    nearest place inside and gets the status ``PROJECTED``.  ``scratch`` (3,) is work space.
    """
    for p in range(position.shape[0]):
        status[p] = FOUND
        found = _walk(nodes, cell_nodes, cell_neighbours, position[p], cell[p], scratch)
        if found < 0:
            found = _search_all(nodes, cell_nodes, position[p], scratch)
        if found < 0:
            found = _project(nodes, cell_nodes, cell_neighbours, position[p])
            status[p] = PROJECTED
        barycentric(nodes, cell_nodes[found], position[p], scratch)
        cell[p] = found
        reference_coordinates[p, 0] = scratch[1]
        reference_coordinates[p, 1] = scratch[2]


@jit
def _walk(nodes, cell_nodes, cell_neighbours, point, start, scratch):
    """Return the cell reached across facets of negative coordinates, or -1 at the boundary."""
    c = start
    for _ in range(cell_nodes.shape[0]):
        barycentric(nodes, cell_nodes[c], point, scratch)
        worst = 0
        for v in range(1, 3):
            if scratch[v] < scratch[worst]:
                worst = v
        if scratch[worst] >= -INSIDE_TOLERANCE:
            return c
        c = cell_neighbours[c, worst]
        if c < 0:
            return -1
    return -1


@jit
def _search_all(nodes, cell_nodes, point, scratch):
    """Return the first cell that holds the point, or -1; for walks stopped by a corner."""
    for c in range(cell_nodes.shape[0]):
        barycentric(nodes, cell_nodes[c], point, scratch)
        if min(scratch[0], scratch[1], scratch[2]) >= -INSIDE_TOLERANCE:
            return c
    return -1


@jit
def _project(nodes, cell_nodes, cell_neighbours, point):
    """Move ``point`` just inside the nearest boundary facet; return the cell behind it."""
    nearest, nearest_distance = -1, 1e300
    best_x = best_y = 0.0
    for c in range(cell_nodes.shape[0]):
        for v in range(3):
            if cell_neighbours[c, v] >= 0:
                continue
            start, end = cell_nodes[c, (v + 1) % 3], cell_nodes[c, (v + 2) % 3]
            edge_x, edge_y = nodes[end, 0] - nodes[start, 0], nodes[end, 1] - nodes[start, 1]
            along = (
                (point[0] - nodes[start, 0]) * edge_x + (point[1] - nodes[start, 1]) * edge_y
            ) / (edge_x * edge_x + edge_y * edge_y)
            along = min(max(along, 0.0), 1.0)
            x, y = nodes[start, 0] + along * edge_x, nodes[start, 1] + along * edge_y
            distance = (point[0] - x) ** 2 + (point[1] - y) ** 2
            if distance < nearest_distance:
                nearest, nearest_distance, best_x, best_y = c, distance, x, y
    centre_x = centre_y = 0.0
    for v in range(3):
        centre_x += nodes[cell_nodes[nearest, v], 0] / 3.0
        centre_y += nodes[cell_nodes[nearest, v], 1] / 3.0
    point[0] = best_x + INWARD_SHARE * (centre_x - best_x)
    point[1] = best_y + INWARD_SHARE * (centre_y - best_y)
    return nearest
