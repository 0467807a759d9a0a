"""Records that the cell kernels share: switches and work arrays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm._jit import jit

CHUNKS = 64
"""Cells are shared out in chunks, each with its own scratch; results do not depend on how many."""

SMALLEST_VOLUME_RATIO = 0.05
"""A trial that compresses a point beyond this in one step is refused."""

COLLAPSED, LAW_FAILED = 1, 2


class CellOptions(NamedTuple):
    """Switches of the cell kernel and stiffnesses per cell."""

    is_finite_strain: bool
    has_mean_dilatation: bool
    """Element-mean dilatation; only with finite strain."""
    is_axisymmetric: bool
    has_moment_free_soft_stress: bool
    """Partly filled cells resist strain only, not their own turning."""
    volumetric_term: np.ndarray
    """h_v of each cell, (n_cells,) in Pa."""
    soft_stiffness: np.ndarray
    """Shear modulus of the soft stress of partly filled cells times volume per integration point,
    (n_cells,) in N m."""


class Scratch(NamedTuple):
    """Work arrays of one chunk of cells."""

    increment: np.ndarray
    """dF of the points of a cell, (most_points, 3, 3)."""
    jacobian: np.ndarray
    """J = det dF, (most_points,)."""
    gradients: np.ndarray
    """gx_a = grad N_a in the current position, (most_points, n_nodes, dim)."""
    hoop: np.ndarray
    """h_a = N_a / r in the current position, (most_points, n_nodes); zero unless axisymmetric."""
    divergence: np.ndarray
    """d_a = d ln J / du_a, gx_a plus the hoop term, (most_points, n_nodes, dim)."""
    mean_divergence: np.ndarray
    """dbar_a = d ln Jbar / du_a, (n_nodes, dim)."""
    spatial: np.ndarray
    """C_ijkl = d tau_ij / d l_kl, (3, 3, 3, 3)."""
    tangent: np.ndarray
    trial: np.ndarray
    stress: np.ndarray
    strain: np.ndarray
    tensor: np.ndarray
    """tau, (3, 3)."""
    values: np.ndarray
    vectors: np.ndarray
    moduli: np.ndarray
    """M, see ``cell_blocks``, (dim, dim, dim, dim)."""
    columns: np.ndarray
    """M gx_b, (dim, dim, n_dofs)."""
    stretch: np.ndarray
    """Change of the forces of a point with its share of the mean dilatation, (3, 3)."""
    left: np.ndarray
    right: np.ndarray
    """Vectors (n_dofs,) whose product is added to the stiffness."""


@jit
def make_scratch(most_points, n_nodes, dim):
    """Return work arrays for cells of up to ``most_points`` integration points."""
    return Scratch(
        np.empty((most_points, 3, 3)),
        np.empty(most_points),
        np.empty((most_points, n_nodes, dim)),
        np.zeros((most_points, n_nodes)),
        np.empty((most_points, n_nodes, dim)),
        np.empty((n_nodes, dim)),
        np.zeros((3, 3, 3, 3)),
        np.empty((6, 6)),
        np.empty(6),
        np.empty(6),
        np.empty(6),
        np.empty((3, 3)),
        np.empty(3),
        np.empty((3, 3)),
        np.empty((dim, dim, dim, dim)),
        np.empty((dim, dim, n_nodes * dim)),
        np.empty((3, 3)),
        np.empty(n_nodes * dim),
        np.empty(n_nodes * dim),
    )


@jit
def dilatation_axes(dim, is_axisymmetric):
    """Return how many axes share a change of volume: 2 in plane strain, else 3."""
    return 3 if is_axisymmetric else dim
