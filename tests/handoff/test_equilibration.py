"""Equilibration of two bars that share a load: a complete problem with one unknown."""

import numpy as np
import pytest

from handoff.equilibration import (
    EquilibrationError,
    EquilibriumProblem,
    ReleasedState,
    equilibrate,
)
from handoff.fe_state_file import FEState
from handoff.options import HandoffOptions

OPTIONS = HandoffOptions(size_at_pile=0.1, size_far=1.0, equilibration_steps=4)


class TwoBars:
    """Two elastic-perfectly plastic bars, side by side, carry 10 N: stresses sum up to 10."""

    modulus, strength, load = 1000.0, 8.0, 10.0
    integration_positions = np.zeros((2, 2))
    integration_volumes = np.ones(2)
    interface_positions = np.zeros((0, 2))
    interface_areas = np.zeros(0)
    interface_normals = np.zeros((0, 2))
    interface_facet_normals = np.zeros((0, 2))
    interface_strength_share = np.zeros(0)
    interface_parts = np.zeros(0, dtype=np.int64)

    def __init__(self, largest_force: float = np.inf, leftover: float = 0.0) -> None:
        self.largest_force, self.leftover = largest_force, leftover
        self.shares: list[float] = []

    def residual(self, state: FEState) -> float:
        return self.load - state.cauchy_stress[:, 1, 1].sum()

    def out_of_balance(self, state: FEState) -> float:
        return abs(self.residual(state)) / self.load

    def release(
        self, state: FEState, share: float, on_pile: np.ndarray | None = None
    ) -> ReleasedState:
        self.shares.append(share)
        self.on_pile = on_pile
        if share * abs(self.residual(state)) > self.largest_force:
            raise EquilibrationError("step too large")
        target = self.load - (1.0 - share) * self.residual(state) - self.leftover
        stretch, iterations = 0.0, 0
        stress = state.cauchy_stress[:, 1, 1]
        while abs(target - stress.sum()) > 1e-12:
            is_elastic = np.abs(stress) < self.strength
            stretch += (target - stress.sum()) / (self.modulus * is_elastic.sum())
            stress = state.cauchy_stress[:, 1, 1] + self.modulus * stretch
            stress, iterations = np.clip(stress, -self.strength, self.strength), iterations + 1
        new = state.cauchy_stress.copy()
        new[:, 1, 1] = stress
        return ReleasedState(
            state._replace(cauchy_stress=new, pile_displacement=np.array([0.0, 1e-9])),
            np.array([[0.0, stretch], [0.0, 0.0]]),
            np.array([[0.0, 0.5 * stretch]]),
            iterations,
        )


def bars(first: float, second: float) -> FEState:
    stress = np.zeros((2, 3, 3))
    stress[:, 1, 1] = first, second
    return FEState(
        stress,
        np.zeros((2, 3, 3)),
        np.zeros((2, 0)),
        np.zeros(2, dtype=np.int64),
        np.zeros((0, 2)),
        np.zeros(2),
    )


def test_elastic_bars_share_what_was_missing():
    problem: EquilibriumProblem = TwoBars()
    state, report = equilibrate(problem, bars(2.0, 4.0), OPTIONS)
    assert state.cauchy_stress[:, 1, 1] == pytest.approx([4.0, 6.0])
    assert report.out_of_balance_before == pytest.approx(0.4)
    assert report.out_of_balance_after < 1e-12
    assert report.largest_displacement == pytest.approx(2.0 / 1000.0)
    assert report.pile_displacement == pytest.approx(1.0 / 1000.0)
    assert report.stress_change == pytest.approx(np.sqrt(8.0 / 20.0))
    assert len(report.iterations) == 4


def test_a_yielding_bar_leaves_the_rest_to_the_other():
    state, report = equilibrate(TwoBars(), bars(-2.0, 7.5), OPTIONS)
    assert state.cauchy_stress[:, 1, 1] == pytest.approx([2.0, 8.0])
    assert report.largest_displacement == pytest.approx(4.0 / 1000.0)


def test_ramps_are_equal_parts_of_the_force():
    problem = TwoBars()
    equilibrate(problem, bars(2.0, 4.0), OPTIONS)
    assert problem.shares == pytest.approx([1 / 4, 1 / 3, 1 / 2, 1.0])


def test_displacement_of_the_pile_is_reset():
    state, _ = equilibrate(TwoBars(), bars(2.0, 4.0), OPTIONS)
    assert np.array_equal(state.pile_displacement, np.zeros(2))


def test_a_balanced_state_is_returned_unmoved():
    problem, state = TwoBars(), bars(3.0, 7.0)
    balanced, report = equilibrate(problem, state, OPTIONS)
    assert balanced is state
    assert problem.shares == []
    assert report.largest_displacement == report.stress_change == report.pile_displacement == 0.0


def test_a_pile_that_carries_a_known_load_is_equilibrated_even_if_the_soil_is_balanced():
    problem, load = TwoBars(), np.array([0.0, 5.0, 0.0])
    state, report = equilibrate(problem, bars(3.0, 7.0), OPTIONS, load)
    assert problem.on_pile is load
    assert len(report.iterations) == 4
    assert state.cauchy_stress[:, 1, 1] == pytest.approx([3.0, 7.0])


def test_a_ramp_that_fails_is_halved():
    problem = TwoBars(largest_force=0.6)
    state, report = equilibrate(problem, bars(2.0, 4.0), OPTIONS)
    assert state.cauchy_stress[:, 1, 1] == pytest.approx([4.0, 6.0])
    assert len(report.iterations) == 8


def test_a_ramp_that_fails_however_short_is_named():
    with pytest.raises(EquilibrationError, match=r"failed after 0% .*step too large"):
        equilibrate(TwoBars(largest_force=0.01), bars(2.0, 4.0), OPTIONS)


def test_what_is_left_out_of_balance_is_named():
    with pytest.raises(EquilibrationError, match=r"handoff\.max_out_of_balance = 1e-08"):
        equilibrate(TwoBars(leftover=1e-6), bars(2.0, 4.0), OPTIONS)


def test_a_residual_that_is_no_number_is_refused():
    problem = TwoBars()
    with pytest.raises(EquilibrationError):
        equilibrate(problem, bars(np.nan, 4.0), OPTIONS)
