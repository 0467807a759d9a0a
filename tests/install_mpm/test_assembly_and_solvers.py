"""Assembly against dense addition, constraints, and the direct solvers."""

import numpy as np
import pytest
from scipy import sparse

from install_mpm import linear_solvers
from install_mpm.assembly import as_matrix, sparsity_pattern
from install_mpm.kernels.scatter import constrain, scatter_force, scatter_stiffness
from install_mpm.linear_solvers import SOLVERS, SingularMatrixError, coupled_system

N_NODES, DIM = 9, 2
N_DOFS = N_NODES * DIM
every_solver = pytest.mark.parametrize("solver", SOLVERS)


@pytest.fixture
def families():
    """Two families of elements; node 8 belongs to none."""
    return [np.array([[0, 1, 2], [2, 1, 3], [5, 4, 3]]), np.array([[3, 7], [6, 0]])]


@pytest.fixture
def pattern(families):
    return sparsity_pattern(families, N_NODES, DIM)


@pytest.fixture
def blocks(families, rng):
    return [
        rng.normal(size=(len(nodes), nodes.shape[1] * DIM, nodes.shape[1] * DIM))
        for nodes in families
    ]


def dofs_of(nodes):
    return [DIM * node + i for node in nodes for i in range(DIM)]


def assembled(pattern, blocks):
    values = np.zeros(len(pattern.indices))
    for family, slots in zip(blocks, pattern.slots, strict=True):
        scatter_stiffness(family, slots, values)
    return values


def test_stiffness_equals_dense_addition(families, blocks, pattern):
    expected = np.zeros((N_DOFS, N_DOFS))
    for nodes, family in zip(families, blocks, strict=True):
        for element, block in zip(nodes, family, strict=True):
            expected[np.ix_(dofs_of(element), dofs_of(element))] += block
    values = assembled(pattern, blocks)
    np.testing.assert_allclose(as_matrix(pattern, values).toarray(), expected, atol=1e-15)


def test_force_equals_dense_addition(families, pattern, rng):
    vector, expected = np.zeros(N_DOFS), np.zeros(N_DOFS)
    for nodes, dofs in zip(families, pattern.dofs, strict=True):
        blocks = rng.normal(size=dofs.shape)
        scatter_force(blocks, dofs, vector)
        for element, block in zip(nodes, blocks, strict=True):
            np.add.at(expected, dofs_of(element), block)
    np.testing.assert_allclose(vector, expected, atol=1e-15)


def test_pattern_is_sorted_without_duplicates_and_has_the_diagonal(pattern):
    for row in range(N_DOFS):
        columns = pattern.indices[pattern.indptr[row] : pattern.indptr[row + 1]]
        assert (np.diff(columns) > 0).all()
        assert row in columns
    assert pattern.indptr.dtype == pattern.indices.dtype == np.int32


def test_pattern_takes_a_family_without_elements(families, rng):
    pattern = sparsity_pattern([families[0], np.empty((0, 6), dtype=np.int64)], N_NODES, DIM)
    assert pattern.slots[1].shape == (0, 12, 12)
    assert len(pattern.indptr) == N_DOFS + 1


def test_constrained_dofs_become_identity_rows_and_columns(blocks, pattern, rng):
    values = assembled(pattern, blocks)
    expected = as_matrix(pattern, values.copy()).toarray()
    is_free = rng.uniform(size=N_DOFS) < 0.6
    expected[~is_free] = 0.0
    expected[:, ~is_free] = 0.0
    expected[~is_free, ~is_free] = 1.0
    constrain(pattern.indptr, pattern.indices, is_free, values)
    np.testing.assert_array_equal(as_matrix(pattern, values).toarray(), expected)


@pytest.fixture
def system(blocks, pattern, rng):
    """Values of an unsymmetric regular matrix, with dofs that are not free, and a load."""
    values = assembled(pattern, blocks)
    is_free = np.ones(N_DOFS, dtype=bool)
    is_free[[0, 5, 16, 17]] = False
    constrain(pattern.indptr, pattern.indices, is_free, values)
    return values, rng.normal(size=N_DOFS)


@every_solver
def test_solution_equals_that_of_the_dense_matrix(solver, system, pattern):
    values, load = system
    expected = np.linalg.solve(as_matrix(pattern, values).toarray(), load)
    result = SOLVERS[solver](pattern)(values, load)
    np.testing.assert_allclose(result, expected, rtol=1e-9, atol=1e-10)


@every_solver
def test_solver_is_used_again_with_other_values(solver, system, pattern, rng):
    """The second system gets its own answer, and the first answer is not overwritten by it."""
    values, load = system
    solve = SOLVERS[solver](pattern)
    first = solve(values, load)
    kept = first.copy()
    for _ in range(3):
        other, other_load = values * rng.uniform(0.5, 2.0, len(values)), rng.normal(size=N_DOFS)
        expected = np.linalg.solve(as_matrix(pattern, other).toarray(), other_load)
        np.testing.assert_allclose(solve(other, other_load), expected, rtol=1e-8, atol=1e-8)
    np.testing.assert_array_equal(first, kept)
    np.testing.assert_array_equal(solve(values, load), kept)


def without(dofs, pattern, blocks):
    """Values of a matrix in which ``dofs`` have rows and columns of the identity."""
    values = assembled(pattern, blocks)
    is_free = np.ones(N_DOFS, dtype=bool)
    is_free[dofs] = False
    constrain(pattern.indptr, pattern.indices, is_free, values)
    return values, ~is_free


