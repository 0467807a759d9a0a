"""The complete model: equilibrium at the start, patch test, tangent, loaded and prescribed pile."""

import numpy as np
import pytest

from handoff.equilibration import EquilibrationError, equilibrate
from handoff.options import HandoffOptions
from install_mpm.constitutive.elastic import elastic_stress, pack
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic
from install_mpm.ground import Ground
from install_mpm.newton import convergence_order
from service_fe.load_step import LoadStep
from service_fe.newton import StepNotConvergedError
from service_fe.options import ServiceNumerics
from service_fe.problem import ServiceProblem
from service_fe.rigid_pile import PileControl, held, loaded, moved
from service_fe.step import Unknowns

pytestmark = pytest.mark.dolfinx

SOIL = HenckyElastic(youngs_modulus=4e6, poissons_ratio=0.3)
GRADIENT = np.array([[0.3, -0.7], [0.2, 0.5]]) * 1e-3


@pytest.fixture(scope="module")
def pushed(pile_problem, undisturbed):
    """Pile pushed far into the plastic range."""
    step, state = None, undisturbed
    for _ in range(3):
        step = pile_problem.solve(state, moved(0.01), guess=step.increment if step else None)
        state = step.state
    return step


def test_undisturbed_ground_is_in_equilibrium_to_round_off(pile_problem, undisturbed):
    assert pile_problem.out_of_balance(undisturbed) < 1e-14
    step = pile_problem.solve(undisturbed, held())
    assert step.iterations == 0
    np.testing.assert_allclose(step.state.cauchy_stress, undisturbed.cauchy_stress, atol=1e-8)


def test_pile_as_heavy_as_the_soil_starts_without_head_load(pile_problem, undisturbed):
    weight = -pile_problem.model.pile_weight[1]
    assert weight == 18e3 * 0.5 * 1.0
    assert abs(pile_problem.pile_load(undisturbed)[1]) < 1e-11 * weight


def test_horizontal_push_of_the_soil_is_the_k0_pressure(pile_problem, undisturbed):
    """K0 gamma d^2 / 2 pushes the half pile to the axis; the load that holds it is outward."""
    assert pile_problem.pile_load(undisturbed)[0] == pytest.approx(0.8 * 18e3 * 0.5, rel=1e-12)


def test_patch_of_elastic_soil_takes_a_linear_displacement(box_mesh):
    is_fixed = np.zeros((len(box_mesh.nodes), 2), dtype=bool)
    is_fixed[np.unique(box_mesh.facet_nodes)] = True
    problem = ServiceProblem(
        box_mesh, Ground(0.0, 1.0, SOIL), CoulombInterface(1.0, 1.0), is_fixed=is_fixed
    )
    exact = box_mesh.nodes @ GRADIENT.T
    step = problem.solve(problem.wished_in_place_state(), held(), support_motion=exact)
    np.testing.assert_allclose(step.increment.displacement, exact, atol=1e-14)

    strain, stress = np.zeros(6), np.empty(6)
    strain[[0, 1]] = np.diag(GRADIENT)
    strain[3] = np.sqrt(0.5) * (GRADIENT[0, 1] + GRADIENT[1, 0])
    elastic_stress(strain, pack(SOIL), stress)
    for (i, j), value in {(0, 0): stress[0], (1, 1): stress[1], (2, 2): stress[2]}.items():
        np.testing.assert_allclose(step.state.cauchy_stress[:, i, j], value, rtol=1e-10)
    np.testing.assert_allclose(
        step.state.cauchy_stress[:, 0, 1], stress[3] / np.sqrt(2.0), rtol=1e-10
    )
    np.testing.assert_allclose(step.support_reaction.sum(axis=0), 0.0, atol=1e-8)


