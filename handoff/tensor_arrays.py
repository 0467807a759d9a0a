"""Arrays of symmetric tensors as Mandel six-vectors and back (``constitutive.mandel``)."""

from __future__ import annotations

import numpy as np

from install_mpm.constitutive.mandel import COLUMN, ROW, SCALE


def six_vectors(tensors: np.ndarray) -> np.ndarray:
    """Return the Mandel six-vectors (n, 6) of symmetric ``tensors`` (n, 3, 3)."""
    vectors: np.ndarray = tensors[:, ROW, COLUMN] * SCALE
    return vectors


def tensors_of(vectors: np.ndarray) -> np.ndarray:
    """Return the symmetric tensors (n, 3, 3) of Mandel six-vectors (n, 6)."""
    tensors = np.empty((len(vectors), 3, 3))
    tensors[:, ROW, COLUMN] = vectors / SCALE
    tensors[:, COLUMN, ROW] = vectors / SCALE
    return tensors


def relative_norm(change: np.ndarray, reference: np.ndarray, volumes: np.ndarray) -> float:
    """Return the volume-weighted L2 norm of tensors ``change`` over that of ``reference``."""
    norms = [np.sqrt(volumes @ (field**2).sum(axis=(1, 2))) for field in (change, reference)]
    return float(norms[0] / norms[1])
