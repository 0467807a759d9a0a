"""Eigenvalues and eigenvectors of a symmetric 3 x 3 tensor by cyclic Jacobi rotations.

Jacobi is used because it is accurate for repeated eigenvalues, which are the rule in geostatic
ground, and allocates nothing (Golub and Van Loan 2013, section 8.5).  Components and directions are
scalars and tuples, so that they stay in the registers of the processor.
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit

MAX_SWEEPS = 30

NEGLIGIBLE, SMALLEST = 1e-17, 1e-150
"""Off-diagonal components that count as zero: relative to the diagonal, and of any tensor."""

SMALL_ANGLE = 1e-8
"""Tangent of a rotation whose square is below round-off."""


@jit
def symmetric_eigen(tensor, values, vectors):
    """Fill eigenvalues (3,) and eigenvectors, the columns of ``vectors`` (3, 3), of ``tensor``."""
    xx, yy, zz, x, y, z = eigen_pairs(
        tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[0, 2], tensor[1, 2]
    )
    values[0], values[1], values[2] = xx, yy, zz
    for i in range(3):
        vectors[i, 0], vectors[i, 1], vectors[i, 2] = x[i], y[i], z[i]


@jit
def eigen_pairs(xx, yy, zz, xy, xz, yz):
    """Return three eigenvalues and then their directions, tuples (3,), of the six components."""
    x, y, z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    for _ in range(MAX_SWEEPS):
        if xy == 0.0 and xz == 0.0 and yz == 0.0:
            break
        xx, yy, xz, yz, x, y = _annihilate(xy, xx, yy, xz, yz, x, y)
        xy = 0.0
        xx, zz, xy, yz, x, z = _annihilate(xz, xx, zz, xy, yz, x, z)
        xz = 0.0
        yy, zz, xy, xz, y, z = _annihilate(yz, yy, zz, xy, xz, y, z)
        yz = 0.0
    return xx, yy, zz, x, y, z


@jit
def _annihilate(off_diagonal, first, second, first_third, second_third, x, y):
    """Turn two axes so that their ``off_diagonal`` component vanishes.

    Takes and returns their diagonal components, those with the third axis, and their directions.
    """
    if abs(off_diagonal) <= NEGLIGIBLE * (abs(first) + abs(second)) + SMALLEST:
        return first, second, first_third, second_third, x, y
    half = 0.5 * (second - first)
    if abs(off_diagonal) <= SMALL_ANGLE * abs(half):
        tangent, cosine = 0.5 * off_diagonal / half, 1.0
    else:
        radius = np.sqrt(half * half + off_diagonal * off_diagonal)
        tangent = off_diagonal / (half + radius if half >= 0.0 else half - radius)
        cosine = np.sqrt(0.5 + 0.5 * abs(half) / radius)
    sine = tangent * cosine
    return (
        first - tangent * off_diagonal,
        second + tangent * off_diagonal,
        cosine * first_third - sine * second_third,
        sine * first_third + cosine * second_third,
        _combined(cosine, x, -sine, y),
        _combined(sine, x, cosine, y),
    )


@jit
def _combined(first, x, second, y):
    """Return ``first`` x + ``second`` y of two directions (3,)."""
    return (
        first * x[0] + second * y[0],
        first * x[1] + second * y[1],
        first * x[2] + second * y[2],
    )
