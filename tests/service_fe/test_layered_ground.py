"""Layered ground with a water table in the finite elements: the undisturbed start is in balance."""

import numpy as np
import pytest

from handoff.fe_mesh import make_mesh
from handoff.options import HandoffOptions
from handoff.surface import level_surface
from install_mpm.constitutive.parameters import CoulombInterface, MohrCoulomb, NeoHookean, Tresca
from install_mpm.conventions import Kinematics
from install_mpm.ground import Layer, LayeredGround, boundary_depths, material_at, unit_weights
from install_mpm.options import Box
from install_mpm.pile import Pile
from service_fe.problem import ServiceProblem

pytestmark = pytest.mark.dolfinx

GROUND = LayeredGround(
    (
        Layer("crust", 0.0, 18e3, 0.9, Tresca(6e6, 0.49, 30e3, 1e3)),
        Layer("sand", 1.25, 20e3, "jaky", MohrCoulomb(20e6, 0.3, 1e3, np.radians(32.0))),
        Layer("gravel", 2.6, 21e3, 0.6, NeoHookean(3e5, 0.3)),
    ),
    water_table=0.5,
)
BOUNDARIES = boundary_depths(GROUND)


@pytest.mark.parametrize(
    "kinematics", [Kinematics.PLANE_STRAIN, Kinematics.AXISYMMETRIC], ids=lambda kind: kind.name
)
def test_undisturbed_layers_are_in_balance(kinematics):
    mesh = make_mesh(
        Pile(0.5, 2.0, 18e3), 2.0, Box(3.0, 4.0, 0.5),
        HandoffOptions(size_at_pile=0.25, size_far=1.0), level_surface(), BOUNDARIES,
    )  # fmt: skip
    problem = ServiceProblem(mesh, GROUND, CoulombInterface(2e8, 2e7, 5e3), kinematics=kinematics)
    state = problem.wished_in_place_state()
    np.testing.assert_array_equal(
        state.material, material_at(GROUND, problem.integration_positions[:, 1])
    )
    assert problem.out_of_balance(state) < 1e-12
    expected = unit_weights(GROUND)[state.material] @ problem.integration_volumes
    assert problem.gravity(state)[:, 1].sum() == pytest.approx(-expected, rel=1e-12)