@every_solver
def test_prescribed_dofs_are_left_out_and_may_change(solver, pattern, blocks, rng):
    """The answer is that of the dense matrix, and that of a new solver."""
    solve, load = SOLVERS[solver](pattern), rng.normal(size=N_DOFS)
    for held in ([0, 5], [0, 5, 9, 10], range(N_DOFS), [2]):
        values, is_prescribed = without([*held, 16, 17], pattern, blocks)
        result = solve(values, load, is_prescribed)
        expected = np.linalg.solve(as_matrix(pattern, values).toarray(), load)
        np.testing.assert_allclose(result, expected, rtol=1e-9, atol=1e-10)
        again = SOLVERS[solver](pattern)(values, load, is_prescribed)
        np.testing.assert_array_equal(result, again)


def test_cells_come_and_go_without_another_analysis(pattern, blocks, rng, monkeypatch):
    """Each answer is that of the dense matrix, and that of a new solver, as in a resumed run."""
    analysed = []
    analyse = linear_solvers._mumps_of_all
    monkeypatch.setattr(
        linear_solvers,
        "_mumps_of_all",
        lambda indptr, indices: analysed.append(len(indptr) - 1) or analyse(indptr, indices),
    )
    solve, load = SOLVERS["mumps"](pattern), rng.normal(size=N_DOFS)
    _, is_prescribed = without([0, 5], pattern, blocks)
    results = []
    systems = [
        without([0, 5, 16, 17, *empty], pattern, blocks)[0] for empty in ([], [8, 9], [2], [])
    ]
    for values in systems:
        results.append(solve(values, load, is_prescribed))
        expected = np.linalg.solve(as_matrix(pattern, values).toarray(), load)
        np.testing.assert_allclose(results[-1], expected, rtol=1e-9, atol=1e-10)
    assert analysed == [N_DOFS - 2]
    for values, result in zip(systems, results, strict=True):
        again = SOLVERS["mumps"](pattern)(values, load, is_prescribed)
        np.testing.assert_array_equal(again, result)


def test_coupled_system_is_the_matrix_of_its_dofs(pattern, blocks, rng):
    values, is_coupled = assembled(pattern, blocks), rng.uniform(size=N_DOFS) < 0.6
    part = coupled_system(pattern, is_coupled)
    n = len(part.dofs)
    small = sparse.csr_matrix((values[part.entries], part.indices, part.indptr), shape=(n, n))
    whole = as_matrix(pattern, values).toarray()
    np.testing.assert_array_equal(small.toarray(), whole[np.ix_(part.dofs, part.dofs)])


@every_solver
def test_solution_does_not_depend_on_what_was_solved_before(solver, rng):
    """A resumed run starts with another matrix than the run it continues, and must not differ."""
    n = 40
    pattern = sparsity_pattern([rng.integers(n, size=(60, 3))], n, 1)
    first, second = 10.0 ** rng.uniform(-6.0, 6.0, size=(2, len(pattern.indices)))
    load = rng.normal(size=n)
    solve = SOLVERS[solver](pattern)
    solve(first, load)
    np.testing.assert_array_equal(solve(second, load), SOLVERS[solver](pattern)(second, load))


@every_solver
def test_two_solvers_of_one_pattern_do_not_disturb_each_other(solver, system, pattern):
    values, load = system
    solvers = [SOLVERS[solver](pattern) for _ in range(2)]
    expected = solvers[0](values, load)
    solvers[1](2.0 * values, load)
    np.testing.assert_array_equal(solvers[0](values, load), expected)


@every_solver
def test_singular_matrix_is_an_error_and_the_solver_survives_it(solver, system, pattern):
    values, load = system
    solve = SOLVERS[solver](pattern)
    expected = solve(values, load)
    singular = values.copy()
    singular[pattern.indptr[2] : pattern.indptr[3]] = 0.0
    with pytest.raises(SingularMatrixError):
        solve(singular, load)
    np.testing.assert_allclose(solve(values, load), expected, rtol=1e-12)


@every_solver
def test_matrix_with_nan_is_an_error(solver, system, pattern):
    values, load = system
    values = values.copy()
    values[3] = np.nan
    with pytest.raises(SingularMatrixError):
        SOLVERS[solver](pattern)(values, load)


def test_loose_tolerance_uses_the_factors_of_the_matrix_before(system, pattern, rng):
    """The answer is as good as asked for, better than that of the old factors alone."""
    values, load = system
    other = values * rng.uniform(0.98, 1.02, len(values))
    matrix, solve = as_matrix(pattern, other), SOLVERS["mumps"](pattern)
    old = solve(values, load)
    result = solve(other, load, None, 1e-3)
    assert np.linalg.norm(matrix @ result - load) <= 1e-3 * np.linalg.norm(load)
    assert np.linalg.norm(matrix @ result - load) < np.linalg.norm(matrix @ old - load)
    exact = solve(other, load)
    assert not np.array_equal(result, exact)
    np.testing.assert_array_equal(exact, SOLVERS["mumps"](pattern)(other, load))


def test_matrix_far_from_the_one_before_is_factorised(system, pattern, rng, monkeypatch):
    """Where GMRES takes too many iterations, the answer is the exact one, for each column."""
    monkeypatch.setattr(linear_solvers, "INNER_ITERATIONS", 1)
    values, load = system
    other, loads = values * rng.uniform(0.1, 10.0, len(values)), np.stack([load, -load], axis=1)
    solve = SOLVERS["mumps"](pattern)
    solve(values, load)
    expected = SOLVERS["mumps"](pattern)(other, loads)
    np.testing.assert_array_equal(solve(other, loads, None, 1e-6), expected)
