"""PA15: a heavy block is pulled along a rough rigid plane.

It starts to slip at H = c L + N tan(phi), at the displacement H / (k_s L), and then needs no
further force; with dilation it climbs at the angle psi.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from install_mpm.constitutive import coulomb_interface
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic
from install_mpm.conventions import Unit
from workflows.verification.problem import (
    Check,
    Outcome,
    Problem,
    Series,
    absolute,
    at_most,
    relative,
)
from workflows.verification.small_strain_blocks import load, make_blocks

NODES = np.array([[0, 0], [1, 0], [1, -1], [0, -1]], dtype=float)
CELLS = np.array([[3, 2, 1, 0]])
PLANE = np.array([[0, 1]])
"""The plane lies above a hanging block, as the pile lies above the soil.

Weight acts upward there.
"""


@dataclass(frozen=True)
class SlidingBlockResult:
    """Pull and climb of the block, and what they should be."""

    displacement: np.ndarray
    """Horizontal displacement, (n_steps,) in m."""
    force: np.ndarray
    """Pull, (n_steps,) in N."""
    exact: np.ndarray
    """Closed form of the pull, (n_steps,) in N."""
    climb: np.ndarray
    """Distance from the plane since slip began, (n_steps,) in m."""
    exact_climb: np.ndarray
    """Slip times tan(psi), (n_steps,) in m."""
    normal_force: np.ndarray
    """Force between block and plane, compression positive, (n_steps,) in N."""
    residuals: tuple[np.ndarray, ...]
    """Relative residuals of the Newton iterations of each step."""


def sliding_block(
    *,
    weight: float = 20e3,
    cohesion: float = 2e3,
    friction_angle: float = np.deg2rad(24.0),
    dilation_angle: float = 0.0,
    shear_stiffness: float = 1e7,
    normal_stiffness: float = 1e8,
    displacement: float = 2.4e-3,
    steps: int = 8,
) -> SlidingBlockResult:
    """Return pull and climb of a block of unit length under ``displacement`` in equal steps.

    Parameters
    ----------
    weight
        Normal force N in N.
    cohesion
        In Pa.
    friction_angle, dilation_angle
        In rad.
    shear_stiffness, normal_stiffness
        Of the interface, in Pa/m.
    displacement
        Final horizontal displacement in m.
    """
    law = CoulombInterface(
        normal_stiffness,
        shear_stiffness,
        cohesion=cohesion,
        friction_angle=friction_angle,
        dilation_angle=dilation_angle,
    )
    blocks = make_blocks(
        NODES,
        CELLS,
        PLANE,
        HenckyElastic(1e7, 0.0),
        coulomb_interface.pack(law, np.zeros(1))[0],
        unit_weight=-weight,
    )
    is_prescribed = np.zeros(NODES.shape, dtype=bool)
    is_prescribed[:, 0] = True
    blocks, _ = load(blocks, is_prescribed, np.zeros_like(NODES))  # the weight alone
    motion = np.zeros_like(NODES)
    motion[:, 0] = displacement / steps
    forces, climbs, normals, residuals = [], [0.0], [], []
    for _ in range(steps):
        blocks, equilibrium = load(blocks, is_prescribed, motion)
        forces.append(equilibrium.reaction[:, 0].sum())
        residuals.append(equilibrium.newton.residuals)
        climbs.append(climbs[-1] - equilibrium.displacement[:2, 1].mean())
        normals.append(-(blocks.interface.traction[:, 1] * blocks.interface.area).sum())
    pulled = displacement * np.arange(1, steps + 1) / steps
    strength = cohesion + weight * np.tan(friction_angle)
    slip = np.maximum(pulled - strength / shear_stiffness, 0.0)
    return SlidingBlockResult(
        pulled,
        np.array(forces),
        np.minimum(shear_stiffness * pulled, strength),
        np.array(climbs[1:]),
        slip * np.tan(dilation_angle),
        np.array(normals),
        tuple(residuals),
    )


Stress = Annotated[float, Unit("Pa")]
Stiffness = Annotated[float, Unit("Pa/m")]
Angle = Annotated[float, Unit("rad")]

DEGREES_24, DEGREES_10 = float(np.deg2rad(24.0)), float(np.deg2rad(10.0))


def pa15(
    *,
    N: Annotated[float, Unit("N")] = 20e3,
    c: Stress = 2e3,
    phi: Angle = DEGREES_24,
    psi: Angle = DEGREES_10,
    ks: Stiffness = 1e7,
    kn: Stiffness = 1e8,
    u_over_onset: float = 2.2,
) -> Outcome:
    """A block of weight N and unit length L is pulled along a rough plane.

    It starts to slip at H = c L + N tan(phi), at the displacement H / (k_s L), and then needs no
    further force; with dilation it climbs by tan(psi) times its slip, under the same N.  It is
    pulled to ``u_over_onset`` times the displacement at first slip, without and with dilation.
    """
    onset = (c + N * np.tan(phi)) / ks
    results = {
        name: sliding_block(
            weight=N,
            cohesion=c,
            friction_angle=phi,
            dilation_angle=angle,
            shear_stiffness=ks,
            normal_stiffness=kn,
            displacement=u_over_onset * onset,
        )
        for name, angle in (("psi = 0", 0.0), ("dilation", psi))
    }
    checks = [check for name, result in results.items() for check in _checks(name, result, N)]
    return Outcome(
        checks=tuple(checks),
        series=_curves(results["dilation"]),
        residual_histories=tuple(
            tuple(history) for result in results.values() for history in result.residuals
        ),
    )


def _checks(name: str, result: SlidingBlockResult, weight: float) -> tuple[Check, ...]:
    force, exact = result.force, result.exact
    worst = int(np.argmax(np.abs(force / exact - 1.0)))
    normal = result.normal_force
    iterations = max(len(history) - 1 for history in result.residuals)
    return (
        relative(f"{name}: pull at the end, N/m", force[-1], exact[-1], 1e-8),
        relative(f"{name}: pull, its worst step, N/m", force[worst], exact[worst], 1e-8),
        absolute(f"{name}: climb at the end over displacement",
                 result.climb[-1] / result.displacement[-1],
                 result.exact_climb[-1] / result.displacement[-1], 1e-8),
        relative(f"{name}: normal force at the end, N/m", normal[-1], weight, 1e-8),
        at_most(f"{name}: Newton iterations of a step, largest", iterations, 3),
    )  # fmt: skip


def _curves(result: SlidingBlockResult) -> tuple[Series, ...]:
    """Return pull and climb of the block with dilation."""
    x, axis = tuple(result.displacement), "displacement, m"
    force, climb = tuple(result.force), tuple(result.climb)
    return (
        Series("pull", axis, "pull, N/m", x, force, tuple(result.exact)),
        Series("climb with dilation", axis, "climb, m", x, climb, tuple(result.exact_climb)),
    )


PROBLEM = Problem("PA15", "Block pulled along a rough plane", pa15, is_quick=True)
