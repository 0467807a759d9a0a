"""Motions of the pile that are found from their loads: the border of the equations of a step."""

import numpy as np
import pytest

from install_mpm import carriers
from install_mpm.assembly import as_matrix
from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.equilibrium import Prescribed, StepSystem
from install_mpm.ground import Ground
from install_mpm.linear_solvers import (
    SOLVERS,
    BorderedTangent,
    SingularMatrixError,
    solve_bordered,
)
from install_mpm.options import Box, Numerics, ScrewMeshOptions
from install_mpm.rig import loaded_motions, motion_to
from install_mpm.screw_installation import (
    START,
    PileLostError,
    accept,
    advance_pile,
    next_step,
    step_to,
)
from install_mpm.screw_path import Target
from install_mpm.screw_pile import Helix, ScrewPile
from install_mpm.screw_pile_mesh import generate_screw_mesh
from install_mpm.screw_programme import Phase, Pose, ScrewProgramme
from install_mpm.screw_setup import geostatic_state, set_up
from install_mpm.step import switch_on

STRENGTH = 10e3
PILE = ScrewPile(0.5, 1.2, (Helix(diameter=1.0, pitch=0.33, thickness=0.12, height=0.25),), 8e3)
BOX = Box(width=2.75, depth=3.0, headroom=0.5)
SIZES = ScrewMeshOptions(0.25, 0.45, 0.4, 1.2, 0.05, points_per_direction=1)


def problem_of(phases, **options):
    """The problem and its geostatic start."""
    modulus = 200 * STRENGTH
    ground = Ground(soil=VonMises(modulus, 0.49, STRENGTH), unit_weight=8e3, k0=1.0)
    law = CoulombInterface(50 * modulus, 5 * modulus, adhesion_factor=0.5)
    mesh = generate_screw_mesh(PILE, BOX, SIZES)
    programme = ScrewProgramme(phases, 0.03, **options)
    problem = set_up(ground, PILE, law, BOX, programme, Numerics(tolerance=1e-6), mesh)
    return problem, geostatic_state(problem, mesh, SIZES, "")


@pytest.fixture(scope="module")
def start():
    """The problem of one step of rotation, and the state after the step that moves nothing."""
    problem, state = problem_of((Phase("in", 0.03 / np.pi, 1.0),), release=False)
    return problem, accept(problem, state, step_to(problem, state, START), START)


# --- linear algebra -------------------------------------------------------------------------------


@pytest.mark.parametrize("solver", SOLVERS)
def test_bordered_system_has_the_solution_of_the_dense_one(solver, start, rng):
    pattern = start[0].model.pattern
    n = len(pattern.indptr) - 1
    values = rng.normal(size=len(pattern.indices)) * 1e-3
    matrix = as_matrix(pattern, values)
    matrix.setdiag(2.0)  # every row has its diagonal, so the pattern stays
    bordered = BorderedTangent(
        matrix.data, rng.normal(size=(n, 2)), rng.normal(size=(2, n)), rng.normal(size=(2, 2))
    )
    exact = rng.normal(size=n + 2)
    load = np.append(
        matrix @ exact[:n] + bordered.columns @ exact[n:],
        bordered.rows @ exact[:n] + bordered.corner @ exact[n:],
    )
    found = solve_bordered(SOLVERS[solver](pattern), bordered, load)
    np.testing.assert_allclose(found, exact, rtol=1e-8, atol=1e-8)


def test_a_pile_that_nothing_holds_is_a_singular_system():
    bordered = BorderedTangent(np.ones(3), np.zeros((3, 1)), np.zeros((1, 3)), np.zeros((1, 1)))
    with pytest.raises(SingularMatrixError):
        solve_bordered(lambda values, load: load, bordered, np.ones(4))


# --- derivatives ----------------------------------------------------------------------------------

LOADS = {
    "crowd force while turning": Target(0, 0.5, 0.03, Pose(0.0, -0.06), crowd_force=5e3),
    "torque while going down": Target(0, 0.5, 0.03, Pose(0.005, 0.0), torque=2e3),
    "both": Target(0, 0.5, 0.03, Pose(0.0, 0.0), crowd_force=5e3, torque=2e3),
}


def system_of(problem, state, target):
    given = carriers.give_state(
        state.material_points, state.background_mesh, problem.model, problem.gradient
    )
    return StepSystem(
        state.background_mesh, given.quadrature, given.fill,
        switch_on(state.interface, given.fill, problem.model), motion_to(state, target.pose),
        Prescribed(problem.supports, np.zeros_like(state.background_mesh.nodes)), problem.model,
        loaded_motions(problem, state, target),
    )  # fmt: skip


