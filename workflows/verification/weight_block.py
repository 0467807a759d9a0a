"""A block of Mohr-Coulomb soil under its own weight, between rollers: every step converges.

A published open implementation of the material point method does not get through this problem: with
Mohr-Coulomb soil its iterations stall, and elements are inverted.  Here every step, of which none
is repeated or cut, converges in at most six iterations, with two cohesions, in plane strain,
axisymmetry and space; ``settling_block`` says what that takes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated

import numpy as np

from install_mpm.constitutive.frictional import PLASTIC_SHEAR
from install_mpm.constitutive.parameters import MohrCoulomb
from install_mpm.conventions import GRAVITY, Kinematics, Unit
from workflows.verification.body import Body
from workflows.verification.problem import (
    Check,
    Outcome,
    Problem,
    Series,
    at_most,
    relative,
)
from workflows.verification.settling_block import Block, Settled, settle

Length = Annotated[float, Unit("m")]
Weight = Annotated[float, Unit("N/m^3")]
Stress = Annotated[float, Unit("Pa")]
Angle = Annotated[float, Unit("rad")]
DEGREES_30 = float(np.deg2rad(30.0))
MOST_ITERATIONS = 6
SIDEWAYS = 1e-8
"""Bound of the horizontal displacement over the height: round-off that has not grown."""

STRESS_ERROR = 0.3
"""Bound of the mean error of the vertical stress over rho g H, times n: a stress that is constant
over a row of cells has 1 / 4 (few points sample it with less).
"""


def _outcome(block: Block, cohesions: Sequence[float]) -> Outcome:
    """Return the outcome for the soil with each of the cohesions in Pa."""
    checks: list[Check] = []
    curves, remarks = [], []
    histories: tuple[tuple[float, ...], ...] = ()
    for cohesion in cohesions:
        settled = settle(block._replace(soil=replace(block.soil, cohesion=cohesion)))
        name = f"c = {cohesion / 1e3:g} kPa"
        checks += [
            replace(check, quantity=f"{name}: {check.quantity}")
            for check in _checks(block, settled)
        ]
        curves.append(_curve(block, settled, name))
        remarks.append(
            f"{name}: {_share_that_yielded(settled.body):.0%} of the points have yielded"
        )
        histories += settled.histories
    return Outcome(tuple(checks), tuple(curves), tuple(remarks), histories)


def _checks(block: Block, settled: Settled) -> tuple[Check, ...]:
    points, histories = settled.body.points, settled.histories
    _, stress, exact = _vertical_stress(block, settled)
    error = np.average(np.abs(stress - exact), weights=points.mass) / (block.weight * block.height)
    sideways = np.abs(points.displacement[:, :-1]).max() / block.height
    return (
        at_most(f"Newton iterations of a step, largest of {block.steps} steps",
                max(len(history) - 1 for history in histories), MOST_ITERATIONS),
        relative("reaction of the base, N", settled.carried, points.mass.sum() * GRAVITY, 1e-8),
        at_most("mean error of the vertical stress over rho g H", float(error),
                STRESS_ERROR / block.n),
        at_most("largest horizontal displacement over H", float(sideways), SIDEWAYS),
    )  # fmt: skip


def _vertical_stress(block: Block, settled: Settled) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return original height in m, vertical Cauchy stress and its exact value in Pa of points."""
    points = settled.body.points
    original = (points.position - points.displacement)[:, -1]
    vertical = points.position.shape[1] - 1
    stress = points.kirchhoff_stress[:, vertical, vertical] / points.volume_ratio
    return original, stress, -block.weight * (block.height - original)


def _curve(block: Block, settled: Settled, name: str) -> Series:
    original, stress, exact = _vertical_stress(block, settled)
    order = np.argsort(original)[:: max(1, len(original) // 400)]
    return Series(
        f"vertical stress, {name}", "height of the original place, m", "Cauchy stress, Pa",
        tuple(original[order]), tuple(stress[order]), tuple(exact[order]),
    )  # fmt: skip


def _share_that_yielded(body: Body) -> float:
    return float((body.points.state_variables[:, PLASTIC_SHEAR] > 0.0).mean())


def kratos_block(
    *,
    H: Length = 10.0,
    rho_g: Weight = 20e3,
    E: Stress = 10e6,
    nu: float = 0.2,
    c: Stress = 5e3,
    c_low: Stress = 1e3,
    phi: Angle = DEGREES_30,
    psi: Angle = 0.0,
    n: int = 50,
    steps: int = 10,
) -> Outcome:
    """A block of Mohr-Coulomb soil settles under its own weight, in plane strain.

    With the cohesion ``c`` and with ``c_low``; ``n`` squares per side, cut by both diagonals, on a
    mesh that stays where it is.  No step may be repeated or cut.
    """
    soil = MohrCoulomb(E, nu, c, phi, psi)
    return _outcome(Block(soil, H, rho_g, n, steps, Kinematics.PLANE_STRAIN), (c, c_low))


def kratos_cylinder(
    *,
    H: Length = 10.0,
    rho_g: Weight = 20e3,
    E: Stress = 10e6,
    nu: float = 0.2,
    c: Stress = 5e3,
    c_low: Stress = 1e3,
    phi: Angle = DEGREES_30,
    psi: Angle = 0.0,
    n: int = 50,
    steps: int = 10,
) -> Outcome:
    """A cylinder of Mohr-Coulomb soil settles under its own weight; see ``kratos_block``.

    ``n`` squares per side, cut by one diagonal, on a mesh that follows the soil.
    """
    soil = MohrCoulomb(E, nu, c, phi, psi)
    return _outcome(Block(soil, H, rho_g, n, steps, Kinematics.AXISYMMETRIC), (c, c_low))


def kratos_cube(
    *,
    H: Length = 10.0,
    rho_g: Weight = 20e3,
    E: Stress = 10e6,
    nu: float = 0.2,
    c: Stress = 5e3,
    c_low: Stress = 1e3,
    phi: Angle = DEGREES_30,
    psi: Angle = 0.0,
    n: int = 16,
    steps: int = 10,
) -> Outcome:
    """A cube of Mohr-Coulomb soil settles under its own weight, in space; see ``kratos_block``.

    ``n`` cubes per side, cut into six tetrahedra each, on a mesh that follows the soil.  They have
    to be fine enough to see the elastic soil under the surface.
    """
    soil = MohrCoulomb(E, nu, c, phi, psi)
    return _outcome(Block(soil, H, rho_g, n, steps, Kinematics.THREE_D), (c, c_low))


PROBLEMS = (
    Problem("KRATOS-BLOCK", "Block of sand under its weight", kratos_block, is_quick=False),
    Problem("KRATOS-BLOCK-3D", "Cube of sand under its weight", kratos_cube, is_quick=False),
    Problem(
        "KRATOS-BLOCK-ROUND", "Cylinder of sand under its weight", kratos_cylinder, is_quick=False
    ),
)
