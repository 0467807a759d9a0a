"""Flexible GMRES: a linear system to the accuracy that is asked for, with whatever preconditioner.

The residual that is made small is the true one, because the preconditioner stands on the right
(Saad 1993).  The basis stays orthogonal to round-off: a vector of which the basis takes most is
orthogonalised twice (Daniel et al. 1976).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

Operator = Callable[[np.ndarray], np.ndarray]
Found = tuple[np.ndarray, float, float]

MOST = 0.7
"""A vector that keeps less of its length is orthogonalised again; cancellation costs no digit."""


class KrylovSolution(NamedTuple):
    """What the iteration has come to."""

    solution: np.ndarray
    """The one with the least residual in the space (n,)."""
    iterations: int
    """Applications of the preconditioner."""
    is_reached: bool
    """Whether the residual keeps the tolerance."""


def solve_gmres(
    multiply: Operator,
    precondition: Operator,
    right_hand_side: np.ndarray,
    tolerance: float,
    max_iterations: int,
    agree: Callable[[Found], Found] = lambda found: found,
) -> KrylovSolution:
    """Return the solution of A x = b, begun from zero, without restart.

    Parameters
    ----------
    multiply
        A times a vector (n,).
    precondition
        Approximate inverse of A times a vector (n,).
    right_hand_side
        b (n,).
    tolerance
        Norm of b - A x to reach, in the unit of b.
    max_iterations
        Most applications of the preconditioner; two vectors are kept for each.
    agree
        Makes what an iteration finds (weights, residual, rest) the same on all ranks of MPI.
    """
    size = float(np.linalg.norm(right_hand_side))
    if size <= tolerance:
        return KrylovSolution(np.zeros_like(right_hand_side), 0, True)
    basis = np.empty((max_iterations + 1, len(right_hand_side)))
    corrections = np.empty((max_iterations, len(right_hand_side)))
    hessenberg = np.zeros((max_iterations + 1, max_iterations))
    basis[0] = right_hand_side / size
    weights, is_reached = np.zeros(0), False
    for k in range(max_iterations):
        corrections[k] = precondition(basis[k])
        column, basis[k + 1] = _orthogonalised(multiply(corrections[k]), basis[: k + 1])
        hessenberg[: k + 2, k] = column
        weights, residual = _least_squares(hessenberg[: k + 2, : k + 1], size)
        weights, residual, rest = agree((weights, residual, float(column[-1])))
        is_reached = residual <= tolerance
        if is_reached or rest == 0.0:
            break
    return KrylovSolution(weights @ corrections[: len(weights)], len(weights), is_reached)


def _orthogonalised(vector: np.ndarray, basis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return components (k + 1,) on ``basis`` (k, n) and on the rest, and the unit rest (n,)."""
    before = np.linalg.norm(vector)
    components = basis @ vector
    vector = vector - components @ basis
    length = np.linalg.norm(vector)
    if length < MOST * before:
        again = basis @ vector
        vector = vector - again @ basis
        components += again
        length = np.linalg.norm(vector)
    return np.append(components, length), vector / length if length > 0.0 else vector


def _least_squares(hessenberg: np.ndarray, size: float) -> tuple[np.ndarray, float]:
    """Return the weights (k,) that make |size e_1 - H y| least, and that residual."""
    right = np.zeros(len(hessenberg))
    right[0] = size
    weights: np.ndarray = np.linalg.lstsq(hessenberg, right, rcond=None)[0]
    return weights, float(np.linalg.norm(right - hessenberg @ weights))