@pytest.mark.parametrize("is_loaded", [(0, 0, 0), (0, 1, 0), (1, 1, 1)])
def test_tangent_of_the_complete_model_against_finite_differences(pile_problem, pushed, is_loaded):
    """Along Newton's direction the out-of-balance force changes by minus itself: K d = -r.

    With new factors, so that the direction is exact.
    """
    rng = np.random.default_rng(3)
    control = PileControl(
        np.array(is_loaded, dtype=bool), np.array([1e-3, -2e-3, 1e-3]), np.array([5e3, -3e4, 2e3])
    )
    zero = np.zeros_like(pile_problem.gravity(pushed.state))
    step = LoadStep(
        pile_problem.model, pushed.state, control, zero, pile_problem.gravity(pushed.state)
    )
    trial = step.evaluate(
        Unknowns(1e-3 * rng.normal(size=zero.shape), np.array([2e-3, -5e-3, 1e-3]))
    )
    assert np.mean(trial.soil.state_variables[:, 1] > pushed.state.state_variables[:, 1]) > 0.3
    pile_problem.model.solver.forget()
    direction = step.search_direction(trial)
    small = 1e-7 / np.abs(direction).max()
    forward, backward = (
        step.evaluate(
            Unknowns(
                trial.unknowns.displacement + sign * small * direction[:-3].reshape(-1, 2),
                trial.unknowns.motion + sign * small * direction[-3:],
            )
        ).out_of_balance
        for sign in (1.0, -1.0)
    )
    change = (forward - backward) / (2.0 * small)
    error = np.linalg.norm(change + trial.out_of_balance) / np.linalg.norm(trial.out_of_balance)
    assert error < 1e-6


def test_equilibration_is_exact_whatever_the_tolerance_of_the_programmes(
    make_pile_problem, undisturbed
):
    coarse = make_pile_problem(ServiceNumerics(tolerance=1e-4))
    disturbed = undisturbed._replace(cauchy_stress=0.95 * undisturbed.cauchy_stress)
    assert coarse.out_of_balance(disturbed) > 1e-4
    assert coarse.out_of_balance(coarse.release(disturbed, 1.0).state) < 1e-8


def test_load_of_a_prescribed_motion_gives_the_motion_back(make_pile_problem, undisturbed):
    tight = make_pile_problem(ServiceNumerics(tolerance=1e-12))
    prescribed = tight.solve(undisturbed, moved(0.004))
    by_load = tight.solve(undisturbed, loaded(prescribed.head_load))
    assert prescribed.head_load > 1e4
    assert by_load.increment.motion[1] == pytest.approx(-0.004, rel=1e-8)
    np.testing.assert_allclose(
        by_load.increment.displacement, prescribed.increment.displacement, atol=1e-8 * 0.004
    )


def test_load_can_be_taken_away_from_weightless_elastic_soil(pile_mesh):
    """At the end no force is left to measure the residual by."""
    interface = CoulombInterface(2e8, 2e7, cohesion=1e9)
    problem = ServiceProblem(pile_mesh, Ground(0.0, 1.0, SOIL), interface)
    down = problem.solve(problem.wished_in_place_state(), moved(0.004))
    back = problem.solve(down.state, loaded(0.0))
    assert down.head_load > 1e3
    assert back.increment.motion[1] == pytest.approx(0.004, rel=1e-8)
    assert np.abs(back.state.cauchy_stress).max() < 1e-6 * np.abs(down.state.cauchy_stress).max()


def test_three_loaded_motions_give_the_prescribed_ones_back(make_pile_problem, undisturbed):
    tight = make_pile_problem(ServiceNumerics(tolerance=1e-12))
    motion = np.array([5e-4, -1e-3, 3e-4])
    none, every = np.zeros(3, dtype=bool), np.ones(3, dtype=bool)
    prescribed = tight.solve(undisturbed, PileControl(none, motion, np.zeros(3)))
    by_load = tight.solve(undisturbed, PileControl(every, np.zeros(3), prescribed.pile_load))
    np.testing.assert_allclose(by_load.increment.motion, motion, rtol=1e-8)


def test_forces_balance_in_the_accepted_state(pile_problem, pushed):
    """Weight of the soil, supports and pile add up to nothing."""
    from_pile = pushed.pile_load + pile_problem.model.pile_weight
    total = (
        pile_problem.gravity(pushed.state).sum(axis=0)
        + pushed.support_reaction.sum(axis=0)
        + from_pile[:2]
    )
    assert np.linalg.norm(total) < 1e-7 * np.linalg.norm(pile_problem.gravity(pushed.state))


def test_newton_ends_quadratically(pile_problem, undisturbed):
    step = pile_problem.solve(undisturbed, moved(0.02))
    assert convergence_order(np.array(step.residuals)) >= 1.8
    assert step.residuals[-1] <= 1e-9


def test_shaft_of_a_pushed_pile_is_mobilised_up_to_its_adhesion(pile_problem, pushed):
    shear = pushed.state.interface_traction[pile_problem.interface_parts == 1, 0]
    assert np.abs(shear).max() == pytest.approx(0.5 * 20e3, rel=1e-9)
    assert np.mean(np.abs(shear)) > 0.9 * 0.5 * 20e3
    # the tangent points down the shaft, and the pile drags the soil down
    assert np.mean(shear) > 0.0


