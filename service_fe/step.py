"""What a load step is solved for, and what it comes to."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from handoff.fe_state_file import FEState


class Unknowns(NamedTuple):
    """Increments since the accepted state."""

    displacement: np.ndarray
    """Soil (node, dim) in m."""
    motion: np.ndarray
    """Pile (n_motions,) in m and rad."""

    def scaled(self, factor: float) -> Unknowns:
        """Return ``factor`` times these increments."""
        return Unknowns(factor * self.displacement, factor * self.motion)

    def plus(self, other: Unknowns) -> Unknowns:
        """Return the sum of two increments."""
        return Unknowns(self.displacement + other.displacement, self.motion + other.motion)


class Step(NamedTuple):
    """An accepted load step."""

    state: FEState
    increment: Unknowns
    pile_load: np.ndarray
    """Load (n_motions,) in N and N m on the modelled part of the pile at the end, less weight."""
    support_reaction: np.ndarray
    """Forces (node, dim) in N of the supports on the soil; zero at free nodes."""
    residuals: tuple[float, ...]
    """Relative out-of-balance force before each iteration and at the end."""
    viscous_share: float
    """Work of the viscous stress over that of the load on the pile; zero without damping."""

    @property
    def head_load(self) -> float:
        """Downward load in N on the head of the modelled part."""
        vertical = self.increment.displacement.shape[1] - 1
        return float(-self.pile_load[vertical]) + 0.0  # no negative zero

    @property
    def iterations(self) -> int:
        """Newton iterations."""
        return len(self.residuals) - 1
