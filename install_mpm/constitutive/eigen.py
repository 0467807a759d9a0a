"""Eigenvalues and eigenvectors of a symmetric 3 x 3 tensor by cyclic Jacobi rotations.

Jacobi is used because it is accurate for repeated eigenvalues, which are the rule in geostatic
ground, and allocates nothing (Golub and Van Loan 2013, section 8.5).
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit

MAX_SWEEPS = 30


@jit
def symmetric_eigen(tensor, values, vectors):
    """Fill eigenvalues (3,) and eigenvectors, the columns of ``vectors`` (3, 3), of ``tensor``.

    ``tensor`` (3, 3) is overwritten.
    """
    for i in range(3):
        for j in range(3):
            vectors[i, j] = 1.0 if i == j else 0.0
    for _ in range(MAX_SWEEPS):
        if tensor[0, 1] == 0.0 and tensor[0, 2] == 0.0 and tensor[1, 2] == 0.0:
            break
        for i in range(2):
            for j in range(i + 1, 3):
                _rotate(tensor, vectors, i, j)
    for i in range(3):
        values[i] = tensor[i, i]


@jit
def _rotate(tensor, vectors, i, j):
    """Annihilate ``tensor[i, j]`` by a plane rotation; entries below round-off are set to zero."""
    off_diagonal = tensor[i, j]
    if abs(off_diagonal) <= 1e-17 * (abs(tensor[i, i]) + abs(tensor[j, j])):
        tensor[i, j] = 0.0
        tensor[j, i] = 0.0
        return
    theta = 0.5 * (tensor[j, j] - tensor[i, i]) / off_diagonal
    tangent = 1.0 / (abs(theta) + np.sqrt(theta * theta + 1.0))
    if theta < 0.0:
        tangent = -tangent
    cosine = 1.0 / np.sqrt(tangent * tangent + 1.0)
    sine = tangent * cosine
    for k in range(3):
        first, second = tensor[k, i], tensor[k, j]
        tensor[k, i] = cosine * first - sine * second
        tensor[k, j] = sine * first + cosine * second
    for k in range(3):
        first, second = tensor[i, k], tensor[j, k]
        tensor[i, k] = cosine * first - sine * second
        tensor[j, k] = sine * first + cosine * second
    for k in range(3):
        first, second = vectors[k, i], vectors[k, j]
        vectors[k, i] = cosine * first - sine * second
        vectors[k, j] = sine * first + cosine * second
    tensor[i, j] = 0.0
    tensor[j, i] = 0.0
