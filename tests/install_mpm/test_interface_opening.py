"""Opening and closing of the interface: smoothing, tension cut-off, memory of gap and traction."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from install_mpm.constitutive import coulomb_interface
from install_mpm.constitutive.coulomb_interface import OPEN, STICK
from install_mpm.constitutive.parameters import CoulombInterface

KN, KS, C, SMOOTHING = 2e7, 3e6, 5e3, 400.0
FRICTION, DILATION = np.radians(30.0), np.radians(8.0)
SLACK = 1e-12
"""Round-off of a traction over the largest one."""
LAWS = {
    "friction": CoulombInterface(KN, KS, C, friction_angle=FRICTION),
    "dilation": CoulombInterface(KN, KS, C, friction_angle=FRICTION, dilation_angle=DILATION),
    "without cohesion": CoulombInterface(KN, KS, friction_angle=FRICTION),
    "cut-off": CoulombInterface(
        KN, KS, C, friction_angle=FRICTION, dilation_angle=DILATION, tensile_strength=1e3
    ),
    "adhesion without tension": CoulombInterface(KN, KS, C, tensile_strength=0.0),
}
SMOOTH = {name: replace(law, smoothing_stress=SMOOTHING) for name, law in LAWS.items()}
every_law = pytest.mark.parametrize("law", SMOOTH)
every_dim = pytest.mark.parametrize("dim", [2, 3])


def evaluate(law, slip, old):
    """Evaluate the law at all points: slip increments and old tractions (n, dim)."""
    slip, old = np.atleast_2d(slip).astype(float), np.atleast_2d(old).astype(float)
    n, dim = slip.shape
    result = SimpleNamespace(
        traction=np.empty((n, dim)), tangent=np.empty((n, dim, dim)), status=np.full(n, -1)
    )
    coulomb_interface.update_all(
        slip, coulomb_interface.pack(law, np.zeros(n)), old, result.traction, result.tangent,
        result.status,
    )  # fmt: skip
    return result


def limit(law):
    return coulomb_interface.pack(law, np.zeros(1))[0, coulomb_interface.TENSILE_LIMIT]


@pytest.fixture
def states(rng):
    """Function that returns slips and old tractions of a law, most of them about to open."""

    def make(law, dim, n=400):
        slip = rng.normal(size=(n, dim)) * 3e-4
        slip[:, -1] = rng.normal(size=n) * 3.0 * SMOOTHING / KN
        resting = np.zeros((n, dim))
        resting[:, -1] = limit(law) - np.abs(rng.normal(size=n)) * 2.0 * SMOOTHING
        old = evaluate(law, 0.5 * slip, resting).traction
        return slip, old

    return make


@every_law
@every_dim
def test_a_step_without_motion_changes_no_traction(law, dim, states):
    _, old = states(SMOOTH[law], dim)
    result = evaluate(SMOOTH[law], np.zeros_like(old), old)
    np.testing.assert_allclose(result.traction, old, atol=1e3 * SLACK * np.abs(old).max())


@every_law
@every_dim
def test_tangent_is_the_derivative_of_the_traction_at_the_apex(law, dim, states):
    """At random states within the smoothing; only sticking against slipping is a kink."""
    slip, old = states(SMOOTH[law], dim)
    result = evaluate(SMOOTH[law], slip, old)
    assert {0, 1, 2} <= set(result.status)
    step = 1e-10
    for component, direction in enumerate(np.eye(dim)):
        ends = [evaluate(SMOOTH[law], slip + sign * step * direction, old) for sign in (1.0, -1.0)]
        is_smooth = (ends[0].status == result.status) & (ends[1].status == result.status)
        assert is_smooth.mean() > 0.99
        derivative = (ends[0].traction - ends[1].traction) / (2.0 * step)
        error = np.abs(result.tangent[:, :, component] - derivative)[is_smooth]
        assert error.max() < 1e-5 * KN
        assert np.median(error) < 1e-6 * KN


@every_law
@every_dim
def test_beyond_the_smoothing_the_law_is_the_exact_one(law, dim, states):
    slip, old = states(LAWS[law], dim)
    exact, smooth = evaluate(LAWS[law], slip, old), evaluate(SMOOTH[law], slip, old)
    pressures = limit(LAWS[law]) - np.array([old[:, -1], exact.traction[:, -1]])
    is_beyond = (pressures > SMOOTHING).all(axis=0)
    assert is_beyond.any()
    for name in ("traction", "tangent", "status"):
        expected = getattr(exact, name)[is_beyond]
        scale = np.abs(expected).max()
        np.testing.assert_allclose(
            getattr(smooth, name)[is_beyond], expected, atol=1e-9 * scale, err_msg=name
        )


@pytest.mark.parametrize("law", ["friction", "dilation", "without cohesion"])
def test_the_smoothing_vanishes_with_its_stress(law, states):
    slip, old = states(LAWS[law], 3)
    exact = evaluate(LAWS[law], slip, old).traction
    errors = [
        np.abs(evaluate(replace(LAWS[law], smoothing_stress=d), slip, old).traction - exact).max()
        for d in (SMOOTHING, SMOOTHING / 2.0, SMOOTHING / 4.0)
    ]
    assert errors[0] <= SMOOTHING
    np.testing.assert_array_less(errors[1:], 0.75 * np.array(errors[:-1]))


@every_law
def test_opening_and_closing_come_back_to_the_same_traction(law):
    """In many steps and in one, as long as the gap is narrower than the smoothing remembers."""
    old = np.array([[0.0, limit(LAWS[law]) - 0.8 * SMOOTHING]])
    spring = 2.0 * np.sqrt(0.8) * SMOOTHING - SMOOTHING
    gap = (spring + 0.9 * SMOOTHING) / KN  # up to x = -0.9 d
    opened = old
    for _ in range(10):
        opened = evaluate(SMOOTH[law], [[0.0, gap / 10.0]], opened).traction
    np.testing.assert_allclose(opened, evaluate(SMOOTH[law], [[0.0, gap]], old).traction)
    closed = evaluate(SMOOTH[law], [[0.0, -gap]], opened).traction
    np.testing.assert_allclose(closed, old, atol=1e-9)


@every_dim
def test_a_wide_gap_counts_as_wide_as_the_smoothing(dim):
    """Closing by d / k_n brings the open point to x = 0, where the pressure is d / 4."""
    opening = np.zeros((1, dim))
    opening[0, -1] = 0.1
    law = SMOOTH["adhesion without tension"]
    opened = evaluate(law, opening, np.zeros((1, dim)))
    assert opened.status[0] == OPEN
    assert not opened.traction.any()
    assert not opened.tangent.any()
    closing = np.zeros((1, dim))
    closing[0, -1] = -SMOOTHING / KN
    closed = evaluate(law, closing, opened.traction)
    assert closed.status[0] == STICK
    np.testing.assert_allclose(closed.traction[0, -1], -SMOOTHING / 4.0)


def test_clay_with_a_cut_off_opens_without_tension_and_without_shear():
    law = SMOOTH["adhesion without tension"]
    pressed = np.array([[0.0, -20e3]])
    slid = evaluate(law, [[0.1, 0.0]], pressed)
    np.testing.assert_allclose(slid.traction, [[C, -20e3]])
    opened = evaluate(law, [[0.0, 0.01]], slid.traction)
    np.testing.assert_array_equal(opened.traction, [[0.0, 0.0]])
    again = evaluate(law, [[0.1, -21e3 / KN]], opened.traction)
    np.testing.assert_allclose(again.traction, [[C, -21e3 + SMOOTHING]])


@every_dim
def test_bonded_clay_does_not_know_the_smoothing(dim, rng):
    law = CoulombInterface(KN, KS, C)
    slip, old = rng.normal(size=(50, dim)) * 1e-2, rng.normal(size=(50, dim)) * 1e3
    plain = evaluate(law, slip, old)
    smooth = evaluate(replace(law, smoothing_stress=SMOOTHING), slip, old)
    np.testing.assert_array_equal(plain.traction, smooth.traction)
    np.testing.assert_array_equal(plain.tangent, smooth.tangent)


@pytest.mark.parametrize("advance_ratio", [1.0, 0.5])
@pytest.mark.parametrize("law", ["friction", "adhesion without tension"])
def test_a_screwed_shaft_has_one_slip_direction(law, advance_ratio):
    """T = 2 pi a^2 L tau cos(b) and F = 2 pi a L tau sin(b) with tan(b) = p AR / (2 pi a)."""
    radius, pitch, pressure = 0.44, 0.56, 30e3
    angle = np.arctan(pitch * advance_ratio / (2.0 * np.pi * radius))
    assert np.sin(angle) == pytest.approx({1.0: 0.19853, 0.5: 0.10076}[advance_ratio], rel=1e-4)
    slip = 2e-3 * np.array([[np.cos(angle), np.sin(angle), 0.0]])
    traction = np.array([[0.0, 2e3, -pressure]])  # jacked before it is turned
    for _ in range(100):
        traction = evaluate(SMOOTH[law], slip, traction).traction
    strength = C + pressure * np.tan(LAWS[law].friction_angle)
    expected = [strength * np.cos(angle), strength * np.sin(angle), -pressure]
    np.testing.assert_allclose(traction[0], expected, rtol=1e-6)


def test_shear_remembers_its_traction_while_it_sticks():
    """A cycle within the strength is elastic; beyond it dissipates 4 tau_y (u_a - tau_y / k_s)."""
    law, pressure, amplitude, n = SMOOTH["without cohesion"], 10e3, 5e-3, 400
    strength = pressure * np.tan(FRICTION)
    path = amplitude * np.concatenate(
        [np.linspace(0.0, 1.0, n), np.linspace(1.0, -1.0, 2 * n), np.linspace(-1.0, 1.0, 2 * n)]
    )
    shear, old = [0.0], np.array([[0.0, -pressure]])
    for increment in np.diff(path):
        old = evaluate(law, [[increment, 0.0]], old).traction
        shear.append(old[0, 0])
    force, moved = np.array(shear)[n:], np.diff(path[n:])
    work = (0.5 * (force[1:] + force[:-1]) * moved).sum()
    assert work == pytest.approx(4.0 * strength * (amplitude - strength / KS), rel=1e-4)
    assert shear[-1] == pytest.approx(strength, rel=1e-12)
    assert old[0, 1] == -pressure
