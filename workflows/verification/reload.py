"""PB9: a jacked pile is unloaded to zero head load, and pushed on.

After the rebound the pile must carry what it carried at the end of penetration, and the work put
into the ground is positive: nothing is gained from a cycle.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.conventions import Unit
from install_mpm.ground import Ground
from install_mpm.installation import advance_pile, install
from install_mpm.installation_setup import Installation, set_up
from install_mpm.options import BackgroundMeshOptions, Box, InstallationProgramme, Numerics
from install_mpm.pile import Pile
from install_mpm.state_file import InstalledState
from workflows.verification.body import ProblemNotSolvedError
from workflows.verification.problem import Outcome, Problem, Series, at_least

CAPACITY_KEPT = 0.98
"""Part of the last resistance to penetration that the reloaded pile must carry."""

MOST_REBOUND_STEPS = 50
"""Steps of unloading after which the pile has not come free."""


def reload(
    *,
    B: Annotated[float, Unit("m")] = 1.0,
    embedment: Annotated[float, Unit("m")] = 4.0,
    penetration: Annotated[float, Unit("m")] = 0.3,
    gamma: Annotated[float, Unit("N/m^3")] = 18e3,
    su: Annotated[float, Unit("Pa")] = 20e3,
    E_over_su: float = 200.0,
    nu: float = 0.49,
    alpha: float = 0.5,
    size: float = 0.25,
    step: Annotated[float, Unit("m")] = 0.03,
    cycle_step: Annotated[float, Unit("m")] = 0.005,
) -> Outcome:
    """Return the resistance before and after a cycle of the head load, per metre run.

    The pile is pushed on by a tenth of its width B after the rebound; ``size`` of the cells at the
    pile is over B.
    """
    soil = VonMises(E_over_su * su, nu, su)
    stiffness = 50.0 * soil.youngs_modulus / B
    data = (
        Ground(gamma, 1.0, soil),
        Pile(0.5 * B, embedment, gamma),
        CoulombInterface(stiffness, 0.1 * stiffness, adhesion_factor=alpha),
        Box(6.0 * B, embedment + 5.0 * B, 0.6 * B),
        BackgroundMeshOptions(size * B, 1.5 * B),
        InstallationProgramme(penetration, step),
        Numerics(),
    )
    installed = install(*data, "")
    problem = set_up(*data, installed.background_mesh)
    released = _push_until_free(problem, installed, -cycle_step)
    reloaded = _push(problem, released, cycle_step, 0.1 * B)
    return _outcome(installed, released, reloaded)


def _push_until_free(
    problem: Installation, state: InstalledState, advance: float
) -> InstalledState:
    """Return the state after steps of ``advance`` (m) at the first head load that is not positive.

    Raises
    ------
    ProblemNotSolvedError
        If a step does not converge, or the head load stays positive.
    """
    for _ in range(MOST_REBOUND_STEPS):
        if state.history.crowd_force[-1] <= 0.0:
            return state
        state = _step(problem, state, advance)
    raise ProblemNotSolvedError("reload: the head load does not come down to zero")


def _push(
    problem: Installation, state: InstalledState, advance: float, distance: float
) -> InstalledState:
    """Return the state after ``distance`` m in steps of about ``advance``."""
    n_steps = round(distance / advance)
    for _ in range(n_steps):
        state = _step(problem, state, distance / n_steps)
    return state


def _step(problem: Installation, state: InstalledState, advance: float) -> InstalledState:
    """Return the state after one step, started as if nothing were known of the last one."""
    control = state.control
    fresh = control._replace(displacement_per_step=np.zeros_like(control.displacement_per_step))
    state, is_accepted = advance_pile(problem, state._replace(control=fresh), advance)
    if not is_accepted:
        raise ProblemNotSolvedError(f"reload: a step of {1e3 * advance:g} mm does not converge")
    return state


def _outcome(
    installed: InstalledState, released: InstalledState, reloaded: InstalledState
) -> Outcome:
    """Return the checks on capacity and work, and the curve."""
    history = reloaded.history
    n_installed, n_released = len(installed.history.penetration), len(released.history.penetration)
    depth, force = history.penetration, history.crowd_force
    last = float(force[n_installed - 1])
    capacity = float(force[n_released:].max())
    work = np.append(0.0, np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(depth)))
    in_cycle = float(work[-1] - work[n_installed - 1])
    checks = (
        at_least("reload capacity over last resistance", capacity / last, CAPACITY_KEPT),
        at_least("work of installation and cycle in kJ/m", float(work[-1]) / 1e3, 0.0),
        at_least("work of rebound and reload in kJ/m", in_cycle / 1e3, 0.0),
    )
    rebound = depth[n_installed - 1] - depth[n_released - 1]
    curve = Series(
        "Head load in installation, rebound and reload", "penetration (m)", "head load (kN/m)",
        tuple(depth), tuple(force / 1e3),
    )  # fmt: skip
    remark = f"Rebound to zero head load: {1e3 * rebound:.1f} mm."
    rows = history.residual_history[1:]
    residuals = tuple(tuple(row[~np.isnan(row)]) for row in rows)
    return Outcome(checks, (curve,), (remark,), residuals)


PROBLEM = Problem("PB9", "Rebound and reload of a jacked pile", reload, is_quick=False)
