"""Which simplex holds a point, by walking through neighbours; exact for straight edges."""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit

INSIDE_TOLERANCE = 1e-12
"""Barycentric coordinates down to minus this count as inside: points on facets find a cell."""

INWARD_SHARE = 0.02
"""A point brought back from outside is put this share of the way to the centroid of its cell."""

FOUND, PROJECTED = 0, 1


@jit
def barycentric(nodes, cell_nodes, point, values):
    """Fill ``values`` (dim + 1,) with the barycentric coordinates of ``point`` in a simplex."""
    if point.shape[0] == 2:
        _barycentric_plane(nodes, cell_nodes, point, values)
    else:
        _barycentric_space(nodes, cell_nodes, point, values)


@jit
def _barycentric_plane(nodes, cell_nodes, point, values):
    """Fill the coordinates (3,) in a triangle."""
    x0, y0 = nodes[cell_nodes[0], 0], nodes[cell_nodes[0], 1]
    a, b = nodes[cell_nodes[1], 0] - x0, nodes[cell_nodes[2], 0] - x0
    c, d = nodes[cell_nodes[1], 1] - y0, nodes[cell_nodes[2], 1] - y0
    determinant = a * d - b * c
    values[1] = (d * (point[0] - x0) - b * (point[1] - y0)) / determinant
    values[2] = (a * (point[1] - y0) - c * (point[0] - x0)) / determinant
    values[0] = 1.0 - values[1] - values[2]


@jit
def _barycentric_space(nodes, cell_nodes, point, values):
    """Fill the coordinates (4,) in a tetrahedron: triple products of its edges u, v, w."""
    x0, y0, z0 = nodes[cell_nodes[0], 0], nodes[cell_nodes[0], 1], nodes[cell_nodes[0], 2]
    u0, u1, u2 = (
        nodes[cell_nodes[1], 0] - x0,
        nodes[cell_nodes[1], 1] - y0,
        nodes[cell_nodes[1], 2] - z0,
    )
    v0, v1, v2 = (
        nodes[cell_nodes[2], 0] - x0,
        nodes[cell_nodes[2], 1] - y0,
        nodes[cell_nodes[2], 2] - z0,
    )
    w0, w1, w2 = (
        nodes[cell_nodes[3], 0] - x0,
        nodes[cell_nodes[3], 1] - y0,
        nodes[cell_nodes[3], 2] - z0,
    )
    p0, p1, p2 = point[0] - x0, point[1] - y0, point[2] - z0
    c0, c1, c2 = v1 * w2 - v2 * w1, v2 * w0 - v0 * w2, v0 * w1 - v1 * w0
    determinant = u0 * c0 + u1 * c1 + u2 * c2
    values[1] = (p0 * c0 + p1 * c1 + p2 * c2) / determinant
    d0, d1, d2 = u1 * p2 - u2 * p1, u2 * p0 - u0 * p2, u0 * p1 - u1 * p0
    values[2] = (d0 * w0 + d1 * w1 + d2 * w2) / determinant
    values[3] = -(d0 * v0 + d1 * v1 + d2 * v2) / determinant
    values[0] = 1.0 - values[1] - values[2] - values[3]


@jit
def locate_points(
    nodes, cell_nodes, cell_neighbours, facets, position, cell, reference_coordinates, status
):
    """Fill ``cell`` (n,), ``reference_coordinates`` (n, dim) and ``status`` (n,) of all points.

    ``cell`` holds a first guess.  ``facets`` (n_vertices, dim) are the vertices of the facet
    opposite each vertex.  A point outside the mesh is moved (``position`` changes) to the nearest
    place inside and gets the status ``PROJECTED``; so is one whose way through the mesh, from the
    place that its old ``cell`` and ``reference_coordinates`` have now, leads across a cut.
    """
    dim = position.shape[1]
    scratch = np.empty((2, dim + 1))
    nearest = np.empty((2, dim))
    cut = np.empty(2, dtype=np.int64)
    for p in range(position.shape[0]):
        status[p] = FOUND
        found = _walk(nodes, cell_nodes, cell_neighbours, position[p], cell[p], scratch[0])
        cut[:] = -1
        if found < 0:
            _place(nodes, cell_nodes[cell[p]], reference_coordinates[p], nearest[0])
            _first_cut(nodes, cell_nodes, cell_neighbours, nearest[0], position[p], scratch, cut)
            if cut[0] < 0:
                found = _search_all(nodes, cell_nodes, position[p], scratch[0])
        if found < 0:
            found = _project(nodes, cell_nodes, cell_neighbours, facets, position[p], nearest, cut)
            status[p] = PROJECTED
        barycentric(nodes, cell_nodes[found], position[p], scratch[0])
        cell[p] = found
        for i in range(dim):
            reference_coordinates[p, i] = scratch[0, 1 + i]


