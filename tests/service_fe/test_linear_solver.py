import numpy as np
import pytest

from service_fe.linear_solver import FactorisationError, LUFactors, TangentMatrix
from service_fe.soil_forms import SoilForms

pytestmark = pytest.mark.dolfinx


@pytest.fixture
def soil(box_mesh):
    return SoilForms(box_mesh)


def dense(matrix, n):
    return np.column_stack([matrix.multiply(column) for column in np.eye(n)])


def unsymmetric_tangent(soil, seed):
    rng = np.random.default_rng(seed)
    tangent = 0.1 * rng.normal(size=(len(soil.integration_volumes), 6, 6))
    return tangent + 2.0 * np.eye(6)


def test_solution_with_blocks_and_fixed_unknowns_equals_the_dense_one(soil):
    """Also after a change of values: the analysis is reused, the factors are not."""
    rng = np.random.default_rng(5)
    matrix = TangentMatrix(soil.matrix, soil.row_of_dof)
    factors = LUFactors(matrix)
    cells = soil.mesh.cell_nodes[:2]
    dofs = (2 * cells[:, :, None] + np.arange(2)).reshape(2, 12)
    fixed = np.array([0, 1, 7, 20])
    free = np.setdiff1d(np.arange(soil.n_dofs), fixed)
    for seed in (1, 2):
        soil.stiffness(unsymmetric_tangent(soil, seed))
        without = dense(matrix, soil.n_dofs)
        blocks = 0.1 * rng.normal(size=(2, 12, 12))
        matrix.add_blocks(dofs, blocks)
        whole = dense(matrix, soil.n_dofs)
        expected = without.copy()
        for rows, block in zip(dofs, blocks, strict=True):
            expected[np.ix_(rows, rows)] += block
        np.testing.assert_allclose(whole, expected, atol=1e-13)

        right = rng.normal(size=soil.n_dofs)
        right[fixed] = 0.0
        matrix.fix(fixed, diagonal=3.0)
        factors.update()
        solution = factors.solve(right)
        np.testing.assert_allclose(
            solution[free], np.linalg.solve(whole[np.ix_(free, free)], right[free]), rtol=1e-8
        )
        np.testing.assert_array_equal(solution[fixed], 0.0)


def test_singular_matrix_is_reported_and_the_solver_survives_it(soil):
    matrix = TangentMatrix(soil.matrix, soil.row_of_dof)
    factors = LUFactors(matrix)
    stiffness = np.zeros((len(soil.integration_volumes), 6, 6))
    soil.stiffness(stiffness)
    matrix.fix(np.array([0]), diagonal=1.0)
    with pytest.raises(FactorisationError, match="singular"):
        factors.update()
    every_dof = np.arange(soil.n_dofs)
    soil.stiffness(stiffness)
    matrix.fix(every_dof, diagonal=2.0)
    factors.update()
    np.testing.assert_allclose(factors.solve(np.ones(soil.n_dofs)), 0.5)


def test_factors_stay_until_they_are_updated(soil):
    matrix = TangentMatrix(soil.matrix, soil.row_of_dof)
    factors = LUFactors(matrix)
    every_dof, ones = np.arange(soil.n_dofs), np.ones(soil.n_dofs)
    tangent = np.zeros((len(soil.integration_volumes), 6, 6))
    soil.stiffness(tangent)
    matrix.fix(every_dof, diagonal=2.0)
    factors.update()
    soil.stiffness(tangent)
    matrix.fix(every_dof, diagonal=4.0)
    np.testing.assert_allclose(factors.solve(ones), 0.5)
    factors.update()
    np.testing.assert_allclose(factors.solve(ones), 0.25)
