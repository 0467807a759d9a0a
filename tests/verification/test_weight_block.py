"""Mohr-Coulomb block under its own weight: ten steps, none cut, Newton's method stays quadratic.

Claimed: where the mesh does not disturb the one-dimensional state, every step converges in at most
six iterations although the soil at the edge of its pyramid has lost ellipticity, as stated.
"""

import numpy as np
import pytest

from install_mpm.constitutive import dispatch, mohr_coulomb
from install_mpm.constitutive.frictional import PLASTIC_SHEAR
from install_mpm.constitutive.parameters import MohrCoulomb
from install_mpm.conventions import Kinematics
from install_mpm.newton import ROUND_OFF
from workflows.verification.rectangle import rectangle_mesh
from workflows.verification.registry import problem
from workflows.verification.runner import newton_statement, run_problem
from workflows.verification.settling_block import Block, settle, weight_on_nodes
from workflows.verification.solid_meshes import extruded, grid, linear_mesh

PHI = np.deg2rad(30.0)
SOIL = MohrCoulomb(10e6, 0.2, 1e3, PHI, 0.0)
LINES = np.array([0.0, 0.5, 2.0, 3.0])


@pytest.mark.parametrize(
    ("name", "n"), [("KRATOS-BLOCK", 20), ("KRATOS-BLOCK-ROUND", 50), ("KRATOS-BLOCK-3D", 8)]
)
def test_every_step_converges_quadratically(name, n):
    result = run_problem(problem(name), {"n": n})
    assert result.is_met, [check for check in result.checks if not check.is_met] or result.failure
    assert result.newton.most_iterations <= 3
    histories = result.outcome.residual_histories
    assert len(histories) == 20
    for of_one_cohesion in (histories[:10], histories[10:]):
        assert newton_statement(of_one_cohesion, ROUND_OFF).check.is_met


@pytest.mark.slow
@pytest.mark.parametrize("n", [12, 16])
def test_cubes_as_fine_as_those_of_the_peer(n):
    assert run_problem(problem("KRATOS-BLOCK-3D"), {"n": n}).is_met


@pytest.mark.parametrize("steps", [1, 50])
def test_steps_of_other_sizes_converge_as_well(steps):
    block = Block(SOIL, 10.0, 20e3, 10, steps, Kinematics.AXISYMMETRIC)
    settled = settle(block)
    assert max(len(history) - 1 for history in settled.histories) <= 4
    assert np.abs(settled.body.points.displacement[:, 0]).max() < 1e-9


def test_block_and_cylinder_and_cube_settle_alike():
    """The state is one-dimensional, so the kinematics make no difference."""
    tops = [
        settle(Block(SOIL, 10.0, 20e3, 8, 4, kinematics)).body.mesh.nodes[:, -1].max()
        for kinematics in (Kinematics.AXISYMMETRIC, Kinematics.THREE_D)
    ]
    assert tops[0] < 10.0 - 0.09
    assert tops[1] == pytest.approx(tops[0], rel=1e-9)


def test_the_elastic_soil_under_the_surface_is_seen_by_eight_cubes_and_not_by_four():
    """Without it round-off decides on a sideways motion; with it nothing moves."""
    coarse, fine = (
        settle(Block(SOIL, 10.0, 20e3, n, 4, Kinematics.THREE_D)).body.points for n in (4, 8)
    )
    assert coarse.state_variables[:, PLASTIC_SHEAR].min() > 0.0
    assert fine.state_variables[:, PLASTIC_SHEAR].min() == 0.0
    assert np.abs(fine.displacement[:, :2]).max() < 1e-9


def test_nodes_carry_the_weight_of_their_squares():
    """A field that is bilinear in every square does the work of the weight in it, exactly."""
    r, z = rectangle_mesh(LINES, LINES, is_quadratic=False).nodes.T
    load = weight_on_nodes(LINES, 20.0, Kinematics.AXISYMMETRIC)
    integral = 2.0 * np.pi * (3.0 * 4.5 + 2.0 * 9.0 * 3.0 + 9.0 * 4.5)  # radius and height 3
    assert load @ (1.0 + 2.0 * r + r * z) == pytest.approx(-20.0 * integral)


def test_nodes_carry_the_weight_of_their_prisms():
    """The same of a field that is linear in plan and in the height."""
    x, y, z = linear_mesh(extruded(grid(LINES, LINES), LINES)).nodes.T
    load = weight_on_nodes(LINES, 20.0, Kinematics.THREE_D)
    assert load @ ((1.0 + 2.0 * x - y) * (1.0 + z)) == pytest.approx(-20.0 * 22.5 * 7.5)


@pytest.fixture
def tangent_at_the_edge():
    """Tangent (6, 6) in Pa of soil that is compressed along the second axis, beyond yield."""
    materials = dispatch.pack([MohrCoulomb(10e6, 0.2, 0.0, PHI, 0.0)])
    strain = np.array([0.0, -1e-3, 0.0, 0.0, 0.0, 0.0])
    stress, elastic, tangent = np.empty(6), np.empty(6), np.empty((6, 6))
    old, new = np.zeros(3), np.zeros(3)
    status = mohr_coulomb.update_stress(
        strain, materials.parameters[0], old, stress, elastic, new, tangent
    )
    assert status == 0
    return tangent


def test_soil_at_the_edge_does_not_resist_horizontal_shear(tangent_at_the_edge):
    """Neither a distortion along the axes nor one across them changes a stress."""
    distortions = np.array([[1.0, 0.0, -1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 1.0, 0.0]])
    change = tangent_at_the_edge @ distortions.T
    np.testing.assert_allclose(change, 0.0, atol=1e-9 * tangent_at_the_edge[1, 1])


def test_soil_at_the_edge_has_lost_ellipticity(tangent_at_the_edge):
    """det Q(n) = M G_t (K_a n_x^2 - n_y^2) (n_x^2 - n_y^2), negative for a part of directions."""
    tangent = tangent_at_the_edge
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
