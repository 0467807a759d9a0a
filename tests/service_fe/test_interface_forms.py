"""The interface in the finite-element model: a block on a plane (PA15) and cyclic sliding (PD9)."""

import numpy as np
import pytest

from handoff.fe_mesh import FacetTag
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic
from install_mpm.ground import Ground
from service_fe.interface_forms import InterfaceForms
from service_fe.problem import ServiceProblem
from service_fe.rigid_pile import PileControl, rigid_motion

pytestmark = pytest.mark.dolfinx

LENGTH, NORMAL_LOAD = 1.0, 20.0
COHESION, FRICTION, STIFFNESS = 2.0, np.radians(24.0), 1e4
STRENGTH = COHESION * LENGTH + NORMAL_LOAD * np.tan(FRICTION)


def pulled(displacement):
    """The block is pulled sideways and carries its load; it does not turn."""
    return PileControl(
        np.array([False, True, False]),
        np.array([displacement, 0.0, 0.0]),
        np.array([0.0, -NORMAL_LOAD, 0.0]),
    )


def pull(step):
    """Horizontal force on the block."""
    return step.pile_load[0]


@pytest.fixture(scope="module")
def block_mesh(make_structured_mesh):
    """Soil of 1 m by 0.5 m with a block of the same length on it."""

    def tag_of(middle):
        return FacetTag.PILE_BASE if middle[1] > -1e-9 else FacetTag.BOTTOM

    return make_structured_mesh(np.linspace(0.0, LENGTH, 4), np.linspace(-0.5, 0.0, 3), tag_of)


@pytest.fixture(scope="module")
def make_block(block_mesh):
    def make(**parameters):
        interface = CoulombInterface(STIFFNESS, STIFFNESS, **parameters)
        ground = Ground(0.0, 1.0, HenckyElastic(1e6, 0.3))
        rigid_soil = np.ones((len(block_mesh.nodes), 2), dtype=bool)
        return ServiceProblem(block_mesh, ground, interface, is_fixed=rigid_soil)

    return make


@pytest.fixture(scope="module")
def frictional(make_block):
    return make_block(cohesion=COHESION, friction_angle=FRICTION)


@pytest.fixture(scope="module")
def standing(frictional):
    """Block under its normal load."""
    return frictional.solve(frictional.wished_in_place_state(), pulled(0.0)).state


def test_sliding_block_carries_cohesion_and_friction(frictional, standing):
    step = frictional.solve(standing, pulled(5e-3))
    assert pytest.approx(10.9046, abs=1e-4) == STRENGTH
    assert pull(step) == pytest.approx(STRENGTH, rel=1e-8)
    assert -step.pile_load[1] == pytest.approx(NORMAL_LOAD, rel=1e-8)


def test_slip_starts_where_the_springs_reach_the_strength(frictional, standing):
    onset = STRENGTH / (STIFFNESS * LENGTH)
    assert onset == pytest.approx(1.0905e-3, rel=1e-4)
    before = frictional.solve(standing, pulled(0.999 * onset))
    assert pull(before) == pytest.approx(0.999 * STRENGTH, rel=1e-8)
    after = frictional.solve(before.state, pulled(0.5 * onset))
    again = frictional.solve(after.state, pulled(0.5 * onset))
    assert pull(after) == pytest.approx(STRENGTH, rel=1e-8)
    assert pull(again) - pull(after) == pytest.approx(0.0, abs=1e-8 * STRENGTH)


def test_dilatant_block_rises_as_it_slides(make_block):
    dilation = np.radians(10.0)
    block = make_block(cohesion=COHESION, friction_angle=FRICTION, dilation_angle=dilation)
    state = block.solve(block.wished_in_place_state(), pulled(0.0)).state
    onset = block.solve(state, pulled(STRENGTH / STIFFNESS))
    sliding = block.solve(onset.state, pulled(2e-3))
    assert sliding.increment.motion[1] == pytest.approx(2e-3 * np.tan(dilation), rel=1e-6)
    assert -sliding.pile_load[1] == pytest.approx(NORMAL_LOAD, rel=1e-8)


def test_block_on_elastic_soil_slides_at_the_same_load(block_mesh):
    """The strength does not depend on the soil below: here it gives way elastically."""
    interface = CoulombInterface(STIFFNESS, STIFFNESS, cohesion=COHESION)
    problem = ServiceProblem(block_mesh, Ground(0.0, 1.0, HenckyElastic(1e5, 0.3)), interface)
    state = problem.wished_in_place_state()
    for _ in range(4):
        step = problem.solve(state, pulled(1e-3))
        state = step.state
    assert pull(step) == pytest.approx(COHESION * LENGTH, rel=1e-8)


def test_cyclic_sliding_dissipates_the_area_of_its_loop(make_block):
    """Energy per cycle 4 tau_y (u_a - tau_y / k_s), the loop closes (ten cycles, u_a = 5 mm)."""
    shear_strength, amplitude = 10.0, 5e-3
    block = make_block(cohesion=shear_strength)
    state = block.wished_in_place_state()

    def move(state, distance):
        """Return the state and the work, exact for a curve that is straight between kinks."""
        onset, work = 2.0 * shear_strength / STIFFNESS, 0.0
        for part in (np.sign(distance) * onset, distance - np.sign(distance) * onset):
            before = block.pile_load(state)[0]
            step = block.solve(state, pulled(part))
            state = step.state
            work += 0.5 * (before + pull(step)) * part
        return state, work

    state, _ = move(state, amplitude)
    start = pull(block.solve(state, pulled(0.0)))
    for _ in range(10):
        state, back = move(state, -2.0 * amplitude)
        state, forth = move(state, 2.0 * amplitude)
        expected = 4.0 * shear_strength * (amplitude - shear_strength / STIFFNESS)
        assert back + forth == pytest.approx(expected, rel=1e-6)
        assert pull(block.solve(state, pulled(0.0))) == pytest.approx(start, rel=1e-9)


def test_rigid_motion_of_soil_and_pile_together_strains_no_interface(pile_mesh):
    interface = InterfaceForms(pile_mesh)
    motion = np.array([0.3, -0.2, 0.1])
    soil = rigid_motion(pile_mesh.nodes) @ motion
    np.testing.assert_allclose(interface.relative_displacement(soil, motion), 0.0, atol=1e-15)


def test_pile_pulled_up_opens_the_base_and_slips_along_the_shaft(pile_mesh):
    """Normal gap positive open; slip is pile minus soil along the tangent, down on the shaft."""
    interface = InterfaceForms(pile_mesh)
    slip = interface.relative_displacement(np.zeros_like(pile_mesh.nodes), np.array([0, 0.01, 0]))
    is_base = interface.parts == FacetTag.PILE_BASE
    np.testing.assert_allclose(slip[is_base], [[0.0, 0.01]] * is_base.sum(), atol=1e-16)
    np.testing.assert_allclose(slip[~is_base], [[-0.01, 0.0]] * (~is_base).sum(), atol=1e-16)


def test_areas_are_those_of_the_pile(pile_mesh):
    interface = InterfaceForms(pile_mesh)
    is_base = interface.parts == FacetTag.PILE_BASE
    assert interface.areas[is_base].sum() == pytest.approx(0.5, rel=1e-14)
    assert interface.areas[~is_base].sum() == pytest.approx(1.0, rel=1e-14)


def test_mesh_without_pile_has_no_interface(box_mesh):
    interface = InterfaceForms(box_mesh)
    soil, pile = interface.forces(np.zeros((0, 2)))
    assert len(interface.areas) == 0
    assert not soil.any()
    assert not pile.any()
