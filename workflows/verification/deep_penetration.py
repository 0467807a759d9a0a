"""PB7: a flat-ended round pile penetrates deep into weightless clay, axisymmetric.

The references are fits to the computations of others for cones and flat ends: the figures must lie
in their corridor, and the base resistance must be steady.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.conventions import Kinematics, Unit
from install_mpm.ground import Ground
from install_mpm.history import History
from install_mpm.installation import install
from install_mpm.options import BackgroundMeshOptions, Box, InstallationProgramme, Numerics
from install_mpm.pile import Pile
from workflows.verification.problem import Check, Outcome, Problem, Series, at_most, relative
from workflows.verification.references.penetration import penetration_corridor

LOWEST, HIGHEST = 9.5 / 9.73, 12.5 / 12.07
"""Ends of the corridor over the extremes of the fits: 9.5 to 12.5 at a rigidity index of 100."""

STEADY = 0.02
"""Largest relative change of the base resistance over the last diameter of penetration."""

ROUND_OFF, TOLERANCE = 1e-9, 1e-8
"""Relative residuals."""

SPRING = 50.0
"""Normal stiffness of the interface times diameter over Young's modulus; shear has a tenth."""


def deep_penetration(
    *,
    alpha_1: float = 0.0,
    alpha_2: float = 1.0,
    R: Annotated[float, Unit("m")] = 1.0,
    su: Annotated[float, Unit("Pa")] = 10e3,
    G_over_su: float = 100.0,
    nu: float = 0.49,
    embedment: float = 6.0,
    penetration: float = 12.0,
    size: float = 0.25,
    step: float = 0.1,
) -> Outcome:
    """Return the base resistance over s_u of piles with two values of adhesion over s_u.

    ``embedment`` at the start, ``penetration``, ``size`` of the cells at the pile and ``step`` are
    over the radius R.
    """
    checks = list[Check]()
    series, histories = list[Series](), list[tuple[float, ...]]()
    corridor = _corridor(G_over_su)
    for alpha in (alpha_1, alpha_2):
        soil = VonMises(2.0 * (1.0 + nu) * G_over_su * su, nu, su)
        history = _penetrate(R, soil, alpha, embedment, penetration, size, step)
        reached = history.penetration[1:] / R
        factor = history.base_force[1:] / (np.pi * R**2 * su)
        checks += _checks(alpha, reached, factor, corridor)
        series.append(_curve(alpha, reached, factor, float(np.mean(corridor))))
        histories += [tuple(row[~np.isnan(row)]) for row in history.residual_history[1:]]
    return Outcome(
        tuple(checks), tuple(series), residual_histories=tuple(histories), round_off=ROUND_OFF
    )


def _corridor(rigidity_index: float) -> tuple[float, float]:
    """Return the ends of the corridor: from the lowest smooth to the highest rough fit."""
    smooth, _ = penetration_corridor(rigidity_index=rigidity_index, adhesion=0.0)
    _, rough = penetration_corridor(rigidity_index=rigidity_index, adhesion=1.0)
    return LOWEST * smooth, HIGHEST * rough


def _checks(
    alpha: float, reached: np.ndarray, factor: np.ndarray, corridor: tuple[float, float]
) -> list[Check]:
    """Return the checks of a pile: within the corridor, whose middle is the reference; steady."""
    lowest, highest = corridor
    middle = 0.5 * (lowest + highest)
    diameter_ago = factor[int(np.argmin(np.abs(reached - (reached[-1] - 2.0))))]
    quantity = f"base resistance / su in {lowest:.3g} ... {highest:.3g}, alpha = {alpha:g}"
    return [
        relative(quantity, float(factor[-1]), middle, highest / middle - 1.0),
        at_most(
            f"its change over the last diameter, alpha = {alpha:g}",
            abs(float(factor[-1] / diameter_ago - 1.0)),
            STEADY,
        ),
    ]


def _curve(alpha: float, reached: np.ndarray, factor: np.ndarray, middle: float) -> Series:
    return Series(
        title=f"Base resistance in deep penetration, alpha = {alpha:g}",
        abscissa="penetration / R (-)",
        ordinate="base resistance / su (-)",
        x=tuple(reached),
        computed=tuple(factor),
        reference=(middle,) * len(reached),
    )


def _penetrate(
    radius: float, soil: VonMises, alpha: float, embedment: float, penetration: float,
    size: float, step: float,
) -> History:  # fmt: skip
    """Return the history of a round pile pushed down; lengths but ``radius`` are over it."""
    stiffness = SPRING * soil.youngs_modulus / (2.0 * radius)
    state = install(
        Ground(0.0, 1.0, soil),
        Pile(radius, embedment * radius, 0.0),
        CoulombInterface(stiffness, stiffness / 10.0, adhesion_factor=alpha),
        Box(24.0 * radius, (embedment + penetration + 14.0) * radius, 1.5 * radius),
        BackgroundMeshOptions(size * radius, 2.0 * radius, radius),
        InstallationProgramme(penetration * radius, step * radius),
        Numerics(tolerance=TOLERANCE),
        "",
        kinematics=Kinematics.AXISYMMETRIC,
    )
    return state.history


PROBLEM = Problem("PB7", "Deep penetration of a round pile", deep_penetration, is_quick=False)
