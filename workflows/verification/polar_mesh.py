"""Structured meshes of annuli and their sectors: a mesh of (radius, angle), bent."""

from __future__ import annotations

import numpy as np

from install_mpm.background_mesh import BackgroundMesh, make_background_mesh
from workflows.verification.rectangle import rectangle_mesh


def polar_mesh(
    radii: np.ndarray, angles: np.ndarray, *, is_crossed: bool = True
) -> tuple[BackgroundMesh, np.ndarray]:
    """Return straight-edged quadratic triangles, and (radius, angle) of the nodes before bending.

    ``radii`` (m) and ``angles`` (rad, from the first axis anticlockwise) ascend.  Mid-sides lie on
    the chords, so their own radius is slightly below the one that is returned.
    """
    flat = rectangle_mesh(radii, angles, is_crossed=is_crossed)
    radius, angle = flat.nodes.T
    nodes = radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    nodes[np.abs(nodes) < 1e-12 * radii[-1]] = 0.0  # on an axis of symmetry
    return make_background_mesh(nodes, flat.cell_nodes), flat.nodes
