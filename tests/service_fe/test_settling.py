"""A settled step ends in equilibrium of the undamped soil, near what Newton's method finds."""

import numpy as np
import pytest

from service_fe.loading import imposed_steps
from service_fe.newton import StepNotConvergedError
from service_fe.options import Displace, ServiceNumerics
from service_fe.rigid_pile import moved
from service_fe.settling import settle
from service_fe.solve import advance

pytestmark = pytest.mark.dolfinx

PUSH = 0.04


@pytest.fixture(scope="module")
def settled(pile_problem, undisturbed):
    return settle(pile_problem, undisturbed, moved(PUSH), damping=0.1)


def test_settled_step_is_in_equilibrium_without_damping(settled, pile_problem):
    assert settled.parts > 3
    assert settled.last.residuals[-1] <= pile_problem.numerics.tolerance
    assert settled.increment.motion[1] == pytest.approx(-PUSH, rel=1e-12)
    assert pile_problem.out_of_balance(settled.last.state) < 1e-7


def test_settled_step_is_near_the_direct_one(settled, pile_problem, undisturbed):
    direct = pile_problem.solve(undisturbed, moved(PUSH))
    assert settled.last.head_load == pytest.approx(direct.head_load, rel=0.02)


def test_damping_resists_the_motion(pile_problem, undisturbed):
    free = pile_problem.solve(undisturbed, moved(PUSH))
    damped = pile_problem.solve(undisturbed, moved(PUSH), damping=0.1)
    assert damped.head_load == pytest.approx(free.head_load, rel=1e-12) or (
        damped.head_load > free.head_load
    )
    assert not np.allclose(damped.increment.displacement, free.increment.displacement)


def test_step_that_does_not_converge_is_settled_only_if_asked(make_pile_problem, undisturbed):
    step = imposed_steps(Displace("push", PUSH, PUSH, first_step_halvings=0), np.zeros(3))[0]
    with pytest.raises(StepNotConvergedError):
        advance(make_pile_problem(ServiceNumerics(max_iterations=5, max_cuts=0)), undisturbed, step)
    patient = ServiceNumerics(max_iterations=5, max_cuts=0, damping=0.1)
    taken = advance(make_pile_problem(patient), undisturbed, step)
    assert taken.settled > 0
    assert taken.cuts == 0
