"""Programmes: start states, branches, cutting, observers and messages."""

import numpy as np
import pytest

from service_fe.loading import imposed_steps
from service_fe.newton import StepNotConvergedError
from service_fe.options import Displace, Release, Resume, ServiceNumerics
from service_fe.rigid_pile import moved
from service_fe.solve import ServiceError, advance, run, run_programme

pytestmark = pytest.mark.dolfinx

COMPRESSION = Displace("compression", displacement=0.06, step=0.02, first_step_halvings=0)


@pytest.fixture(scope="module")
def pushed(pile_problem, undisturbed):
    """Equilibrated state with a head load, as an installation leaves it."""
    return pile_problem.solve(undisturbed, moved(0.03)).state


@pytest.fixture(scope="module")
def result(pile_problem, pushed):
    programmes = (
        Release(steps=4),
        COMPRESSION,
        Displace("uplift", displacement=-0.06, step=0.02),
        Displace("push_on", displacement=0.02, step=0.01, start="equilibrated"),
    )
    return run(pile_problem, pushed, programmes, case_text="title = 'test'")


def test_release_ends_without_head_load(result, pile_problem, pushed):
    curve = result.programme("release").curve
    start = -2.0 * pile_problem.pile_load(pushed)[1]
    assert curve.head_load[0] == pytest.approx(start, rel=1e-12)
    np.testing.assert_allclose(curve.head_load, start * np.linspace(1, 0, 5), atol=1e-5 * start)
    assert np.all(np.diff(curve.displacement) < 0.0)  # the pile rises


def test_branches_start_from_their_state(result):
    release, push_on = result.programme("release").curve, result.programme("push_on").curve
    assert push_on.head_load[0] == release.head_load[0]
    for name in ("compression", "uplift"):
        assert result.programme(name).curve.head_load[0] == pytest.approx(
            release.head_load[-1], abs=1e-5 * release.head_load[0]
        )


def test_signs_of_curves(result):
    compression, uplift = result.programme("compression").curve, result.programme("uplift").curve
    assert compression.displacement[-1] == pytest.approx(0.06)
    assert compression.head_load[-1] > 1e5
    assert uplift.displacement[-1] == pytest.approx(-0.06)
    assert uplift.head_load[-1] < -1e5


def test_branch_does_not_depend_on_the_others(result, pile_problem):
    alone = run_programme(pile_problem, result.programme("release").state, COMPRESSION)
    among_others = result.programme("compression")
    np.testing.assert_array_equal(alone.curve.head_load, among_others.curve.head_load)


def test_pushing_on_repeats_a_longer_push(pile_problem, undisturbed, pushed):
    whole = run_programme(pile_problem, undisturbed, Displace("whole", 0.06, 0.03))
    rest = run_programme(pile_problem, pushed, Displace("rest", 0.03, 0.03))
    assert rest.curve.head_load[-1] == pytest.approx(whole.curve.head_load[-1], rel=0.01)


def test_every_step_is_converged_and_its_history_kept(result, pile_problem):
    for programme in result.programmes:
        curve = programme.curve
        assert np.all(curve.residual <= pile_problem.numerics.tolerance)
        last = [row[~np.isnan(row)][-1] for row in curve.residual_history[1:]]
        np.testing.assert_array_equal(last, curve.residual[1:])


def test_final_state_carries_the_last_load(result, pile_problem):
    for programme in result.programmes:
        load = -2.0 * pile_problem.pile_load(programme.state)[1]
        assert load == pytest.approx(programme.curve.head_load[-1], rel=1e-9, abs=1e-3)


def test_soil_below_the_base_follows_the_pile(result, pile_mesh):
    compression = result.programme("compression")
    centre = np.argmin(np.hypot(pile_mesh.nodes[:, 0], pile_mesh.nodes[:, 1] + 1.0))
    assert compression.soil.displacement[centre, 1] == pytest.approx(-0.06, rel=0.05)


def test_observer_is_told_each_step(pile_problem, undisturbed):
    seen = []
    push = Displace("push", 0.02, 0.01, "equilibrated", first_step_halvings=1)
    done = run(pile_problem, undisturbed, [push], seen.append)
    assert [(item.step, item.n_steps) for item in seen] == [(1, 3), (2, 3), (3, 3)]
    np.testing.assert_array_equal(
        [item.head_load for item in seen], done.programmes[0].curve.head_load[1:]
    )
    assert [item.displacement for item in seen] == pytest.approx([0.005, 0.01, 0.02])


