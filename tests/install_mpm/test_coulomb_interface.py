"""The interface law: spring, slider and apex, in two and three dimensions (paper, eqs 10-14)."""

from types import SimpleNamespace

import numpy as np
import pytest

from install_mpm.constitutive import coulomb_interface
from install_mpm.constitutive.coulomb_interface import OPEN, SLIP, STICK
from install_mpm.constitutive.parameters import CoulombInterface

KN, KS, C = 2e7, 3e6, 5e3
FRICTION, DILATION = np.radians(30.0), np.radians(8.0)
LAWS = {
    "friction": CoulombInterface(KN, KS, C, friction_angle=FRICTION),
    "dilation": CoulombInterface(KN, KS, C, friction_angle=FRICTION, dilation_angle=DILATION),
    "associated": CoulombInterface(KN, KS, C, friction_angle=FRICTION, dilation_angle=FRICTION),
    "adhesion": CoulombInterface(KN, KS, adhesion_factor=0.5),
    "without cohesion": CoulombInterface(KN, KS, friction_angle=FRICTION),
}
STRENGTH = 20e3
every_law = pytest.mark.parametrize("law", LAWS)
every_dim = pytest.mark.parametrize("dim", [2, 3])


def evaluate(law, slip, old):
    """Evaluate the law at all points: slip increments and old tractions (n, dim)."""
    parameters = LAWS[law] if isinstance(law, str) else law
    n, dim = slip.shape
    result = SimpleNamespace(
        traction=np.empty((n, dim)), tangent=np.empty((n, dim, dim)), status=np.full(n, -1)
    )
    coulomb_interface.update_all(
        np.ascontiguousarray(slip),
        coulomb_interface.pack(parameters, np.full(n, STRENGTH)),
        np.ascontiguousarray(old),
        result.traction,
        result.tangent,
        result.status,
    )
    return result


def cohesion(law):
    return LAWS[law].cohesion + LAWS[law].adhesion_factor * STRENGTH


def tangents(law):
    """tan(phi), tan(psi)"""
    return np.tan(LAWS[law].friction_angle), np.tan(LAWS[law].dilation_angle)


