"""PA4 and PA5: rigid rotation of soil and mesh, and the sense of the paper's eqs (3) and (4).

Claimed: a positive angle of eqs (3)-(4) turns clockwise; a rotation leaves a stress-free disc
without stress and its points at home, and it turns a stress as it should.
"""

import numpy as np
import pytest

from install_mpm.mesh_motion import rotate, rotate_clockwise
from workflows.verification.disc_meshes import circle, disc_mesh
from workflows.verification.rigid_rotation import stress_free_rotation, stressed_rotation

pytestmark = pytest.mark.gmsh


def test_equations_3_and_4_turn_clockwise():
    right = np.array([[1.0, 0.0]])
    np.testing.assert_allclose(rotate_clockwise(right, np.pi / 2), [[0.0, -1.0]], atol=1e-15)


def test_mesh_turns_anticlockwise_as_the_pile_does():
    mesh = disc_mesh(circle(1.0, 8))
    turned = rotate(mesh, np.pi / 4)
    corner = np.flatnonzero(np.linalg.norm(mesh.nodes - [1.0, 0.0], axis=1) < 1e-12)
    np.testing.assert_allclose(turned.nodes[corner], [[np.sqrt(0.5), np.sqrt(0.5)]], rtol=1e-14)
    np.testing.assert_allclose(turned.nodes, rotate_clockwise(mesh.nodes, -np.pi / 4), atol=1e-14)


@pytest.mark.parametrize("parameters", [{}, {"R": 3.0, "nu": 0.0}])
def test_stress_free_rotation(parameters):
    outcome = stress_free_rotation(**parameters)
    assert all(check.is_met for check in outcome.checks), outcome.checks


@pytest.mark.parametrize(
    "parameters", [{}, {"E": 50e6, "nu": 0.1, "sigma_xx": 80e3, "tau_xy": 0.0}]
)
def test_stressed_rotation(parameters):
    outcome = stressed_rotation(**parameters)
    assert all(check.is_met for check in outcome.checks), outcome.checks
