"""Approximate inverses of the soil's tangent: LU factors of MUMPS, or algebraic multigrid.

Both stay what they were when the matrix changes, until they are made anew.  Vectors given and
returned are whole on every rank, in the order of the unknowns; the matrix is distributed.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from petsc4py import PETSc

from service_fe.partition import gathered

MAX_TRANSVERSAL = 6
"""MUMPS ICNTL(6): 0 leaves out the permutation that depends on values and outdates the analysis."""
LOW_RANK, DROPPED = 35, 7
"""MUMPS ICNTL(35), 2: blocks far from the diagonal of a front are kept as products of low rank.
What CNTL(7) of their size is dropped.
"""


class FactorisationError(RuntimeError):
    """The tangent stiffness cannot be factorised; the step is then made shorter."""


class TangentMatrix:
    """A PETSc matrix whose values change and whose pattern does not.

    ``row_of_dof`` (n_dofs,) is the matrix row of each unknown.
    """

    def __init__(self, matrix: PETSc.Mat, row_of_dof: np.ndarray) -> None:
        self.matrix = matrix
        self.row_of_dof = row_of_dof.astype(PETSc.IntType)
        self._right, self._left = matrix.createVecs()
        first, end = matrix.getOwnershipRange()
        self._own_dofs = np.argsort(row_of_dof)[first:end]
        self._is_own = (row_of_dof >= first) & (row_of_dof < end)

    def add_blocks(self, dofs: np.ndarray, blocks: np.ndarray) -> None:
        """Add dense ``blocks`` (n, m, m), known to every rank, at the unknowns ``dofs`` (n, m)."""
        comm = self.matrix.getComm()
        own = slice(comm.getRank(), None, comm.getSize())
        for rows, block in zip(self.row_of_dof[dofs[own]], blocks[own], strict=True):
            self.matrix.setValues(rows, rows, block, addv=PETSc.InsertMode.ADD_VALUES)
        self.matrix.assemble()

    def mean_diagonal(self) -> float:
        """Return the mean of the diagonal, a neutral size for rows that are taken out."""
        diagonal = self.matrix.getDiagonal()
        return float(diagonal.sum() / diagonal.getSize())

    def fix(self, fixed_dofs: np.ndarray, diagonal: float) -> None:
        """Make rows and columns of ``fixed_dofs`` zero but for ``diagonal``."""
        own = fixed_dofs[self._is_own[fixed_dofs]]
        self.matrix.zeroRowsColumns(self.row_of_dof[own], diag=diagonal)

    def multiply(self, vector: np.ndarray) -> np.ndarray:
        """Return the matrix times ``vector`` (n_dofs,)."""
        self.matrix.mult(self.distributed(vector), self._left)
        return self.whole(self._left)

    def distributed(self, vector: np.ndarray) -> PETSc.Vec:
        """Return ``vector`` (n_dofs,) in the order of the rows; the next call overwrites it."""
        self._right.array_w[:] = vector[self._own_dofs]
        return self._right

    def whole(self, vector: PETSc.Vec) -> np.ndarray:
        """Return the values (n_dofs,) of a distributed vector in the order of the unknowns."""
        in_rows = gathered(self.matrix.getComm().tompi4py(), vector.array_r)
        return in_rows[self.row_of_dof]


class ApproximateInverse(Protocol):
    """Something that undoes the matrix of its last update, more or less."""

    def update(self) -> None:
        """Follow the present values of the matrix; ``FactorisationError`` if that is impossible."""

    def solve(self, right_hand_side: np.ndarray) -> np.ndarray:
        """Return the approximate solution (n_dofs,)."""


class LUFactors:
    """MUMPS; the analysis of the pattern is made once.

    The tangent is unsymmetric for a non-associated law, hence LU for all.  With ``dropped`` the
    factors are of low rank (Amestoy et al. 2015): cheaper, and exact only to about that share.
    """

    def __init__(self, matrix: TangentMatrix, dropped: float = 0.0) -> None:
        self._matrix, self._dropped = matrix, dropped
        self._solution = matrix.matrix.createVecRight()
        self._factors = PETSc.PC().create(matrix.matrix.getComm())
        self._factors.setOperators(matrix.matrix)
        self._factors.setType(PETSc.PC.Type.LU)
        self._factors.setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
        self._prepare()

    def _prepare(self) -> None:
        """Make the analysis independent of values; needed again after a reset."""
        self._factors.setFactorSetUpSolverType()
        mumps = self._factors.getFactorMatrix()
        mumps.setMumpsIcntl(MAX_TRANSVERSAL, 0)
        if self._dropped:
            mumps.setMumpsIcntl(LOW_RANK, 2)
            mumps.setMumpsCntl(DROPPED, self._dropped)

    def update(self) -> None:
        """Factorise.

        Raises
        ------
        FactorisationError
            If the matrix is singular to working precision.
        """
        self._factors.setReusePreconditioner(False)
        self._factors.setUp()
        self._factors.setReusePreconditioner(True)
        if self._factors.getFactorMatrix().getMumpsInfog(1) < 0:
            self._begin_again()  # PETSc would leave out the factorisation after a failed one
            raise FactorisationError("the tangent stiffness is singular")

    @property
    def are_exact(self) -> bool:
        """Whether the next factors will have full rank."""
        return self._dropped == 0.0

    def keep_full_rank(self) -> None:
        """Drop nothing from now on."""
        self._dropped = 0.0
        self._begin_again()

    def _begin_again(self) -> None:
        self._factors.reset()
        self._factors.setOperators(self._matrix.matrix)
        self._prepare()

    def solve(self, right_hand_side: np.ndarray) -> np.ndarray:
        """Return the solution (n_dofs,) with the last factors."""
        self._factors.apply(self._matrix.distributed(right_hand_side), self._solution)
        return self._matrix.whole(self._solution)


class Multigrid:
    """Smoothed aggregation, PETSc's GAMG; ``rigid_modes`` (n_dofs, n_modes) span what is soft."""

    def __init__(self, matrix: TangentMatrix, rigid_modes: np.ndarray) -> None:
        self._matrix = matrix
        self._solution = matrix.matrix.createVecRight()
        modes = []
        for mode in np.linalg.qr(rigid_modes)[0].T:
            modes.append(matrix.distributed(mode).copy())
        matrix.matrix.setNearNullSpace(PETSc.NullSpace().create(vectors=modes))
        self._cycle = PETSc.PC().create(matrix.matrix.getComm())
        self._cycle.setOperators(matrix.matrix)
        self._cycle.setType(PETSc.PC.Type.GAMG)

    def update(self) -> None:
        """Coarsen again."""
        self._cycle.setReusePreconditioner(False)
        self._cycle.setUp()
        self._cycle.setReusePreconditioner(True)

    def solve(self, right_hand_side: np.ndarray) -> np.ndarray:
        """Return what one cycle makes of ``right_hand_side``."""
        self._cycle.apply(self._matrix.distributed(right_hand_side), self._solution)
        return self._matrix.whole(self._solution)