def one_push(displacement):
    """One step downward."""
    programme = Displace("push", displacement, displacement, first_step_halvings=0)
    return imposed_steps(programme, np.zeros(3))[0]


def test_step_is_cut_until_it_converges(make_pile_problem, undisturbed):
    whole = one_push(0.04)
    patient = advance(make_pile_problem(), undisturbed, whole)
    hasty = advance(make_pile_problem(ServiceNumerics(max_iterations=4)), undisturbed, whole)
    assert patient.cuts == 0
    assert hasty.cuts > 0
    assert hasty.increment.motion[1] == pytest.approx(-0.04, rel=1e-12)
    assert hasty.last.head_load == pytest.approx(patient.last.head_load, rel=0.02)


def test_step_that_fails_after_all_cuts_is_never_accepted(make_pile_problem, undisturbed):
    problem = make_pile_problem(ServiceNumerics(max_iterations=3, max_cuts=1))
    with pytest.raises(StepNotConvergedError, match="relative residuals"):
        advance(problem, undisturbed, one_push(0.3))
    with pytest.raises(ServiceError, match=r"'far', step 1 of 1 at 0 m: .*take smaller steps"):
        run_programme(problem, undisturbed, Displace("far", 0.3, 0.3, first_step_halvings=0))


@pytest.mark.parametrize(
    ("programmes", "message"),
    [
        ([Displace("push", 0.1, 0.01)], 'kind "release" before it'),
        ([Displace("push", 0.1, 0.01, "resumed")], 'kind "resume" before it'),
        ([Displace("push", 0.0, 0.01, "equilibrated")], "has no displacement"),
        ([Release("one"), Release("one")], "2 programmes are named 'one'"),
        ([Displace("push", 0.1, 0.01, "later")], "starts from 'later', which is not before it"),
    ],
)
def test_programmes_that_cannot_run_are_refused(pile_problem, undisturbed, programmes, message):
    with pytest.raises(ServiceError, match=message):
        run(pile_problem, undisturbed, programmes)


def test_unknown_programme_is_named(result):
    with pytest.raises(KeyError, match="there are: release, compression"):
        result.programme("lateral")


def test_first_step_is_resolved():
    steps = imposed_steps(Displace("push", 0.1, 0.05, first_step_halvings=3), np.zeros(3))
    sizes = [step.size for step in steps]
    assert sizes == pytest.approx([0.00625, 0.00625, 0.0125, 0.025, 0.05])


def test_rig_takes_the_pile_back_to_where_it_let_go():
    """It rose by 8 mm and turned by 0.02 rad; without a rebound it stays, under its load."""
    rebound, load = np.array([0.0, 0.0, 8e-3, 0.0, 0.0, 0.02]), np.arange(6.0)
    let_go, *steps = imposed_steps(Resume(steps=4), load, rebound)
    control = let_go.control(0.0, 1.0)
    np.testing.assert_array_equal(np.flatnonzero(control.is_loaded), [2, 5])
    assert not control.load[control.is_loaded].any()
    assert not control.motion.any()
    assert [step.size for step in steps] == pytest.approx([2e-3] * 4)
    control = steps[0].control(0.0, 1.0)
    assert not control.is_loaded.any()
    np.testing.assert_allclose(control.motion, [0.0, 0.0, -2e-3, 0.0, 0.0, -5e-3])
    (still,) = imposed_steps(Resume(), load)
    assert not still.control(0.0, 1.0).motion.any()
    np.testing.assert_array_equal(still.load_end, load)


def test_release_steps_go_to_zero():
    steps = imposed_steps(Release(steps=2), np.array([7.0, -100.0, 3.0]))
    assert [(step.load_start[1], step.load_end[1]) for step in steps] == [(-100, -50), (-50, 0)]
    assert [step.size for step in steps] == [-50.0, -50.0]
    np.testing.assert_array_equal(steps[0].mode.is_loaded, [False, True, False])
    assert steps[1].control(0.0, 0.5).load[1] == -25.0
