"""Linear solvers as values: each function returns ``solve(values, right_hand_side) -> solution``.

The right-hand side is (n_dofs,), or (n_dofs, n) for n of them with one factorisation.  The sparsity
pattern is given once, so that analysis need not be repeated.  The tangent is not symmetric in
general (mean dilatation, non-associated flow, friction), so only LU methods are offered here.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple, Protocol

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from install_mpm.assembly import SparsityPattern, as_matrix


class Solve(Protocol):
    """Takes the values of a matrix and a right-hand side."""

    def __call__(
        self,
        values: np.ndarray,
        right_hand_side: np.ndarray,
        is_prescribed: np.ndarray | None = None,
        inner_tolerance: float = 0.0,
    ) -> np.ndarray:
        """Return the solution.

        ``is_prescribed`` (n_dofs,) tells dofs whose rows and columns are those of the identity.  If
        the matrix is near that of the last call, a relative residual of ``inner_tolerance`` can be
        enough, for which the factors of then may do.
        """
        ...


LinearSolve = Callable[[Any, np.ndarray], np.ndarray]
"""Takes a tangent, bordered or not, and a right-hand side."""


INNER_ITERATIONS = 12
"""Of GMRES with the factors of an earlier matrix; new factors are cheaper than more of them."""


class SingularMatrixError(ArithmeticError):
    """The tangent could not be factorised; the step is made shorter."""


class CoupledSystem(NamedTuple):
    """The part of a matrix whose dofs have to be solved for together."""

    dofs: np.ndarray
    """Its rows and columns in the whole matrix, (n_coupled,)."""
    entries: np.ndarray
    """Where its values are among those of the whole, (n_coupled_entries,)."""
    indptr: np.ndarray
    """Its row starts, (n_coupled + 1,) int32."""
    indices: np.ndarray
    """Its columns, (n_coupled_entries,) int32."""


def coupled_system(pattern: SparsityPattern, is_coupled: np.ndarray) -> CoupledSystem:
    """Return the part of the pattern that belongs to the dofs ``is_coupled`` (n_dofs,)."""
    number = np.cumsum(is_coupled) - 1
    row = np.repeat(np.arange(len(is_coupled)), np.diff(pattern.indptr))
    entries = np.flatnonzero(is_coupled[row] & is_coupled[pattern.indices])
    dofs = np.flatnonzero(is_coupled)
    indptr = np.searchsorted(number[row[entries]], np.arange(len(dofs) + 1)).astype(np.int32)
    return CoupledSystem(dofs, entries, indptr, number[pattern.indices[entries]].astype(np.int32))


def mumps(pattern: SparsityPattern) -> Solve:
    """Return a MUMPS LU solver (through PETSc) of the dofs that are not prescribed.

    The others are analysed once, as they stay the same in a run, and so is the order in which they
    are eliminated.  Dofs without soil are among them: they come and go at the ground surface in
    most steps, and what they add to a factorisation is little beside another analysis.  With an
    ``inner_tolerance`` GMRES starts from the factors of an earlier call, and the matrix is
    factorised only if that takes more than ``INNER_ITERATIONS``; without, a solution depends on its
    own values alone.

    Raises
    ------
    SingularMatrixError
        From the returned function, if a factorisation fails.
    """
    last: tuple[np.ndarray, CoupledSystem, _SolveCoupled, Callable[[], None]] | None = None

    def solve(
        values: np.ndarray,
        right_hand_side: np.ndarray,
        is_prescribed: np.ndarray | None = None,
        inner_tolerance: float = 0.0,
    ) -> np.ndarray:
        nonlocal last
        is_coupled = np.ones(len(right_hand_side), dtype=bool)
        if is_prescribed is not None:
            is_coupled = ~is_prescribed
        if last is None or not np.array_equal(is_coupled, last[0]):
            if last is not None:
                last[-1]()
            system = coupled_system(pattern, is_coupled)
            last = is_coupled, system, *_mumps_of_all(system.indptr, system.indices)
        _, system, solve_coupled, _ = last
        result = np.array(right_hand_side)  # of rows of the identity
        if len(system.dofs):
            result[system.dofs] = solve_coupled(
                values[system.entries], right_hand_side[system.dofs], inner_tolerance
            )
        return result

    return solve


_SolveCoupled = Callable[[np.ndarray, np.ndarray, float], np.ndarray]
"""Takes values, right-hand side and inner tolerance."""


def _mumps_of_all(
    indptr: np.ndarray, indices: np.ndarray
) -> tuple[_SolveCoupled, Callable[[], None]]:
    """Return a MUMPS solver of a matrix in compressed rows, which analyses it once.

    The second function gives its memory back: PETSc keeps what Python has forgotten.
    """
    from petsc4py import PETSc

    n_dofs = len(indptr) - 1
    values_in_place = np.zeros(len(indices))
    matrix = PETSc.Mat().createAIJ(
        size=(n_dofs, n_dofs), csr=(indptr, indices, values_in_place), comm=PETSc.COMM_SELF
    )
    solver = _krylov_solver(matrix, "preonly")
    factorisation = solver.getPC()
    iterative = _krylov_solver(matrix, "gmres")
    iterative.setPC(factorisation)
    iterative.setPCSide(PETSc.PC.Side.RIGHT)  # its residual is that of the equations
    factorisation.setType("lu")
    factorisation.setFactorSolverType("mumps")
    prepare = partial(_prepare_mumps, factorisation)
    prepare()
    solution, load = matrix.createVecs()

    def solve(
        values: np.ndarray, right_hand_side: np.ndarray, inner_tolerance: float
    ) -> np.ndarray:
        matrix.setValuesCSR(indptr, indices, values)
        matrix.assemble()
        if inner_tolerance:
            factorisation.setReusePreconditioner(True)
            iterative.setTolerances(rtol=inner_tolerance, max_it=INNER_ITERATIONS)
            result = _solve_columns(iterative, load, solution, right_hand_side)
            factorisation.setReusePreconditioner(False)
            if result is not None:
                return result
        solver.setOperators(matrix)
        result = _solve_columns(solver, load, solution, right_hand_side)
        if result is None:
            factorisation.reset()  # PETSc would leave out the factorisation after one that failed
            solver.setOperators(matrix)
            prepare()
            raise SingularMatrixError("MUMPS could not factorise the tangent")
        return result

    def release() -> None:
        for held in (iterative, solver, factorisation, matrix, solution, load):
            held.destroy()

    return solve, release


def _krylov_solver(matrix: Any, method: str) -> Any:
    """Return PETSc's ``method`` for the matrix."""
    from petsc4py import PETSc

    solver = PETSc.KSP().create(PETSc.COMM_SELF)
    solver.setType(method)
    solver.setOperators(matrix)
    return solver