@pytest.fixture
def states(rng):
    """Function that returns slips and old tractions that stick, slip and open."""

    def make(dim, n=200):
        slip = rng.normal(size=(n, dim)) * 2e-2
        slip[: n // 4] *= 1e-3
        old = rng.normal(size=(n, dim)) * 1e3
        old[:, -1] = -np.abs(old[:, -1]) * 10.0
        return slip, old

    return make


@every_law
@every_dim
def test_backward_euler(law, dim, states):
    """t = t_n + D (dw - lambda dg/dt) with f <= 0, lambda >= 0, lambda f = 0 at the *end*."""
    slip, old = states(dim)
    result = evaluate(law, slip, old)
    friction, dilation = tangents(law)
    stiffness = np.array([KS] * (dim - 1) + [KN])
    plastic = slip - (result.traction - old) / stiffness
    shear = np.linalg.norm(result.traction[:, :-1], axis=1)
    yield_value = shear + result.traction[:, -1] * friction - cohesion(law)
    scale = np.abs(result.traction).max()
    assert yield_value.max() <= 1e-9 * scale
    sticks, slips = result.status == STICK, result.status == SLIP
    assert sticks.any()
    assert slips.any()
    assert np.abs(plastic[sticks]).max() < 1e-15
    assert np.abs(yield_value[slips]).max() <= 1e-9 * scale
    multiplier = np.linalg.norm(plastic[slips, :-1], axis=1)
    direction = result.traction[slips, :-1] / shear[slips, None]
    np.testing.assert_allclose(plastic[slips, :-1], multiplier[:, None] * direction, atol=1e-14)
    np.testing.assert_allclose(plastic[slips, -1], multiplier * dilation, atol=1e-14)


@every_law
@every_dim
def test_tangent_is_the_derivative_of_the_traction(law, dim, states):
    slip, old = states(dim)
    result = evaluate(law, slip, old)
    step = 1e-8
    for component, direction in enumerate(np.eye(dim)):
        forward = evaluate(law, slip + step * direction, old)
        backward = evaluate(law, slip - step * direction, old)
        is_smooth = (forward.status == result.status) & (backward.status == result.status)
        assert is_smooth.mean() > 0.95
        derivative = (forward.traction - backward.traction) / (2.0 * step)
        error = np.abs(result.tangent[:, :, component] - derivative)[is_smooth]
        assert error.max() < 1e-6 * KN


@every_dim
def test_small_slip_sticks_elastically(dim):
    slip = np.full((1, dim), 1e-6)
    result = evaluate("friction", slip, np.zeros((1, dim)))
    assert result.status[0] == STICK
    np.testing.assert_allclose(result.traction[0], [KS * 1e-6] * (dim - 1) + [KN * 1e-6])
    np.testing.assert_allclose(result.tangent[0], np.diag([KS] * (dim - 1) + [KN]))


def test_slip_without_dilation_keeps_the_normal_traction():
    pressure = 100e3
    result = evaluate("friction", np.array([[1.0, 0.0]]), np.array([[0.0, -pressure]]))
    assert result.status[0] == SLIP
    strength = C + pressure * np.tan(FRICTION)
    np.testing.assert_allclose(result.traction[0], [strength, -pressure], rtol=1e-12)


def test_dilation_presses_the_pile_against_the_soil():
    """At a fixed gap, slip s raises the pressure by k_n tan(psi) times the plastic slip."""
    result = evaluate("dilation", np.array([[0.05, 0.0]]), np.array([[0.0, -100e3]]))
    plastic_slip = 0.05 - result.traction[0, 0] / KS
    rise = -100e3 - result.traction[0, 1]
    assert plastic_slip > 0.0
    assert rise == pytest.approx(KN * np.tan(DILATION) * plastic_slip, rel=1e-12)


@pytest.mark.parametrize("law", ["friction", "dilation", "associated", "without cohesion"])
@every_dim
def test_tension_ends_at_the_apex(law, dim):
    slip = np.zeros((1, dim))
    slip[0, -1] = 0.1
    result = evaluate(law, slip, np.zeros((1, dim)))
    apex = cohesion(law) / np.tan(FRICTION)
    assert result.status[0] == OPEN
    np.testing.assert_allclose(result.traction[0], [0.0] * (dim - 1) + [apex], atol=1e-9)
    assert not result.tangent.any()


def test_without_friction_the_interface_is_bonded():
    """Adhesion limits the shear traction only; the normal spring carries tension."""
    result = evaluate("adhesion", np.array([[0.1, 0.01]]), np.zeros((1, 2)))
    np.testing.assert_allclose(result.traction[0], [0.5 * STRENGTH, 0.01 * KN], rtol=1e-12)


@every_dim
def test_smooth_interface_carries_no_shear(dim, states):
    """Neither cohesion nor friction: the shear traction is zero, whatever round-off does."""
    slip, old = states(dim, 2000)
    result = evaluate(CoulombInterface(KN, KS), slip, old)
    assert np.isfinite(result.traction).all()
    assert np.isfinite(result.tangent).all()
    assert np.abs(result.traction[:, :-1]).max() < 1e-9
    np.testing.assert_allclose(result.traction[:, -1], old[:, -1] + KN * slip[:, -1])
    np.testing.assert_allclose(result.tangent[:, -1, -1], KN)


def test_in_space_slip_has_one_direction():
    """A slipping point moves along the trial direction; along it, the problem is plane."""
    old = np.array([[1e3, -2e3, -50e3]])
    slip = np.array([[0.03, 0.01, 1e-4]])
    result = evaluate("dilation", slip, old)
    trial = old[0, :2] + KS * slip[0, :2]
    direction = trial / np.linalg.norm(trial)
    shear = np.linalg.norm(result.traction[0, :2])
    np.testing.assert_allclose(result.traction[0, :2] / shear, direction, rtol=1e-13)
    along = (np.linalg.norm(trial) - old[0, :2] @ direction) / KS
    plane = evaluate(
        "dilation", np.array([[along, 1e-4]]), np.array([[old[0, :2] @ direction, old[0, 2]]])
    )
    np.testing.assert_allclose([shear, result.traction[0, 2]], plane.traction[0], rtol=1e-12)


def test_turning_the_tangential_axes_turns_the_traction(states, make_rotation):
    slip, old = states(3)
    turn = make_rotation(2)
    plain = evaluate("dilation", slip, old)
    turned = evaluate("dilation", slip @ turn.T, old @ turn.T)
    scale = np.abs(plain.traction).max()
    np.testing.assert_allclose(turned.traction, plain.traction @ turn.T, atol=1e-12 * scale)
    np.testing.assert_allclose(turned.tangent, turn @ plain.tangent @ turn.T, atol=1e-11 * KN)


def test_cohesion_is_the_share_of_the_strength_beside_it():
    law = CoulombInterface(KN, KS, 1e3, 0.5, FRICTION, DILATION)
    packed = coulomb_interface.pack(law, np.array([10e3, 20e3]))
    friction = np.tan(FRICTION)
    expected = [KN, KS, 6e3, friction, np.tan(DILATION), 6e3 / friction, 0.0]
    np.testing.assert_allclose(packed[0], expected)
    assert packed[1, 2] == 11e3


def test_results_do_not_depend_on_the_number_of_threads(states, threads):
    slip, old = states(3)
    results = []
    for n in (1, 2):
        threads(n)
        results.append(vars(evaluate("dilation", slip, old)))
    for name, value in results[0].items():
        np.testing.assert_array_equal(value, results[1][name])


def test_slip_in_a_large_step_leaves_no_round_off_of_the_trial():
    """The trial of 5e5 Pa is 5e6 times the strength, and the traction is exact all the same."""
    weak = CoulombInterface(1e7, 1e7, cohesion=0.1, friction_angle=FRICTION)
    result = evaluate(weak, np.array([[0.05, 0.0]]), np.zeros((1, 2)))
    assert result.status[0] == SLIP
    assert result.traction[0, 0] == pytest.approx(0.1, rel=1e-15)
