"""Viscosity resists the rate of strain, has no say at rest, and acts where soil has opened too."""

import numpy as np
import pytest

from handoff.fe_state_file import FEState
from install_mpm.constitutive import dispatch
from install_mpm.constitutive.models import Model
from install_mpm.constitutive.parameters import CriticalStateSand, HenckyElastic
from service_fe.loading import imposed_steps
from service_fe.material_map import soil_response
from service_fe.options import Displace, ServiceNumerics
from service_fe.solve import advance
from service_fe.viscosity import viscous_tangent

PUSH = 0.02
MOST = 4
"""Newton iterations, too few for a whole step."""
SAND = CriticalStateSand(
    void_ratio=0.7,
    critical_stress_ratio=0.92,
    critical_void_ratio=0.83,
    critical_state_slope=0.02,
    reference_shear_modulus=11e6,
)
STEEL = HenckyElastic(youngs_modulus=200e9, poissons_ratio=0.3)


def pushed(problem, state, step):
    """Return the last of the steps that push the pile."""
    programme = Displace("push", PUSH, step, first_step_halvings=0)
    for imposed in imposed_steps(programme, np.zeros(3)):
        taken = advance(problem, state, imposed)
        state = taken.last.state
    return taken.last


@pytest.fixture(scope="module")
def viscous_problem(make_pile_problem):
    return make_pile_problem(ServiceNumerics(viscosity=0.05))


@pytest.mark.dolfinx
def test_load_tends_to_that_without_viscosity_in_proportion(
    make_pile_problem, viscous_problem, pile_problem, undisturbed
):
    free = pushed(pile_problem, undisturbed, PUSH / 2)
    thin = pushed(make_pile_problem(ServiceNumerics(viscosity=0.025)), undisturbed, PUSH / 2)
    thick = pushed(viscous_problem, undisturbed, PUSH / 2)
    assert free.viscous_share == 0.0
    assert free.head_load < thin.head_load < thick.head_load
    ratio = (thick.head_load - free.head_load) / (thin.head_load - free.head_load)
    assert ratio == pytest.approx(2.0, rel=0.1)
    assert thick.viscous_share / thin.viscous_share == pytest.approx(2.0, rel=0.1)


@pytest.mark.dolfinx
def test_step_that_is_cut_is_as_fast_as_the_whole(make_pile_problem, viscous_problem, undisturbed):
    """Once the soil flows, its velocity does not depend on how a step is divided."""
    flowing = pushed(viscous_problem, undisturbed, PUSH).state
    step = imposed_steps(Displace("push", PUSH, PUSH, first_step_halvings=0), np.zeros(3))[0]
    whole = advance(viscous_problem, flowing, step)
    impatient = make_pile_problem(ServiceNumerics(viscosity=0.05, max_iterations=MOST))
    in_parts = advance(impatient, flowing, step)
    half_as_fast = pushed(viscous_problem, flowing, PUSH / 2)
    assert in_parts.cuts > whole.cuts == 0
    assert in_parts.last.viscous_share == pytest.approx(whole.last.viscous_share, rel=0.1)
    assert 0.4 < half_as_fast.viscous_share / whole.last.viscous_share < 0.7


def sand_and_steel():
    """Return the materials, and a state of sand under pressure, opened sand, and steel."""
    materials = dispatch.pack((SAND, STEEL))
    stress = -20e3 * np.eye(3)[None].repeat(3, axis=0)
    variables = np.zeros((3, 3))
    variables[:2] = dispatch.initial_state(SAND, np.zeros(2), stress[:2])
    variables[1, dispatch.state_columns(materials, "opening")[0]] = 0.01
    strain = np.zeros((3, 3, 3))
    strain[0] = -1e-3 * np.eye(3)
    state = FEState(stress, strain, variables, np.array([0, 0, 1]), np.zeros((0, 3)), np.zeros(3))
    return materials, state


def test_opened_sand_is_viscous_and_steel_is_not():
    materials, state = sand_and_steel()
    assert materials.model[1] == Model.HENCKY_ELASTIC
    viscous = viscous_tangent(materials, state)
    own = soil_response(materials, state, np.zeros((3, 6))).tangent
    assert np.linalg.eigvalsh(viscous[1]).min() > 1e5
    assert np.abs(own[1]).max() < 1.0  # what Newton's method has without viscosity
    assert np.linalg.eigvalsh(viscous[0]).min() > np.linalg.eigvalsh(viscous[1]).min()
    assert not viscous[2].any()
    assert state.state_variables[1, 1] == 0.01
