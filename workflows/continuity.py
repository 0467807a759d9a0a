"""Continuity: the pile, moved on in the finite elements, takes up the loads of the installation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from install_mpm.screw_pile import ScrewPile
from service_fe.loading import EQUILIBRATED, RESUMED, UP
from service_fe.options import Displace, Programme, Rotate
from service_fe.results import ProgrammeResult, ServiceResult

if TYPE_CHECKING:
    from workflows.case import AnyCase

CONTINUITY_SHARES = (0.02, 0.05)
"""Ways, over the pile width, at which moving on is compared with the installation."""

AT_THE_END = (EQUILIBRATED, RESUMED)
"""Starts of programmes that go on where the installation ended."""

FORCE, TORQUE = "head_load_over_crowd_force", "torque_over_installation_torque"


def is_moved_on(programme: Programme) -> bool:
    """Return whether a programme moves the pile on from where the installation left it.

    That is where the rig let go of it, or where it had driven it to before.
    """
    if isinstance(programme, Rotate):
        return programme.about == "axis" and programme.start in AT_THE_END
    return isinstance(programme, Displace) and programme.start in AT_THE_END


def moved_on(case: AnyCase, result: ProgrammeResult) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return the way (load_step,) in m of a pile that is moved on, and the loads that it takes.

    The way of a pile that turns is that of its rim, positive in the sense that drives it down, and
    so is the torque in N m.  The head load in N is told where the rig's force would be, i.e. unless
    it is prescribed.
    """
    curve, programme, pile = result.curve, result.programme, case.pile
    if not isinstance(programme, Rotate):
        return curve.displacement, {FORCE: curve.head_load}
    assert isinstance(pile, ScrewPile)
    sense = -pile.sense
    loads = {TORQUE: sense * curve.head_load}
    if programme.advance is not None:
        loads[FORCE] = -curve.load[:, UP]
    return sense * curve.displacement * pile.width / 2.0, loads


def continuity_figures(
    case: AnyCase, installation: dict[str, Any], service: ServiceResult
) -> dict[str, dict[str, float]]:
    """Return the loads on the pile that is moved on over those at the end of the installation.

    ``installation`` are its headline figures.  The loads are taken from every programme that goes
    on in the sense of the installation from the equilibrated state, as far as it goes; empty if the
    pile was not moved.
    """
    over = {FORCE: installation["crowd_force_N"], TORQUE: installation.get("torque_N m", 0.0)}
    if installation["penetration_m"] == 0.0 and over[TORQUE] == 0.0:
        return {}
    figures = {}
    for result in service.programmes:
        if not is_moved_on(result.programme):
            continue
        way, loads = moved_on(case, result)
        found = {
            f"{name}_at_{share:g}_B": float(np.interp(share * case.pile.width, way, load))
            / over[name]
            for name, load in loads.items()
            for share in CONTINUITY_SHARES
            if over[name] != 0.0 and share * case.pile.width <= way[-1] * (1.0 + 1e-9)
        }
        if found:
            figures[result.programme.name] = found
    return figures
