"""Means around the rings of axisymmetric cells against integrals in closed form."""

import numpy as np
import pytest

from install_mpm.background_mesh import make_background_mesh
from install_mpm.cell_fill import cell_geometry
from install_mpm.cells import CellType, reference_cell
from install_mpm.conventions import Kinematics
from install_mpm.ring_means import ring_means

VERTICES = np.array([[0.0, 0.1], [1.3, -0.2], [0.4, 0.9]])
MIDDLES = (VERTICES + np.roll(VERTICES, -1, axis=0)) / 2.0
CORNERS = {
    CellType.TRI3: VERTICES,
    CellType.TRI6: np.vstack([VERTICES, MIDDLES]),
    CellType.QUAD4: np.array([[0.0, 0.0], [1.2, 0.1], [1.0, 0.9], [0.1, 0.7]]),
}
AREA = 0.5 * (1.3 * 0.8 + 0.3 * 0.4)


@pytest.fixture(params=CORNERS, ids=lambda cell_type: cell_type.name)
def cell_and_corners(request):
    return reference_cell(request.param), CORNERS[request.param]


def test_rigid_and_uniform_motions_have_their_strain(cell_and_corners):
    """Axial motion strains nothing; u_r = r stretches radius and hoop alike, in every mean."""
    cell, corners = cell_and_corners
    values, gradients, hoop = ring_means(corners[None], cell)
    np.testing.assert_allclose(values.sum(axis=-1), 1.0, rtol=1e-13)
    np.testing.assert_allclose(gradients.sum(axis=2), 0.0, atol=1e-13)
    strain = np.einsum("cqai,aj->cqij", gradients, corners)
    np.testing.assert_allclose(strain, np.broadcast_to(np.eye(2), strain.shape), atol=1e-13)
    np.testing.assert_allclose(hoop @ corners[:, 0], 1.0, rtol=1e-13)


def test_linear_stress_and_weight_on_a_ring_are_integrated_exactly():
    """Force of s_rr = s_zz = s_hoop = z and weight r dA on u = (r z, 0) resp. (0, z), by hand.

    int z (2 z) r dA and int z r dA from the moments of the triangle; |J| of the mean over 2 pi.
    """
    cell, corners = reference_cell(CellType.TRI6), CORNERS[CellType.TRI6]
    mesh = make_background_mesh(corners, np.arange(6)[None])
    geometry = cell_geometry(mesh, cell, Kinematics.AXISYMMETRIC)
    r, z = corners.T
    volume, height = geometry.integration_volume[0], geometry.integration_height[0]
    work = 0.0
    for q in range(3):
        slope, ring = geometry.shape_gradients[0, q], geometry.hoop_gradients[0, q]
        work += volume[q] * height[q] * (slope[:, 0] @ (r * z) + ring @ (r * z))
    assert work == pytest.approx(2.0 * np.pi * 2.0 * moment(1, 2), rel=1e-12)
    weight = volume @ geometry.shape_values[0] @ z
    assert weight == pytest.approx(2.0 * np.pi * moment(1, 1), rel=1e-12)


def moment(of_r, of_z):
    """Integral of r^of_r z^of_z over the triangle by a collapsed Gauss rule of high order."""
    x, w = np.polynomial.legendre.leggauss(6)
    x, w = (x + 1.0) / 2.0, w / 2.0
    total = 0.0
    for u, weight_u in zip(x, w, strict=True):
        for v, weight_v in zip(x, w, strict=True):
            share = np.array([1.0 - u, u * (1.0 - v), u * v])
            place = share @ VERTICES
            total += weight_u * weight_v * u * place[0] ** of_r * place[1] ** of_z
    return 2.0 * AREA * total


def test_volume_of_the_ring_is_exact():
    cell, corners = reference_cell(CellType.TRI6), CORNERS[CellType.TRI6]
    mesh = make_background_mesh(corners, np.arange(6)[None])
    geometry = cell_geometry(mesh, cell, Kinematics.AXISYMMETRIC)
    assert geometry.volume[0] == pytest.approx(2.0 * np.pi * moment(1, 0), rel=1e-12)
