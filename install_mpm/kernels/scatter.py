"""Element blocks into the global vector and matrix, in element order."""

from __future__ import annotations

from install_mpm._jit import jit


@jit
def scatter_stiffness(blocks, slots, values):
    """Add element ``blocks`` (n_elements, n, n) to the matrix ``values`` through ``slots``."""
    for e in range(slots.shape[0]):
        for i in range(slots.shape[1]):
            for j in range(slots.shape[2]):
                values[slots[e, i, j]] += blocks[e, i, j]


@jit
def scatter_force(blocks, dofs, vector):
    """Add element ``blocks`` (n_elements, n) to the global ``vector``, in element order."""
    for e in range(dofs.shape[0]):
        for i in range(dofs.shape[1]):
            vector[dofs[e, i]] += blocks[e, i]


@jit
def constrain(indptr, indices, is_free, values):
    """Turn rows and columns of dofs that are not free into those of the identity, in place."""
    for i in range(indptr.shape[0] - 1):
        for entry in range(indptr[i], indptr[i + 1]):
            j = indices[entry]
            if not (is_free[i] and is_free[j]):
                values[entry] = 1.0 if i == j else 0.0
