"""From element blocks to the global system: sparsity built once, values filled in place."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy import sparse


class SparsityPattern(NamedTuple):
    """Compressed rows of the global matrix, and where every entry of every element block goes.

    The pattern is fixed for a run: dofs that drop out become identity rows, so a solver analyses it
    once.
    """

    indptr: np.ndarray
    """Row starts, (n_dofs + 1,) int32."""
    indices: np.ndarray
    """Columns, (n_entries,) int32."""
    dofs: tuple[np.ndarray, ...]
    """Global dofs of each family of elements, (n_elements, n_element_dofs)."""
    slots: tuple[np.ndarray, ...]
    """Position in the values of each block entry, (n_elements, n_element_dofs, n_element_dofs)."""


def sparsity_pattern(
    connectivities: Sequence[np.ndarray], n_nodes: int, dim: int
) -> SparsityPattern:
    """Return the pattern of families of elements, each given by its nodes (n_elements, n_nodes)."""
    families = [
        (nodes[:, :, None] * dim + np.arange(dim)).reshape(len(nodes), nodes.shape[1] * dim)
        for nodes in connectivities
    ]
    rows = [np.repeat(dofs, dofs.shape[1], axis=1).ravel() for dofs in families]
    columns = [np.tile(dofs, (1, dofs.shape[1])).ravel() for dofs in families]
    n_dofs = n_nodes * dim
    diagonal = np.arange(n_dofs)  # every row has its diagonal: inactive dofs become identity rows
    key = np.concatenate([*rows, diagonal]) * np.int64(n_dofs) + np.concatenate(
        [*columns, diagonal]
    )
    entries, inverse = np.unique(key, return_inverse=True)
    indptr = np.searchsorted(entries // n_dofs, np.arange(n_dofs + 1)).astype(np.int32)
    slots, start = [], 0
    for dofs in families:
        size = dofs.shape[0] * dofs.shape[1] ** 2
        slots.append(inverse[start : start + size].reshape(len(dofs), dofs.shape[1], dofs.shape[1]))
        start += size
    return SparsityPattern(
        indptr, (entries % n_dofs).astype(np.int32), tuple(families), tuple(slots)
    )


def as_matrix(pattern: SparsityPattern, values: np.ndarray) -> sparse.csr_matrix:
    """Return the assembled matrix as a scipy sparse matrix (n_dofs, n_dofs)."""
    n_dofs = len(pattern.indptr) - 1
    return sparse.csr_matrix((values, pattern.indices, pattern.indptr), shape=(n_dofs, n_dofs))
