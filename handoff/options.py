"""Options of the hand-over: mesh sizes, transfer, equilibration and acceptance thresholds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le

from install_mpm.conventions import Unit

Length = Annotated[float, Unit("m"), Gt(0)]
Share = Annotated[float, Gt(0), Le(1)]
Transfer = Literal["least_squares", "nearest"]


@dataclass(frozen=True)
class HandoffOptions:
    """How the ground is handed over, and which certificate is good enough."""

    size_at_pile: Length
    """Edge length of the finite elements at the pile's corner or plates; twice that along base and
    shaft.
    """
    size_far: Length
    neighbours: Annotated[int, Ge(6)] = 32
    """Material points in each least-squares fit."""
    transfer: Transfer = "least_squares"
    """How the state comes from the points: by least-squares fits, or that of the nearest point."""
    equilibration_steps: Annotated[int, Ge(1)] = 5
    """Ramps in which the out-of-balance force of the transferred state is released."""
    max_synthetic_error: Share = 0.05
    max_out_of_balance: Annotated[float, Gt(0)] = 1e-8
    max_reaction_change: Share = 0.03
    """Resultant on the pile against that in material points, over the sum of the parts."""
    max_pile_displacement: Share = 1e-3
    """Over the width of the pile, in the equilibration: a hundredth of where capacity is read."""
    max_relaxation: Share = 0.05
    """Change of the mean pressure within one pile width in the equilibration."""
