"""From material points to integration points: the points carry the state between meshes."""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit


@jit
def nearest_integration_point(reference_coordinates, integration_coordinates):
    """Return the index of the integration point whose sub-region holds the reference coordinates.

    In a simplex the nearest one in barycentric distance belongs to the vertex with the largest
    coordinate.
    """
    nearest, nearest_distance = 0, 1e300
    dim = reference_coordinates.shape[0]
    for q in range(integration_coordinates.shape[0]):
        distance = 0.0
        total = 0.0
        for i in range(dim):
            difference = reference_coordinates[i] - integration_coordinates[q, i]
            distance += difference * difference
            total += difference
        distance += total * total  # the dependent barycentric coordinate
        if distance < nearest_distance:
            nearest, nearest_distance = q, distance
    return nearest


@jit
def sum_sub_regions(
    point_order, cell_start, points, strain_change, state_change, integration_coordinates,
    n_materials, totals,
):  # fmt: skip
    """Add up the material points of every sub-region into ``totals``.

    ``totals`` is a tuple of arrays over (cell, integration point): volume and mass of all points;
    the material with the most volume, and of its points alone volume, volume-weighted ln J, elastic
    strain (3, 3) and state variables.  ``strain_change`` (n_points, 3, 3) and ``state_change``
    (n_points, n_state) move the state of a point to its integration point, so that geostatic ground
    is carried without error.
    """
    volume, mass, material, own_volume, log_ratio, strain, state = totals
    n_integration_points = integration_coordinates.shape[0]
    of_material = np.empty((n_integration_points, n_materials))
    for c in range(cell_start.shape[0] - 1):
        of_material[:, :] = 0.0
        for entry in range(cell_start[c], cell_start[c + 1]):
            p = point_order[entry]
            q = nearest_integration_point(points.reference_coordinates[p], integration_coordinates)
            volume[c, q] += points.volume[p]
            mass[c, q] += points.mass[p]
            of_material[q, points.material[p]] += points.volume[p]
        for q in range(n_integration_points):
            material[c, q] = np.argmax(of_material[q])
        for entry in range(cell_start[c], cell_start[c + 1]):
            p = point_order[entry]
            q = nearest_integration_point(points.reference_coordinates[p], integration_coordinates)
            if points.material[p] != material[c, q]:
                continue
            weight = points.volume[p]
            own_volume[c, q] += weight
            log_ratio[c, q] += weight * np.log(points.volume_ratio[p])
            for i in range(3):
                for j in range(3):
                    strain[c, q, i, j] += weight * (
                        points.elastic_log_strain[p, i, j] + strain_change[p, i, j]
                    )
            for s in range(state.shape[2]):
                state[c, q, s] += weight * (points.state_variables[p, s] + state_change[p, s])


@jit
def linear_functions(n_vertices, xi, values):
    """Fill ``values`` (n_vertices,) with the linear functions of the vertices of a simplex."""
    values[0] = 1.0
    for v in range(1, n_vertices):
        values[v] = xi[v - 1]
        values[0] -= xi[v - 1]


@jit
def vertex_fill(
    cell_nodes, n_vertices, integration_coordinates, integration_volume, point_order, cell_start,
    points, filled, capacity,
):  # fmt: skip
    """Add up, per vertex, the volume of soil ``filled`` and of cells ``capacity``, both (n_nodes,).

    The linear functions of the vertices share out both: quadratic ones are negative in places.
    """
    values = np.empty(n_vertices)
    for c in range(cell_nodes.shape[0]):
        for q in range(integration_coordinates.shape[0]):
            linear_functions(n_vertices, integration_coordinates[q], values)
            for v in range(n_vertices):
                capacity[cell_nodes[c, v]] += integration_volume[c, q] * values[v]
        for entry in range(cell_start[c], cell_start[c + 1]):
            p = point_order[entry]
            linear_functions(n_vertices, points.reference_coordinates[p], values)
            for v in range(n_vertices):
                filled[cell_nodes[c, v]] += points.volume[p] * values[v]


@jit
def body_force(cell_nodes, points, gravity, force):
    """Add the weight of the integration points to the nodal ``force`` (n_nodes, dim) in N."""
    n_nodes = cell_nodes.shape[1]
    vertical = force.shape[1] - 1
    for c in range(cell_nodes.shape[0]):
        for q in range(points.cell_start[c], points.cell_start[c + 1]):
            weight = points.density[q] * points.volume[q] * gravity
            if weight == 0.0:
                continue
            for a in range(n_nodes):
                force[cell_nodes[c, a], vertical] -= weight * points.shape_values[q, a]
