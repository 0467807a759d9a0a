"""An elastic pile that is meshed inside: the second soil of weightless ground."""

from __future__ import annotations

import numpy as np

from handoff.fe_state_file import FEState
from install_mpm.constitutive.parameters import HenckyElastic, SoilParameters
from install_mpm.ground import Layer, LayeredGround
from service_fe.problem import ServiceProblem

PILE_MATERIAL = 1
"""Row of the pile in the soil table."""


def ground_and_pile(soil: SoilParameters, pile: HenckyElastic, depth: float) -> LayeredGround:
    """Return weightless ground of ``soil`` to ``depth`` m, below which nothing is modelled.

    The pile stands in the table as the layer below; ``with_pile`` puts it where it is.
    """
    return LayeredGround(
        (Layer("ground", 0.0, 0.0, 1.0, soil), Layer("pile", 2.0 * depth, 0.0, 1.0, pile))
    )


def with_pile(problem: ServiceProblem, is_pile: np.ndarray) -> FEState:
    """Return the state without stress of a ground in which the points ``is_pile`` (n_q,) are it."""
    state = problem.wished_in_place_state()
    return state._replace(material=np.where(is_pile, PILE_MATERIAL, state.material))