@pytest.mark.parametrize("name", LOADS)
def test_border_is_the_derivative_of_the_residual(name, start, rng):
    """Of all equations by all unknowns, with soil and interface that slip and stick."""
    problem, state = start
    system = system_of(problem, state, LOADS[name])
    is_free, n = system.is_free.ravel(), system.is_free.size
    n_motions = len(system.loaded.load)
    trial = np.append(np.where(is_free, 3e-4 * rng.normal(size=n), 0.0), [0.004, 0.02][-n_motions:])
    change = np.append(np.where(is_free, rng.normal(size=n), 0.0), rng.normal(size=n_motions))
    pattern = problem.model.pattern
    tangent = system.evaluate(trial).tangent
    shear = np.linalg.norm(system.traction[:, :2], axis=1)
    slips = shear > 0.999 * state.interface.parameters[:, 2]
    assert 0.05 < slips.mean() < 0.99
    soil = as_matrix(pattern, tangent.values) @ change[:n] + tangent.columns @ change[n:]
    pile = tangent.rows @ change[:n] + tangent.corner @ change[n:]
    size = 1e-8
    ends = [system.evaluate(trial + sign * size * change) for sign in (1, -1)]
    assert all(end.is_admissible for end in ends)
    derivative = (ends[0].residual - ends[1].residual) / (2.0 * size)
    for computed, expected in (
        (np.where(is_free, soil, 0.0), derivative[:n]), (pile, derivative[n:]),
    ):  # fmt: skip
        np.testing.assert_allclose(computed, expected, atol=2e-6 * np.abs(expected).max())


def test_a_column_alone_is_the_derivative_by_the_motion_of_the_pile(start, rng):
    problem, state = start
    system = system_of(problem, state, LOADS["both"])
    trial = np.append(np.zeros(system.is_free.size), [0.002, 0.01])
    tangent, size = system.evaluate(trial).tangent, 1e-8
    for k in range(2):
        unit = np.zeros(len(trial))
        unit[k - 2] = size
        ends = [system.evaluate(trial + sign * unit).residual for sign in (1, -1)]
        derivative = (ends[0] - ends[1]) / (2.0 * size)
        column = np.append(tangent.columns[:, k], tangent.corner[:, k])
        np.testing.assert_allclose(column, derivative, atol=1e-5 * np.abs(derivative).max())


# --- steps ----------------------------------------------------------------------------------------


def under(problem, **load):
    """The problem with one step of the same rotation under a load."""
    phase = Phase("in", 0.03 / np.pi, steps=1, **load)
    return problem._replace(programme=ScrewProgramme((phase,), 0.03, release=False))


def test_a_recorded_crowd_force_gives_the_advance_of_the_step_that_it_comes_from(start):
    problem, state = start
    whole = state.control._replace(step=np.array(0.04))  # the phase is one step in both runs
    state = state._replace(control=whole)
    target = next_step(problem, state)
    driven = accept(problem, state, step_to(problem, state, target), target)
    force = float(driven.history.crowd_force[-1])
    loaded = under(problem, crowd_force=force)
    target = next_step(loaded, state)
    assert target.crowd_force == force
    found = accept(loaded, state, step_to(loaded, state, target), target)
    history = found.history
    assert history.crowd_force[-1] == pytest.approx(force, rel=1e-4)
    assert history.penetration[-1] == pytest.approx(driven.history.penetration[-1], rel=1e-4)
    assert history.torque[-1] == pytest.approx(driven.history.torque[-1], rel=1e-4)
    assert history.rotation[-1] == driven.history.rotation[-1]
    assert history.convergence_order[-1] > 1.5


def test_a_force_that_the_ground_cannot_carry_is_refused_in_a_sentence(start):
    problem, state = start
    loaded = under(problem, crowd_force=500e3)
    loaded = loaded._replace(numerics=Numerics(tolerance=1e-6, max_cuts=0))
    with pytest.raises(PileLostError, match="cannot carry the crowd force of 500 kN") as caught:
        advance_pile(loaded, state, next_step(loaded, state))
    assert "\n" not in str(caught.value)


def test_a_loaded_pile_stays_where_the_model_reaches(start):
    problem, state = start
    shallow = under(problem, crowd_force=0.0)._replace(box=BOX.__class__(2.75, 2.2, 0.5))
    target = next_step(shallow, state)
    with pytest.raises(PileLostError, match="make the phase shorter"):
        accept(shallow, state, step_to(shallow, state, target), target)


def test_a_rest_leaves_the_pile_in_its_place(start):
    problem, state = start
    rest = Phase("rest", advance=0.0, steps=1)
    resting = problem._replace(programme=ScrewProgramme((rest,), 0.03, release=False))
    target = next_step(resting, state)
    result = step_to(resting, state, target)
    after = accept(resting, state, result, target)
    assert after.history.travel[-1] == 0.0
    assert next_step(resting, after) is None
    force = after.history.crowd_force
    assert force[-1] == pytest.approx(force[0], abs=1e-3 * 8e3)
