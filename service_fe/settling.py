"""A step that Newton's method does not solve is settled: damped, until nothing is left to damp.

Soil whose flow is not associated can lose the stability of its equilibrium although it does not
soften: the way to the next equilibrium is then a motion, and no sequence of equilibria leads there.
A viscous stress carries what is out of balance on the way,

    sigma + d D_e deps ,

D_e being the elastic stiffness and deps the strain of a part of the step.  The load is applied in
the first part and kept; from part to part the damping d falls, and the last part has none.  The end
is an equilibrium of the undamped soil; how the soil came there depends on d a little.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from handoff.fe_state_file import FEState
from service_fe.newton import StepNotConvergedError
from service_fe.problem import ServiceProblem
from service_fe.rigid_pile import PileControl
from service_fe.step import Step, Unknowns

LESS = 0.25
"""Change of the damping after a part that converged; after one that did not it is the inverse."""
SMALLEST = 1e-3
"""Share of the first damping below which the next part has none."""
LARGEST = 100.0
"""Times the first damping at which the step is given up."""
MAX_PARTS = 60


class Settled(NamedTuple):
    """A step taken in damped parts; ``last`` is undamped."""

    last: Step
    increment: Unknowns
    iterations: int
    parts: int
    """Damped parts."""


def settle(
    problem: ServiceProblem, state: FEState, control: PileControl, damping: float
) -> Settled:
    """Return the step from ``state`` to what is imposed, begun with ``damping``.

    Raises
    ------
    StepNotConvergedError
        If it does not come to rest.
    """
    total = Unknowns(np.zeros_like(problem.mesh.nodes), np.zeros_like(control.motion))
    now, iterations, parts = damping, 0, 0
    for _ in range(MAX_PARTS):
        try:
            step = problem.solve(state, control, damping=now)
        except StepNotConvergedError:
            now = max(now, SMALLEST * damping) / LESS
            if now > LARGEST * damping:
                raise
            continue
        state, total = step.state, total.plus(step.increment)
        iterations += step.iterations
        if now == 0.0:
            return Settled(step, total, iterations, parts)
        parts += 1
        control = control._replace(motion=np.zeros_like(control.motion))  # it has been made
        now = LESS * now if now > SMALLEST * damping else 0.0
    raise StepNotConvergedError(f"the soil is not at rest after {MAX_PARTS} damped parts", ())
