"""Flexible GMRES: a linear system to the accuracy that is asked for, with whatever preconditioner.

The residual that is made small is the true one, because the preconditioner stands on the right
(Saad 1993).  The basis is orthogonalised twice, so it stays orthogonal to round-off.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

Operator = Callable[[np.ndarray], np.ndarray]
Found = tuple[np.ndarray, float, float]


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
    basis, corrections = [right_hand_side / size], []
    hessenberg = np.zeros((max_iterations + 1, max_iterations))
    weights, is_reached = np.zeros(0), False
    for k in range(max_iterations):
        corrections.append(precondition(basis[k]))
        column, following = _orthogonalised(multiply(corrections[k]), np.array(basis))
        hessenberg[: k + 2, k] = column
        weights, residual = _least_squares(hessenberg[: k + 2, : k + 1], size)
        weights, residual, rest = agree((weights, residual, float(column[-1])))
        is_reached = residual <= tolerance
        if is_reached or rest == 0.0:
            break
        basis.append(following)
    return KrylovSolution(weights @ np.array(corrections), len(corrections), is_reached)


def _orthogonalised(vector: np.ndarray, basis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return components (k + 1,) on ``basis`` (k, n) and on the rest, and the unit rest (n,)."""
    components = np.zeros(len(basis))
    for _ in range(2):
        part = basis @ vector
        vector = vector - part @ basis
        components += part
    length = np.linalg.norm(vector)
    return np.append(components, length), vector / length if length > 0.0 else vector


def _least_squares(hessenberg: np.ndarray, size: float) -> tuple[np.ndarray, float]:
    """Return the weights (k,) that make |size e_1 - H y| least, and that residual."""
    right = np.zeros(len(hessenberg))
    right[0] = size
    weights: np.ndarray = np.linalg.lstsq(hessenberg, right, rcond=None)[0]
    return weights, float(np.linalg.norm(right - hessenberg @ weights))