def test_states_are_values(pile_problem, undisturbed):
    """A step does not depend on those before it, if the solver forgets their factors."""
    before = [np.copy(array) for array in undisturbed]
    pile_problem.model.solver.forget()
    first = pile_problem.solve(undisturbed, moved(0.01)).head_load
    pile_problem.solve(undisturbed, moved(-0.02))
    pile_problem.model.solver.forget()
    assert pile_problem.solve(undisturbed, moved(0.01)).head_load == first
    for array, copy in zip(undisturbed, before, strict=True):
        np.testing.assert_array_equal(array, copy)


def test_step_that_cannot_converge_says_so(make_pile_problem, undisturbed):
    problem = make_pile_problem(ServiceNumerics(max_iterations=3))
    with pytest.raises(StepNotConvergedError, match="after 3 iterations; relative residuals"):
        problem.solve(undisturbed, moved(0.3))


def test_out_of_balance_needs_weight(box_mesh):
    problem = ServiceProblem(box_mesh, Ground(0.0, 1.0, SOIL), CoulombInterface(1.0, 1.0))
    with pytest.raises(ValueError, match=r"give ground\.unit_weight"):
        problem.out_of_balance(problem.wished_in_place_state())


def test_disturbed_stress_is_brought_to_equilibrium(pile_problem, undisturbed):
    """The protocol of the hand-over: after all ramps nothing is out of balance, pile held."""
    rng = np.random.default_rng(4)
    stress = undisturbed.cauchy_stress.copy()
    disturbance = 500.0 * rng.normal(size=len(stress))
    stress[:, 1, 1] += disturbance
    strain = undisturbed.elastic_strain.copy()
    for axis, compliance in enumerate((-0.49, 1.0, -0.49)):
        strain[:, axis, axis] += compliance * disturbance / 4e6
    disturbed = undisturbed._replace(cauchy_stress=stress, elastic_strain=strain)
    assert pile_problem.out_of_balance(disturbed) > 1e-4
    balanced, report = equilibrate(pile_problem, disturbed, HandoffOptions(0.1, 1.0))
    assert report.out_of_balance_after < 1e-8
    assert 0.0 < report.largest_displacement < 0.01
    np.testing.assert_array_equal(balanced.pile_displacement, 0.0)


def test_half_release_halves_what_is_out_of_balance(pile_problem, undisturbed):
    disturbed = pile_problem.solve(
        undisturbed, held(), external_force=1.01 * pile_problem.gravity(undisturbed)
    )
    before = pile_problem.out_of_balance(disturbed.state)
    released = pile_problem.release(disturbed.state, 0.5)
    assert pile_problem.out_of_balance(released.state) == pytest.approx(0.5 * before, rel=1e-5)


def test_pile_that_the_rig_let_go_of_comes_to_its_load(pile_problem, undisturbed):
    """The soil's force on it goes to what it carries by the share released, in free motion."""
    before = pile_problem.pile_load(undisturbed)
    change = np.array([300.0, 4000.0, 150.0])
    weight = pile_problem.model.pile_weight
    wanted = -(before + weight + change)
    half = pile_problem.release(undisturbed, 0.5, wanted)
    scale = np.abs(wanted).max()
    load = pile_problem.pile_load(half.state)
    np.testing.assert_allclose(load, before + 0.5 * change, atol=1e-8 * scale)
    rest = pile_problem.release(half.state, 1.0, wanted)
    load = pile_problem.pile_load(rest.state)
    np.testing.assert_allclose(load, before + change, atol=1e-8 * scale)
    lifted = rest.pile_displacement
    assert lifted.shape == pile_problem.interface_positions.shape
    assert np.all(lifted[:, 1] > 0.0)
    assert pile_problem.out_of_balance(rest.state) < 1e-8


def test_failed_release_raises_the_error_of_the_hand_over(make_pile_problem, undisturbed):
    problem = make_pile_problem(ServiceNumerics(max_iterations=3))
    upside_down = undisturbed._replace(
        cauchy_stress=-30.0 * undisturbed.cauchy_stress,
        elastic_strain=-30.0 * undisturbed.elastic_strain,
    )
    with pytest.raises(EquilibrationError, match="take more equilibration steps"):
        problem.release(upside_down, 1.0)
