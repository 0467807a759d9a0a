"""PC2 and PB2 in space: the power balance of a screw pile, and a circular footing.

Claimed: interface, elastic store, dissipation and weight take up the work of the rig to 2 %, no
point gives work back by plastic flow, and the rough footing carries 6.048 s_u to 5 %.
"""

import numpy as np
import pytest

from workflows.verification.circular_footing_solid import circular_footing
from workflows.verification.screw_pile_work import screw_pile_work, screw_plate_work
from workflows.verification.solid_meshes import extruded, quadratic_mesh, sector
from workflows.verification.surface_plate import surface_plate


def assert_met(outcome):
    assert all(check.is_met for check in outcome.checks), outcome.checks


@pytest.mark.gmsh
@pytest.mark.slow
@pytest.mark.parametrize("parameters", [{}, {"D": 1.7, "d": 0.88, "p": 0.56, "su": 30e3}])
def test_screw_pile_work(parameters):
    assert_met(screw_pile_work(**parameters))


@pytest.mark.gmsh
@pytest.mark.slow
def test_screw_plate_work():
    assert_met(screw_plate_work())


@pytest.mark.gmsh
@pytest.mark.slow
def test_plate_without_thickness_in_soil_that_hardly_moves():
    assert_met(surface_plate())


@pytest.mark.slow
@pytest.mark.parametrize("parameters", [{}, {"R": 2.0, "su": 30e3, "nu": 0.45}])
def test_circular_footing(parameters):
    assert_met(circular_footing(**parameters))


def test_a_sector_is_a_quarter_of_the_prism():
    plane = sector(np.array([0.0, 0.5, 1.0]), np.linspace(0.0, np.pi / 2.0, 4))
    mesh = quadratic_mesh(extruded(plane, np.array([-1.0, 0.0])))
    corners = mesh.nodes[mesh.cell_nodes[:, :4]]
    volume = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6.0
    assert volume.min() > 0.0
    assert volume.sum() == pytest.approx(1.5 * np.sin(np.pi / 6.0))
