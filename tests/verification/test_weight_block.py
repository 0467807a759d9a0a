"""Mohr-Coulomb block under its own weight: ten steps, none cut, Newton's method stays quadratic.

Claimed: where the mesh does not disturb the one-dimensional state, every step converges in at most
six iterations although the soil at the edge of its pyramid has lost ellipticity, as stated.
"""

import numpy as np
import pytest

from install_mpm.constitutive import dispatch, mohr_coulomb
from install_mpm.constitutive.parameters import MohrCoulomb
from install_mpm.conventions import Kinematics
from workflows.verification.rectangle import rectangle_mesh
from workflows.verification.registry import problem
from workflows.verification.runner import run_problem
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
    assert result.newton.steps == 20
    assert result.newton.most_iterations <= 4


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
        settle(Block(SOIL, 10.0, 20e3, 6, 4, kinematics)).body.mesh.nodes[:, -1].max()
        for kinematics in (Kinematics.AXISYMMETRIC, Kinematics.THREE_D)
    ]
    assert tops[0] < 10.0 - 0.09
    assert tops[1] == pytest.approx(tops[0], rel=1e-9)


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
