"""Soil and loaded motions together: every way to the solution gives the dense one."""

from types import SimpleNamespace

import numpy as np
import pytest

from service_fe.coupled_solver import CoupledSolver, CoupledSystem, Work, max_reuse
from service_fe.linear_solver import FactorisationError, Multigrid, TangentMatrix
from service_fe.options import Displace, Release, ServiceNumerics
from service_fe.soil_forms import SoilForms
from service_fe.solve import run

pytestmark = pytest.mark.dolfinx

N_LOADED = 2


@pytest.fixture
def soil(box_mesh):
    return SoilForms(box_mesh)


@pytest.fixture
def fixed(box_mesh):
    """Displacements of the nodes of the bottom."""
    nodes = np.flatnonzero(box_mesh.nodes[:, 1] < -1.5 + 1e-9)
    return (2 * nodes[:, None] + np.arange(2)).ravel()


class Broken:
    """A preconditioner of no use."""

    def update(self):
        pass

    def solve(self, right_hand_side):
        return np.zeros_like(right_hand_side)


def fill(soil, matrix, fixed, seed, change=0.2):
    """Fill the matrix with a tangent like that of elastic soil, changed here and there."""
    rng = np.random.default_rng(seed)
    tangent = np.tile(2.0 * np.eye(6), (len(soil.integration_volumes), 1, 1))
    tangent += change * rng.normal(size=tangent.shape)
    soil.stiffness(tangent)
    matrix.fix(fixed, diagonal=3.0)


def system_of(soil, fixed, seed):
    rng = np.random.default_rng(seed)
    soil_pile, pile_soil = rng.normal(size=(2, soil.n_dofs, N_LOADED))
    force = rng.normal(size=soil.n_dofs)
    soil_pile[fixed] = pile_soil[fixed] = 0.0
    force[fixed] = 0.0
    pile = 50.0 * np.eye(N_LOADED) + rng.normal(size=(N_LOADED, N_LOADED))
    return CoupledSystem(
        soil_pile, pile_soil.T, pile, force, rng.normal(size=N_LOADED), np.eye(3)[:, :N_LOADED]
    )


def error(matrix, system, found):
    """Residual of a solution, from the dense system."""
    dense = np.column_stack([matrix.multiply(c) for c in np.eye(len(system.soil_force))])
    soil, motion = found
    soil_residual = system.soil_force - dense @ soil - system.soil_pile @ motion
    pile_residual = system.pile_force - system.pile_soil @ soil - system.pile @ motion
    return np.linalg.norm(np.concatenate([soil_residual, pile_residual]))


@pytest.mark.parametrize("max_reuse", [0, 30])
def test_systems_that_change_are_solved_to_the_tolerance(soil, fixed, max_reuse):
    matrix = TangentMatrix(soil.matrix, soil.row_of_dof)
    solver = CoupledSolver(matrix, None, max_reuse)
    for seed in range(4):
        fill(soil, matrix, fixed, seed)
        system = system_of(soil, fixed, seed)
        assert error(matrix, system, solver.solve(system, 1e-7)) < 1.001e-7
    n_factorisations = solver.work.factorisations
    assert n_factorisations == 4 if max_reuse == 0 else n_factorisations < 4
    assert (solver.work.krylov_iterations == 0) == (max_reuse == 0)


def test_old_factors_serve_other_loaded_motions(soil, fixed):
    matrix = TangentMatrix(soil.matrix, soil.row_of_dof)
    solver = CoupledSolver(matrix, None, 30)
    fill(soil, matrix, fixed, 1)
    system = system_of(soil, fixed, 1)
    solver.solve(system, 1e-7)
    one = system._replace(
        soil_pile=system.soil_pile[:, 1:], pile_soil=system.pile_soil[1:],
        pile=system.pile[1:, 1:], pile_force=system.pile_force[1:], motions=system.motions[:, 1:],
    )  # fmt: skip
    assert error(matrix, one, solver.solve(one, 1e-7)) < 1.001e-7
    assert solver.work == Work(1, 1, 0)


def test_factors_are_made_again_when_they_have_become_dear(soil, fixed):
    """Changes so large that the old factors are far away: their number stays bounded."""
    matrix = TangentMatrix(soil.matrix, soil.row_of_dof)
    solver = CoupledSolver(matrix, None, 2)
    for seed in range(3):
        fill(soil, matrix, fixed, seed, change=0.5)
        system = system_of(soil, fixed, seed)
        assert error(matrix, system, solver.solve(system, 1e-9)) < 1e-9
    assert solver.work.factorisations == 3


