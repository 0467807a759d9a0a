"""Programmes of loading as sequences of steps, each of which can be cut into parts."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np

from service_fe.options import Displace, Programme
from service_fe.rigid_pile import PileControl, loaded, moved


class ImposedStep(Protocol):
    """One step of a programme; ``control`` gives any part of it."""

    @property
    def size(self) -> float:
        """Displacement in m or change of load in N of the whole step."""

    def control(self, start: float, end: float) -> PileControl:
        """Return what is imposed on the pile from share ``start`` to share ``end`` of the step."""


@dataclass(frozen=True)
class DisplacementStep:
    """The pile moves downward by ``displacement`` in m."""

    displacement: float

    @property
    def size(self) -> float:
        """Displacement of the whole step in m."""
        return self.displacement

    def control(self, start: float, end: float) -> PileControl:
        """Return the motion from share ``start`` to share ``end`` of the step."""
        return moved((end - start) * self.displacement)


@dataclass(frozen=True)
class HeadLoadStep:
    """The load on the modelled part of the pile goes from ``load_start`` to ``load_end``, N."""

    load_start: float
    load_end: float

    @property
    def size(self) -> float:
        """Change of load of the step in N."""
        return self.load_end - self.load_start

    def control(self, start: float, end: float) -> PileControl:
        """Return the load at share ``end`` of the step."""
        return loaded(self.load_start + end * self.size)


def imposed_steps(programme: Programme, head_load: float) -> list[ImposedStep]:
    """Return the steps of a programme that starts at ``head_load`` in N on the modelled part."""
    if isinstance(programme, Displace):
        return _displacement_steps(programme)
    loads = head_load * np.linspace(1.0, 0.0, programme.steps + 1)
    return [HeadLoadStep(float(start), float(end)) for start, end in pairwise(loads)]


def _displacement_steps(programme: Displace) -> list[ImposedStep]:
    """Return equal steps, the first in parts that double, because the start of a curve is stiff."""
    n_steps = max(1, int(np.ceil(abs(programme.displacement) / programme.step - 1e-9)))
    step = programme.displacement / n_steps
    parts = 0.5 ** np.arange(programme.first_step_halvings, 0, -1)
    first = [*parts[:1], *parts] if len(parts) else [1.0]
    return [DisplacementStep(float(share * step)) for share in [*first, *[1.0] * (n_steps - 1)]]
