"""Meshes and material points of the paper's examples: structured triangles, four points in each."""

from __future__ import annotations

import numpy as np

from install_mpm.background_mesh import BackgroundMesh, make_background_mesh
from install_mpm.constitutive import dispatch
from install_mpm.conventions import GRAVITY
from install_mpm.geostatic import elastic_strain_of
from install_mpm.ground import Ground
from install_mpm.material_points import MaterialPoints

FOUR_POINTS = np.array([[1 / 3, 1 / 3], [0.2, 0.2], [0.6, 0.2], [0.2, 0.6]])
"""Reference coordinates of the four points of a triangle; each stands for a quarter of it."""


def lines(start: float, end: float, size: float) -> np.ndarray:
    """Return equally spaced coordinates from ``start`` to ``end``, about ``size`` apart (m)."""
    return np.linspace(start, end, max(round((end - start) / size), 1) + 1)


def structured_mesh(
    x: np.ndarray, z: np.ndarray, is_outside: np.ndarray, *, is_quadratic: bool
) -> BackgroundMesh:
    """Return rectangles between the lines ``x`` and ``z``, each split by an alternating diagonal.

    ``is_outside`` (n_x - 1, n_z - 1) leaves rectangles out.  Triangles have three nodes, or six.
    """
    index = np.arange(len(x) * len(z)).reshape(len(x), len(z))
    corners = [index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]]
    i, j = np.nonzero(~is_outside)
    a, b, c, d = (corner[i, j] for corner in corners)
    is_rising = ((i + j) % 2 == 0)[:, None]
    first = np.where(is_rising, np.column_stack([a, b, c]), np.column_stack([a, b, d]))
    second = np.where(is_rising, np.column_stack([a, c, d]), np.column_stack([b, c, d]))
    used, cells = np.unique(np.stack([first, second], axis=1), return_inverse=True)
    nodes = np.stack(np.meshgrid(x, z, indexing="ij"), axis=-1).reshape(-1, 2)[used]
    cells = cells.reshape(-1, 3)
    return make_background_mesh(*(with_mid_sides(nodes, cells) if is_quadratic else (nodes, cells)))


def with_mid_sides(nodes: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes and six-node triangles of three-node ones; vertices keep their numbers."""
    sides = np.sort(cells[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    ends, number = np.unique(sides, axis=0, return_inverse=True)
    middle = len(nodes) + number.reshape(-1, 3)
    return np.vstack([nodes, nodes[ends].mean(axis=1)]), np.hstack([cells, middle])


def four_points_per_cell(
    mesh: BackgroundMesh, ground: Ground, cells: np.ndarray | None = None
) -> MaterialPoints:
    """Return the unstressed material points of the paper in ``cells`` (all of the mesh).

    In plane strain; a quarter of the volume of the cell belongs to each.
    """
    cells = np.arange(len(mesh.cell_nodes)) if cells is None else cells
    vertices = mesh.nodes[mesh.cell_nodes[cells, :3]]
    edges = vertices[:, 1:] - vertices[:, :1]
    position = vertices[:, :1] + np.einsum("qv,cvi->cqi", FOUR_POINTS, edges)
    n_points = 4 * len(cells)
    volume = np.repeat(np.abs(np.linalg.det(edges)) / 2.0, 4) / 4.0
    stress = np.zeros((n_points, 3, 3))
    depth = -position.reshape(n_points, 2)[:, 1]
    state = dispatch.initial_state(ground.soil, depth, stress)
    return MaterialPoints(
        position=position.reshape(n_points, 2),
        displacement=np.zeros((n_points, 2)),
        mass=volume * ground.unit_weight / GRAVITY,
        volume=volume,
        volume_ratio=np.ones(n_points),
        elastic_log_strain=elastic_strain_of(ground.soil, stress, state),
        kirchhoff_stress=stress,
        state_variables=state,
        material=np.zeros(n_points, dtype=np.int64),
        cell=np.repeat(cells, 4),
        reference_coordinates=np.tile(FOUR_POINTS, (len(cells), 1)),
    )