def test_multigrid_solves_and_no_factors_are_made(soil, fixed):
    matrix = TangentMatrix(soil.matrix, soil.row_of_dof)
    solver = CoupledSolver(matrix, Multigrid(matrix, soil.rigid_modes()), 30)
    for seed in range(2):
        fill(soil, matrix, fixed, seed, change=0.1)
        system = system_of(soil, fixed, seed)
        assert error(matrix, system, solver.solve(system, 1e-7)) < 1.001e-7
    assert solver.work.factorisations == solver.work.fallbacks == 0
    assert solver.work.krylov_iterations > 0


def test_mumps_takes_over_from_multigrid_that_fails_and_is_counted(soil, fixed):
    matrix = TangentMatrix(soil.matrix, soil.row_of_dof)
    solver = CoupledSolver(matrix, Broken(), 30)
    fill(soil, matrix, fixed, 1)
    system = system_of(soil, fixed, 1)
    assert error(matrix, system, solver.solve(system, 1e-7)) < 1e-7
    assert (solver.work.factorisations, solver.work.fallbacks) == (1, 1)


def test_pile_without_soil_has_come_loose(soil, fixed):
    matrix = TangentMatrix(soil.matrix, soil.row_of_dof)
    solver = CoupledSolver(matrix, None, 30)
    fill(soil, matrix, fixed, 1)
    system = system_of(soil, fixed, 1)
    nothing = np.zeros((N_LOADED, soil.n_dofs))
    loose = system._replace(soil_pile=nothing.T, pile_soil=nothing, pile=np.zeros((2, 2)))
    with pytest.raises(FactorisationError, match="come loose"):
        solver.solve(loose, 1e-7)


@pytest.mark.parametrize(
    ("dim", "n_nodes", "given", "reuse"),
    [
        (3, 7000, None, 40),
        (3, 6000, None, 0),
        (2, 20_000, None, 0),
        (3, 7000, 0, 0),
        (2, 10, 15, 15),
    ],
)
def test_factors_are_used_again_where_that_pays_or_as_given(dim, n_nodes, given, reuse):
    nodes = np.zeros((n_nodes, dim))
    soil = SimpleNamespace(mesh=SimpleNamespace(nodes=nodes), n_dofs=nodes.size)
    assert max_reuse(soil, ServiceNumerics(max_factor_reuse=given)) == reuse


@pytest.mark.parametrize("solver", ["mumps", "iterative"])
def test_programmes_do_not_depend_on_the_solver(make_pile_problem, undisturbed, solver):
    """The same curves as with a factorisation in each iteration, in as many iterations."""
    programmes = (Release(steps=2), Displace("push", 0.02, 0.005, first_step_halvings=0))
    plain = run(make_pile_problem(ServiceNumerics(max_factor_reuse=0)), undisturbed, programmes)
    problem = make_pile_problem(ServiceNumerics(solver=solver, max_factor_reuse=40))
    other = run(problem, undisturbed, programmes)
    for before, after in list(zip(plain.programmes, other.programmes, strict=True))[1:]:
        scale = np.abs(before.curve.load).max()
        np.testing.assert_allclose(after.curve.load, before.curve.load, atol=1e-8 * scale)
        np.testing.assert_allclose(after.curve.iterations, before.curve.iterations, atol=1)
        assert before.curve.krylov_iterations.sum() == 0
        assert after.curve.krylov_iterations.sum() > 0
    before, after = (
        sum(entry.curve.factorisations.sum() for entry in result.programmes)
        for result in (plain, other)
    )
    assert after < 0.5 * before


def test_factors_of_low_rank_are_iterated_and_give_way_to_full_ones(soil, fixed):
    matrix = TangentMatrix(soil.matrix, soil.row_of_dof)
    solver = CoupledSolver(matrix, None, 30, dropped=1e-3)
    fill(soil, matrix, fixed, 1)
    system = system_of(soil, fixed, 1)
    assert error(matrix, system, solver.solve(system, 1e-9)) < 1.001e-9
    assert solver.work.krylov_iterations >= 1  # never taken for exact
    assert (solver.work.factorisations, solver.work.fallbacks) == (1, 0)

    impatient = CoupledSolver(matrix, None, 1, dropped=1e-3)
    found = impatient.solve(system, 0.0)  # no iteration reaches that
    assert error(matrix, system, found) < 1e-9 * np.linalg.norm(system.soil_force)
    assert (impatient.work.factorisations, impatient.work.fallbacks) == (2, 1)
