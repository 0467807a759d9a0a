"""Symmetric 3 x 3 tensors as Mandel six-vectors: the only place that knows their order and scaling.

Order xx, yy, zz, xy, xz, yz with shear components times sqrt(2), so that the dot product of two
six-vectors is the double contraction of the tensors.
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit

SQRT2 = np.sqrt(2.0)
ROW = np.array([0, 1, 2, 0, 0, 1])
COLUMN = np.array([0, 1, 2, 1, 2, 2])
SCALE = np.array([1.0, 1.0, 1.0, SQRT2, SQRT2, SQRT2])


@jit
def to_mandel(tensor, vector):
    """Fill ``vector`` (6,) from the symmetric ``tensor`` (3, 3)."""
    for component in range(6):
        vector[component] = SCALE[component] * tensor[ROW[component], COLUMN[component]]


@jit
def from_mandel(vector, tensor):
    """Fill the symmetric ``tensor`` (3, 3) from ``vector`` (6,)."""
    for component in range(6):
        value = vector[component] / SCALE[component]
        tensor[ROW[component], COLUMN[component]] = value
        tensor[COLUMN[component], ROW[component]] = value


@jit
def trace(vector):
    """Return the trace of a tensor given as six-vector."""
    return vector[0] + vector[1] + vector[2]


@jit
def norm(vector):
    """Return the Frobenius norm of a tensor given as six-vector."""
    total = 0.0
    for component in range(6):
        total += vector[component] * vector[component]
    return np.sqrt(total)
