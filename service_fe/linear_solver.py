"""Direct solution of the tangent system with MUMPS; the analysis of the pattern is made once."""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

MAX_TRANSVERSAL = 6
"""MUMPS ICNTL(6): 0 leaves out the permutation that depends on values and outdates the analysis."""


class TangentSolver:
    """LU factors of a PETSc matrix whose values change and whose pattern does not.

    ``row_of_dof`` (n_dofs,) is the matrix row of each unknown; vectors given and returned are in
    the order of the unknowns.  The tangent is unsymmetric for a non-associated law, hence LU for
    all.
    """

    def __init__(self, matrix: PETSc.Mat, row_of_dof: np.ndarray) -> None:
        self.matrix = matrix
        self.row_of_dof = row_of_dof.astype(PETSc.IntType)
        self._right, self._left = matrix.createVecs()
        self._ksp = PETSc.KSP().create(matrix.getComm())
        self._ksp.setOperators(matrix)
        self._ksp.setType(PETSc.KSP.Type.PREONLY)
        preconditioner = self._ksp.getPC()
        preconditioner.setType(PETSc.PC.Type.LU)
        preconditioner.setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
        self._prepare_factors()

    def _prepare_factors(self) -> None:
        """Make the analysis independent of values; needed again after a reset."""
        preconditioner = self._ksp.getPC()
        preconditioner.setFactorSetUpSolverType()
        preconditioner.getFactorMatrix().setMumpsIcntl(MAX_TRANSVERSAL, 0)

    def add_blocks(self, dofs: np.ndarray, blocks: np.ndarray) -> None:
        """Add dense ``blocks`` (n, m, m) at the unknowns ``dofs`` (n, m)."""
        for rows, block in zip(self.row_of_dof[dofs], blocks, strict=True):
            self.matrix.setValues(rows, rows, block, addv=PETSc.InsertMode.ADD_VALUES)
        self.matrix.assemble()

    def multiply(self, vector: np.ndarray) -> np.ndarray:
        """Return the matrix times ``vector`` (n_dofs,)."""
        self._right.array_w[self.row_of_dof] = vector
        self.matrix.mult(self._right, self._left)
        return self._left.array_r[self.row_of_dof]

    def factorise(self, fixed_dofs: np.ndarray, diagonal: float) -> None:
        """Factorise with rows and columns of ``fixed_dofs`` zero but for ``diagonal``."""
        self.matrix.zeroRowsColumns(self.row_of_dof[fixed_dofs], diag=diagonal)
        self._ksp.setUp()

    def solve(self, right_hand_side: np.ndarray) -> np.ndarray:
        """Return the solution (n_dofs,) with the last factors.

        Raises
        ------
        FactorisationError
            If the matrix is singular to working precision.
        """
        self._left.array_w[self.row_of_dof] = right_hand_side
        self._ksp.solve(self._left, self._right)
        if self._ksp.getConvergedReason() < 0:
            self._ksp.getPC().reset()  # PETSc would leave out the factorisation after a failed one
            self._ksp.setOperators(self.matrix)
            self._prepare_factors()
            raise FactorisationError("the tangent stiffness is singular")
        return self._right.array_r[self.row_of_dof]


class FactorisationError(RuntimeError):
    """The tangent stiffness cannot be factorised; the step is then made shorter."""
