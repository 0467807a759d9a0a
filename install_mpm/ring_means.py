"""Shape functions and gradients of axisymmetric cells as means around their integration points.

Stress lives at the integration points of the plane cell.  With the functions L_q that are one at
point q and zero at the others (constant, linear or bilinear with one, three or four points), the
strain and the weight of a point are means over the cell,

    g_q = int L_q grad(N) r dA / w_q ,  h_q = int L_q N dA / w_q ,  N_q = int L_q N r dA / w_q ,
    w_q = int L_q r dA ,

and forces are their duals.  A stress that the L_q can represent is then integrated exactly together
with the radius, so undisturbed ground is in equilibrium (the mean is that of Sloan and Randolph
1982); the plain rule is exact for polynomials of one degree less than the radius asks for.  The
weight w_q is r_q times the weight of the plane rule, and nothing is divided by the radius.
"""

from __future__ import annotations

import numpy as np

from install_mpm.cells import (
    ReferenceCell,
    reference_gradients,
    shape_functions,
    sub_region_points,
)

EXACT_PER_DIRECTION = 3
"""Points of each sub-region and direction that integrate the products above exactly."""


def ring_means(
    corners: np.ndarray, cell: ReferenceCell
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return means of the shape functions, gradients and hoop gradients of all cells.

    ``corners`` (n_cells, n_nodes, 2) are the places (r, z) of the nodes in m.  Shapes are (n_cells,
    n_ip, n_nodes), with the axis after it in 1/m, and in 1/m.
    """
    places, shares = sub_region_points(cell, EXACT_PER_DIRECTION)
    values, slopes = _tabulated(cell, places)
    jacobian = np.einsum("gar,cai->cgir", slopes, corners)
    gradients = np.einsum("gar,cgri->cgai", slopes, np.linalg.inv(jacobian), optimize=True)
    area = np.linalg.det(jacobian) * shares
    ring = area * (corners[:, :, 0] @ values.T)
    own = _point_functions(cell.integration_coordinates, places)
    weight = (ring @ own)[:, :, None]
    return (
        np.einsum("cg,gq,ga->cqa", ring, own, values, optimize=True) / weight,
        np.einsum("cg,gq,cgai->cqai", ring, own, gradients, optimize=True) / weight[..., None],
        np.einsum("cg,gq,ga->cqa", area, own, values, optimize=True) / weight,
    )


def _tabulated(cell: ReferenceCell, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return shape functions (n, n_nodes) and their reference gradients at ``places`` (n, 2)."""
    values = np.empty((len(places), cell.n_nodes))
    slopes = np.empty((len(places), cell.n_nodes, cell.dim))
    for place, value, slope in zip(places, values, slopes, strict=True):
        shape_functions(cell.cell_type, place, value)
        reference_gradients(cell.cell_type, place, slope)
    return values, slopes


def _point_functions(points: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return at ``places`` (n, 2) the functions (n, n_ip) that are one at one of the ``points``."""

    def monomials(at: np.ndarray) -> np.ndarray:
        return np.column_stack([np.ones(len(at)), at, at[:, 0] * at[:, 1]])[:, : len(points)]

    functions: np.ndarray = monomials(places) @ np.linalg.inv(monomials(points))
    return functions
