"""Mohr-Coulomb block under its own weight: ten steps, none cut, Newton's method stays quadratic.

Claimed: where the mesh does not disturb the one-dimensional state, every step converges in at most
six iterations although the soil at the edge of its pyramid has lost ellipticity, as stated.
"""

import numpy as np
import pytest

from install_mpm.constitutive import dispatch, mohr_coulomb
from install_mpm.constitutive.parameters import MohrCoulomb
from install_mpm.conventions import Kinematics
from install_mpm.newton import convergence_order
from workflows.verification.weight_block import kratos_block, kratos_cylinder, weight_block

PHI = np.deg2rad(30.0)


@pytest.mark.parametrize("cohesion", [5e3, 1e3])
def test_block_converges_and_stays_one_dimensional(cohesion):
    outcome = kratos_block(c=cohesion, n=20)
    assert all(check.is_met for check in outcome.checks)
    soil = MohrCoulomb(10e6, 0.2, cohesion, PHI, 0.0)
    body, _, histories = weight_block(soil, 10.0, 20e3, 20, 10, Kinematics.PLANE_STRAIN)
    assert np.abs(body.points.displacement[:, 0]).max() < 1e-8
    orders = [convergence_order(np.array(history)) for history in histories]
    assert np.nanmedian(orders) >= 1.8


@pytest.mark.parametrize(("cohesion", "n", "steps"), [(5e3, 50, 10), (1e3, 30, 20)])
def test_cylinder_converges(cohesion, n, steps):
    outcome = kratos_cylinder(c=cohesion, n=n, steps=steps)
    assert all(check.is_met for check in outcome.checks)
    orders = [convergence_order(np.array(history)) for history in outcome.residual_histories]
    assert np.nanmedian(orders) >= 1.8


def test_soil_at_the_edge_has_lost_ellipticity():
    """det Q(n) = M G_t (K_a n_x^2 - n_y^2) (n_x^2 - n_y^2), negative for a part of directions."""
    soil = MohrCoulomb(10e6, 0.2, 0.0, PHI, 0.0)
    materials = dispatch.pack([soil])
    strain = np.array([0.0, -1e-3, 0.0, 0.0, 0.0, 0.0])
    stress, elastic, tangent = np.empty(6), np.empty(6), np.empty((6, 6))
    old, new = np.zeros(3), np.zeros(3)
    status = mohr_coulomb.update_stress(
        strain, materials.parameters[0], old, stress, elastic, new, tangent
    )
    assert status == 0
    modulus, shear = tangent[1, 1], 0.5 * tangent[3, 3]
    for angle in np.linspace(0.0, np.pi / 2.0, 19):
        x, y = np.cos(angle), np.sin(angle)
        acoustic = np.array(
            [
                [tangent[0, 0] * x * x + shear * y * y, (tangent[0, 1] + shear) * x * y],
                [(tangent[1, 0] + shear) * x * y, tangent[1, 1] * y * y + shear * x * x],
            ]
        )
        expected = modulus * shear * (x * x / 3.0 - y * y) * (x * x - y * y)
        assert np.linalg.det(acoustic) == pytest.approx(expected, abs=1e-9 * modulus * shear)