@jit
def _walk(nodes, cell_nodes, cell_neighbours, point, start, scratch):
    """Return the cell reached across facets of negative coordinates, or -1 at the boundary."""
    c = start
    for _ in range(cell_nodes.shape[0]):
        barycentric(nodes, cell_nodes[c], point, scratch)
        worst = 0
        for v in range(1, scratch.shape[0]):
            if scratch[v] < scratch[worst]:
                worst = v
        if scratch[worst] >= -INSIDE_TOLERANCE:
            return c
        c = cell_neighbours[c, worst]
        if c < 0:
            return -1
    return -1


@jit
def _place(nodes, cell_nodes, reference_coordinates, place):
    """Fill ``place`` (dim,) with that of ``reference_coordinates`` in a cell."""
    for i in range(place.shape[0]):
        place[i] = nodes[cell_nodes[0], i]
        for v in range(reference_coordinates.shape[0]):
            edge = nodes[cell_nodes[1 + v], i] - nodes[cell_nodes[0], i]
            place[i] += reference_coordinates[v] * edge


@jit
def _first_cut(nodes, cell_nodes, cell_neighbours, start, end, scratch, cut):
    """Fill ``cut`` (2,) with cell and facet where a straight way first crosses a cut, if it does.

    Along the way the barycentric coordinates in a cell change linearly; it leaves the cell across
    facet v where coordinate v changes sign and no other one is negative.
    """
    first = 2.0
    here, there = scratch[0], scratch[1]
    for c in range(cell_nodes.shape[0]):
        for v in range(here.shape[0]):
            if cell_neighbours[c, v] >= -1:
                continue
            barycentric(nodes, cell_nodes[c], start, here)
            barycentric(nodes, cell_nodes[c], end, there)
            if here[v] < -INSIDE_TOLERANCE or there[v] >= -INSIDE_TOLERANCE:
                continue
            share = here[v] / (here[v] - there[v])
            smallest = 0.0
            for w in range(here.shape[0]):
                if w != v:
                    smallest = min(smallest, here[w] + share * (there[w] - here[w]))
            if smallest >= -INSIDE_TOLERANCE and share < first:
                first = share
                cut[0], cut[1] = c, v


@jit
def _search_all(nodes, cell_nodes, point, scratch):
    """Return the first cell that holds the point, or -1; for walks stopped by a corner."""
    n_vertices = scratch.shape[0]
    for c in range(cell_nodes.shape[0]):
        if _is_beside(nodes, cell_nodes[c], point, n_vertices):
            continue
        barycentric(nodes, cell_nodes[c], point, scratch)
        if scratch.min() >= -INSIDE_TOLERANCE:
            return c
    return -1


@jit
def _is_beside(nodes, cell_nodes, point, n_vertices):
    """Return whether the point lies outside the bounding box of a cell."""
    for i in range(point.shape[0]):
        lowest = highest = nodes[cell_nodes[0], i]
        for v in range(1, n_vertices):
            lowest = min(lowest, nodes[cell_nodes[v], i])
            highest = max(highest, nodes[cell_nodes[v], i])
        margin = INSIDE_TOLERANCE * (highest - lowest)
        if point[i] < lowest - margin or point[i] > highest + margin:
            return True
    return False


@jit
def _project(nodes, cell_nodes, cell_neighbours, facets, point, nearest, cut):
    """Move ``point`` just inside the nearest boundary facet; return the cell behind it.

    If it has crossed a ``cut`` (cell and facet, or -1), only facets of the cut on that side count.
    """
    dim = point.shape[0]
    found, found_distance = -1, 1e300
    for c in range(cell_nodes.shape[0]):
        for v in range(dim + 1):
            if cell_neighbours[c, v] >= (0 if cut[0] < 0 else -1):
                continue
            if cut[0] >= 0 and not _face_alike(nodes, cell_nodes, facets, c, v, cut[0], cut[1]):
                continue
            if dim == 2:
                _nearest_on_segment(nodes, cell_nodes[c], facets[v], point, nearest[0])
            else:
                _nearest_on_triangle(nodes, cell_nodes[c], facets[v], point, nearest[0])
            distance = 0.0
            for i in range(dim):
                distance += (point[i] - nearest[0, i]) ** 2
            if distance < found_distance:
                found, found_distance = c, distance
                nearest[1] = nearest[0]
    for i in range(dim):
        centre = 0.0
        for v in range(dim + 1):
            centre += nodes[cell_nodes[found, v], i] / (dim + 1.0)
        point[i] = nearest[1, i] + INWARD_SHARE * (centre - nearest[1, i])
    return found


