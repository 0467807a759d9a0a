"""The linear system of one Newton iteration: soil and loaded motions of the pile together.

    [ K_ss  K_sl ] [ du  ]   [ b_s ]
    [ K_ls  K_ll ] [ dq_l ] = [ b_l ] ,

It is solved by GMRES to the accuracy that Newton's method can use.  The preconditioner is the
inverse of the same system with factors of K_ss made some iterations ago, whose Schur complement

    S = K_ll - K_ls K_ss^-1 K_sl

is kept with them.  So one back-substitution is made for each iteration of GMRES, however many
motions are loaded.  The factors are made again when GMRES needs so many iterations that this is
cheaper.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from service_fe.kinematics import Forms
from service_fe.krylov import KrylovSolution, solve_gmres
from service_fe.linear_solver import (
    ApproximateInverse,
    FactorisationError,
    LUFactors,
    Multigrid,
    TangentMatrix,
)
from service_fe.options import ServiceNumerics
from service_fe.partition import ALONE, Partition

FACTORISATION_COST = 24
"""Iterations of GMRES that a factorisation counts as, on meshes of up to ``COST_UNKNOWNS``.

It was measured in space with 13,000 unknowns, and is taken to grow with the root of their number:
with 96,000 that is 61, while a factorisation of low rank takes as long as 44, but to count it as
that made a programme slower (docs/performance.md).
"""
COST_UNKNOWNS = 15_000
USUAL_REUSE = 40
"""Most iterations of GMRES with old factors on large meshes."""
MANY_UNKNOWNS = 20_000
"""Unknowns in space from which factors are used again by default."""
USUALLY_DROPPED = 1e-3
"""Of factors that are used again on such meshes: they precondition, and need not be exact."""
MAX_MULTIGRID = 150
"""Iterations of GMRES with multigrid after which it has failed."""


class CoupledSystem(NamedTuple):
    """Blocks that couple the soil with the loaded motions, and the right-hand side.

    Those of the soil are zero at fixed displacements; K_ss is in the matrix.  Equations of motions
    are scaled so that all right-hand sides are forces.
    """

    soil_pile: np.ndarray
    """K_sl (n_dofs, n_loaded)."""
    pile_soil: np.ndarray
    """K_ls (n_loaded, n_dofs)."""
    pile: np.ndarray
    """K_ll (n_loaded, n_loaded)."""
    soil_force: np.ndarray
    """b_s (n_dofs,)."""
    pile_force: np.ndarray
    """b_l (n_loaded,)."""
    motions: np.ndarray
    """The loaded motions (n_motions, n_loaded), by which two systems are told apart."""


class Work(NamedTuple):
    """What has been done to solve linear systems."""

    factorisations: int = 0
    krylov_iterations: int = 0
    fallbacks: int = 0
    """Times multigrid failed and factors took over, or those of low rank and others did."""

    def since(self, before: Work) -> Work:
        """Return the work done after ``before``."""
        return Work(*(now - then for now, then in zip(self, before, strict=True)))


class _Border(NamedTuple):
    """What the preconditioner keeps of the pile."""

    motions: np.ndarray
    pile_soil: np.ndarray
    per_motion: np.ndarray
    """K_ss^-1 K_sl (n_dofs, n_loaded)."""
    schur: np.ndarray


class CoupledSolver:
    """Solves ``CoupledSystem``s one after the other and remembers what can be used again.

    Parameters
    ----------
    matrix
        K_ss, filled and with its supports fixed before each solution.
    multigrid
        Tried before MUMPS, if given.
    max_reuse
        Most iterations of GMRES with factors of an earlier system; with zero they are never used
        again.
    partition
        The ranks of MPI that solve the system together.
    dropped
        Share of the factors that is dropped, see ``LUFactors``.
    """

    def __init__(
        self,
        matrix: TangentMatrix,
        multigrid: ApproximateInverse | None,
        max_reuse: int,
        partition: Partition = ALONE,
        dropped: float = 0.0,
    ) -> None:
        self.matrix, self.work, self._partition = matrix, Work(), partition
        self._multigrid, self._factors = multigrid, LUFactors(matrix, dropped)
        self._max_reuse = max_reuse
        growth = np.sqrt(len(matrix.row_of_dof) / COST_UNKNOWNS)
        self._factorisation_cost = FACTORISATION_COST * max(1.0, growth)
        self._border: _Border | None = None
        self._iterations_since: list[int] = []
        """Iterations of GMRES in each solution with the present factors."""

    def solve(self, system: CoupledSystem, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
        """Return soil displacement (n_dofs,) and motions (n_loaded,), residual ``tolerance`` in N.

        Raises
        ------
        FactorisationError
            If the stiffness of the soil or of the pile in it is singular.
        """
        system, tolerance = self._partition.agreed((system, tolerance))
        found = None
        if self._is_worth_using():
            found = self._with_old_factors(system, tolerance)
        if found is None and self._multigrid is not None:
            found = self._with_multigrid(self._multigrid, system, tolerance)
        if found is None:
            found = self._with_new_factors(system, tolerance)
        if found is None:
            self._count(fallbacks=1)
            self._factors.keep_full_rank()
            found = self._with_new_factors(system, tolerance)
        assert found is not None
        found = self._partition.agreed(found)
        return found[: len(system.soil_force)], found[len(system.soil_force) :]

    def forget(self) -> None:
        """Use nothing of what was solved before, so that a result does not depend on it."""
        self._iterations_since = []

    def _is_worth_using(self) -> bool:
        """Return whether a further solution costs less than the mean since the factorisation."""
        since = self._iterations_since
        if not since or self._max_reuse == 0:
            return False
        return since[-1] * len(since) < self._factorisation_cost + sum(since)

    def _with_old_factors(self, system: CoupledSystem, tolerance: float) -> np.ndarray | None:
        border = self._border
        if border is None or not np.array_equal(border.motions, system.motions):
            self._border = border = _border_of(system, self._factors)
        found = self._iterated(self._factors, border, system, tolerance, self._max_reuse)
        self._iterations_since.append(found.iterations)
        return found.solution if found.is_reached else None

    def _with_multigrid(
        self, multigrid: ApproximateInverse, system: CoupledSystem, tolerance: float
    ) -> np.ndarray | None:
        self.forget()
        multigrid.update()
        border = _border_of(system, multigrid)
        found = self._iterated(multigrid, border, system, tolerance, MAX_MULTIGRID)
        if found.is_reached:
            return found.solution
        self._count(fallbacks=1)
        return None

    def _with_new_factors(self, system: CoupledSystem, tolerance: float) -> np.ndarray | None:
        """Return the solution, or None if factors of low rank are not good enough for it."""
        self.forget()
        self._count(factorisations=1)
        self._factors.update()
        self._border = _border_of(system, self._factors)
        if self._factors.are_exact:
            right = np.concatenate([system.soil_force, system.pile_force])
            self._iterations_since = [1]
            return _preconditioned(self._factors, self._border, right)
        found = self._iterated(self._factors, self._border, system, tolerance, self._max_reuse)
        self._iterations_since = [found.iterations]
        return found.solution if found.is_reached else None

    def _count(self, **more: int) -> None:
        """Add to the work that has been done."""
        self.work = self.work._replace(
            **{name: getattr(self.work, name) + number for name, number in more.items()}
        )

    def _iterated(
        self,
        inverse: ApproximateInverse,
        border: _Border,
        system: CoupledSystem,
        tolerance: float,
        max_iterations: int,
    ) -> KrylovSolution:
        n_soil = len(system.soil_force)

        def multiply(vector: np.ndarray) -> np.ndarray:
            soil, motion = vector[:n_soil], vector[n_soil:]
            return np.concatenate(
                [
                    self.matrix.multiply(soil) + system.soil_pile @ motion,
                    system.pile_soil @ soil + system.pile @ motion,
                ]
            )

        found = solve_gmres(
            multiply,
            lambda vector: _preconditioned(inverse, border, vector),
            np.concatenate([system.soil_force, system.pile_force]),
            tolerance,
            max_iterations,
            self._partition.agreed,
        )
        self._count(krylov_iterations=found.iterations)
        return found


def make_solver(soil: Forms, numerics: ServiceNumerics) -> CoupledSolver:
    """Return the solver of a model of the ``soil`` that the ``numerics`` ask for."""
    matrix = TangentMatrix(soil.matrix, soil.row_of_dof)
    is_iterative = numerics.solver == "iterative"
    multigrid = Multigrid(matrix, soil.rigid_modes()) if is_iterative else None
    reuse = max_reuse(soil, numerics)
    dropped = USUALLY_DROPPED if reuse and _is_large(soil) else 0.0
    return CoupledSolver(matrix, multigrid, reuse, soil.partition, dropped)


def max_reuse(soil: Forms, numerics: ServiceNumerics) -> int:
    """Return the most iterations of GMRES with old factors: as given, or what pays on the mesh."""
    if numerics.max_factor_reuse is not None:
        return numerics.max_factor_reuse
    return USUAL_REUSE if _is_large(soil) else 0


def _is_large(soil: Forms) -> bool:
    return soil.mesh.nodes.shape[1] == 3 and soil.n_dofs >= MANY_UNKNOWNS


def _border_of(system: CoupledSystem, inverse: ApproximateInverse) -> _Border:
    per_motion = np.zeros_like(system.soil_pile)
    for motion, column in enumerate(system.soil_pile.T):
        per_motion[:, motion] = inverse.solve(column)
    schur = system.pile - system.pile_soil @ per_motion
    return _Border(system.motions, system.pile_soil, per_motion, schur)


def _preconditioned(inverse: ApproximateInverse, border: _Border, vector: np.ndarray) -> np.ndarray:
    """Return the solution (n_dofs + n_loaded,) of the system that ``inverse`` and border know."""
    n_loaded = len(border.schur)
    soil = inverse.solve(vector[: len(vector) - n_loaded])
    if n_loaded == 0:
        return soil
    force = vector[len(vector) - n_loaded :] - border.pile_soil @ soil
    try:
        motion = np.linalg.solve(border.schur, force)
    except np.linalg.LinAlgError as error:
        raise FactorisationError("the pile has come loose from the soil") from error
    return np.concatenate([soil - border.per_motion @ motion, motion])
