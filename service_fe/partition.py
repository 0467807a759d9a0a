"""How the soil is divided among the ranks of MPI, and how they come together again.

Meshes, nodal arrays and accepted states are whole on every rank.  What is
evaluated in each iteration (soil laws, forces, stiffness, factors) is divided: each rank has its
own cells with their integration points.
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from mpi4py import MPI

from handoff.fe_state_file import FEState

T = TypeVar("T")


def gathered(comm: MPI.Intracomm, own: np.ndarray) -> np.ndarray:
    """Return the rows of all ranks, one after the other and the same on each."""
    return own.copy() if comm.size == 1 else np.concatenate(comm.allgather(own))


class Partition:
    """The integration points ``own_points`` (n,) of this rank, ascending; each belongs to one."""

    def __init__(self, comm: MPI.Intracomm, own_points: np.ndarray) -> None:
        self.comm, self.own_points = comm, own_points
        self._points = gathered(comm, own_points)

    def own(self, state: FEState) -> FEState:
        """Return ``state`` at the own integration points; its interface stays whole."""
        if self.comm.size == 1:
            return state
        return state._replace(
            cauchy_stress=state.cauchy_stress[self.own_points],
            elastic_strain=state.elastic_strain[self.own_points],
            state_variables=state.state_variables[self.own_points],
            material=state.material[self.own_points],
        )

    def whole(self, values: np.ndarray) -> np.ndarray:
        """Return the values (n_q, ...) of all integration points from those (n, ...) of each rank.

        They are in the order of the cells of the ``FEMesh``, whatever the partition.
        """
        rows = gathered(self.comm, values)
        in_order = np.empty_like(rows)
        in_order[self._points] = rows
        return in_order

    def agreed(self, value: T) -> T:
        """Return the first rank's ``value``, on which all ranks decide alike.

        What every rank computes for itself may differ in the last bit, because the order of sums in
        a vector depends on where it lies in memory.
        """
        return value if self.comm.size == 1 else self.comm.bcast(value)

    def sum_of(self, values: np.ndarray) -> np.ndarray:
        """Return the sum of an array over the ranks, the same to the last bit on each."""
        if self.comm.size == 1:
            return values
        total = np.zeros_like(values)
        self.comm.Reduce(values, total)
        self.comm.Bcast(total)
        return total


ALONE = Partition(MPI.COMM_SELF, np.zeros(0, dtype=np.int64))
"""One rank that asks no other."""