def _solve_columns(
    solver: Any, load: Any, solution: Any, right_hand_side: np.ndarray
) -> np.ndarray | None:
    """Return the solutions of all columns, None if one fails; PETSc factorises at the first."""
    columns = []
    for column in right_hand_side.reshape(len(right_hand_side), -1).T:
        load.setArray(column)
        solver.solve(load, solution)
        columns.append(np.array(solution.getArray()))
        if solver.getConvergedReason() < 0 or not np.isfinite(columns[-1]).all():
            return None
    return np.stack(columns, axis=1).reshape(right_hand_side.shape)


def _prepare_mumps(factorisation: Any) -> None:
    """Make the analysis of a PETSc LU preconditioner independent of values.

    ICNTL(6) = 0 leaves out the permutation that depends on them; a resumed run, which analyses at
    another step, would round differently.
    """
    factorisation.setFactorSetUpSolverType()
    factorisation.getFactorMatrix().setMumpsIcntl(6, 0)


def superlu(pattern: SparsityPattern) -> Solve:
    """Return scipy's SuperLU solver, for machines without PETSc; slow in three dimensions.

    Rows of the identity cost it nothing, so it leaves none out; and it factorises in every call.

    Raises
    ------
    SingularMatrixError
        From the returned function, if the matrix is exactly singular.
    """

    def solve(
        values: np.ndarray,
        right_hand_side: np.ndarray,
        is_prescribed: np.ndarray | None = None,
        inner_tolerance: float = 0.0,
    ) -> np.ndarray:
        try:
            factors = splu(sparse.csc_matrix(as_matrix(pattern, values)))
        except RuntimeError as error:
            raise SingularMatrixError(f"SuperLU: {error}") from error
        return np.asarray(factors.solve(right_hand_side))

    return solve


SOLVERS: dict[str, Callable[[SparsityPattern], Solve]] = {"mumps": mumps, "superlu": superlu}
"""Names that a case file can give."""


class BorderedTangent(NamedTuple):
    """The tangent [[K, C], [R, D]] of the dofs of the pattern and of a few more beside them."""

    values: np.ndarray
    """Of K, in the order of the sparsity pattern."""
    columns: np.ndarray
    """C, (n_dofs, m)."""
    rows: np.ndarray
    """R, (m, n_dofs)."""
    corner: np.ndarray
    """D, (m, m)."""


def solve_bordered(
    solve: LinearSolve, tangent: BorderedTangent, right_hand_side: np.ndarray
) -> np.ndarray:
    """Return the solution (n_dofs + m,) of a bordered system: one factorisation, 1 + m solutions.

    Block elimination: with K z = b and K Z = C, (D - R Z) s = e - R z and u = z - Z s.

    Raises
    ------
    SingularMatrixError
        If K or the Schur complement D - R Z is singular.
    """
    n_dofs = len(tangent.columns)
    load, rest = right_hand_side[:n_dofs], right_hand_side[n_dofs:]
    solved = solve(tangent.values, np.column_stack([load, tangent.columns]))
    alone, by_border = solved[:, 0], solved[:, 1:]
    complement = tangent.corner - tangent.rows @ by_border
    try:
        border = np.linalg.solve(complement, rest - tangent.rows @ alone)
    except np.linalg.LinAlgError as error:
        raise SingularMatrixError(f"Schur complement: {error}") from error
    return np.concatenate([alone - by_border @ border, border])