@jit
def _face_alike(nodes, cell_nodes, facets, c, v, other_c, other_v):
    """Return whether two facets of tetrahedra face the same half of space."""
    one, other = (
        _normal(nodes, cell_nodes[c], facets[v]),
        _normal(nodes, cell_nodes[other_c], facets[other_v]),
    )
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2] > 0.0


@jit
def _normal(nodes, cell_nodes, corners):
    """Return a normal of a facet of a tetrahedron, out of the cell."""
    a, b, c = cell_nodes[corners[0]], cell_nodes[corners[1]], cell_nodes[corners[2]]
    u0, u1, u2 = nodes[b, 0] - nodes[a, 0], nodes[b, 1] - nodes[a, 1], nodes[b, 2] - nodes[a, 2]
    v0, v1, v2 = nodes[c, 0] - nodes[a, 0], nodes[c, 1] - nodes[a, 1], nodes[c, 2] - nodes[a, 2]
    return u1 * v2 - u2 * v1, u2 * v0 - u0 * v2, u0 * v1 - u1 * v0


@jit
def _nearest_on_segment(nodes, cell_nodes, ends, point, nearest):
    """Fill ``nearest`` (2,) with the place of a facet of a triangle nearest to ``point``."""
    start, end = cell_nodes[ends[0]], cell_nodes[ends[1]]
    edge_x, edge_y = nodes[end, 0] - nodes[start, 0], nodes[end, 1] - nodes[start, 1]
    along = ((point[0] - nodes[start, 0]) * edge_x + (point[1] - nodes[start, 1]) * edge_y) / (
        edge_x * edge_x + edge_y * edge_y
    )
    along = min(max(along, 0.0), 1.0)
    nearest[0], nearest[1] = nodes[start, 0] + along * edge_x, nodes[start, 1] + along * edge_y


@jit
def _nearest_on_triangle(nodes, cell_nodes, corners, point, nearest):
    """Fill ``nearest`` (3,) with the place of a facet of a tetrahedron nearest to ``point``.

    Inside the triangle it is the foot of the perpendicular, else a place on one of the edges.
    """
    a, b, c = cell_nodes[corners[0]], cell_nodes[corners[1]], cell_nodes[corners[2]]
    uu = uv = vv = up = vp = 0.0
    for i in range(3):
        u, v = nodes[b, i] - nodes[a, i], nodes[c, i] - nodes[a, i]
        w = point[i] - nodes[a, i]
        uu += u * u
        uv += u * v
        vv += v * v
        up += u * w
        vp += v * w
    determinant = uu * vv - uv * uv
    s, t = (vv * up - uv * vp) / determinant, (uu * vp - uv * up) / determinant
    if s < 0.0 or t < 0.0 or s + t > 1.0:
        s, t = _nearest_on_edges(uu, uv, vv, up, vp)
    for i in range(3):
        nearest[i] = nodes[a, i] + s * (nodes[b, i] - nodes[a, i]) + t * (nodes[c, i] - nodes[a, i])


@jit
def _nearest_on_edges(uu, uv, vv, up, vp):
    """Return the coordinates s, t of the place on the edges of a triangle nearest to a point.

    The squared distance is q(s, t) = uu s^2 + 2 uv s t + vv t^2 - 2 up s - 2 vp t plus a constant.
    """
    along_u = min(max(up / uu, 0.0), 1.0)
    along_v = min(max(vp / vv, 0.0), 1.0)
    hypotenuse = min(max((vv - uv + up - vp) / (uu - 2.0 * uv + vv), 0.0), 1.0)
    best_s, best_t, best = 0.0, 0.0, 1e300
    for s, t in ((along_u, 0.0), (0.0, along_v), (hypotenuse, 1.0 - hypotenuse)):
        value = uu * s * s + 2.0 * uv * s * t + vv * t * t - 2.0 * up * s - 2.0 * vp * t
        if value < best:
            best_s, best_t, best = s, t, value
    return best_s, best_t
