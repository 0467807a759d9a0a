"""PA11 and PA12: two elastic blocks joined by one interface element, sheared (paper, Fig. 9).

Two unit squares, the lower one held at its base, the upper one pulled sideways at its top.  While
the interface sticks, the blocks and the interface are springs in series; once it slips, the force
is c L + N tan(phi).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from install_mpm.constitutive import coulomb_interface
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic
from install_mpm.conventions import Unit
from workflows.verification.problem import (
    Check,
    Outcome,
    Picture,
    Problem,
    Series,
    at_most,
    relative,
)
from workflows.verification.small_strain_blocks import load, make_blocks

NODES = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 1], [1, 1], [1, 2], [0, 2]], dtype=float)
CELLS = np.array([[0, 1, 2, 3], [4, 5, 6, 7]])
INTERFACE = np.array([[3, 2, 4, 5]])
BASE, TOP = [0, 1], [6, 7]


@dataclass(frozen=True)
class InterfaceShearResult:
    """Horizontal force per metre run after each step, and what it should be."""

    displacement: np.ndarray
    """Displacement of the top, (n_steps,) in m."""
    force: np.ndarray
    """Computed horizontal force, (n_steps,) in N."""
    exact: np.ndarray
    """Closed form, (n_steps,) in N."""
    slip: float
    """Relative displacement of the two sides at the end in m."""
    exact_slip: float
    """Closed form of it in m."""
    residuals: tuple[np.ndarray, ...]
    """Relative residuals of the Newton iterations of each step."""


def interface_shear(
    *,
    youngs_modulus: float = 10e3,
    shear_stiffness: float = 1e7,
    normal_stiffness: float = 1e7,
    cohesion: float = 0.1,
    friction_angle: float = np.deg2rad(24.0),
    precompression: float = 0.0,
    displacement: float = 0.5,
    steps: int = 10,
    is_held_vertically: bool = True,
) -> InterfaceShearResult:
    """Return the shear force of the blocks.

    The defaults are those of the paper's Fig. 9 (Poisson's ratio is zero).

    Parameters
    ----------
    youngs_modulus, cohesion, precompression
        In Pa.
    shear_stiffness, normal_stiffness
        Of the interface, in Pa/m.
    friction_angle
        In rad; there is no dilation.
    displacement
        Of the top at the end, in m.
    is_held_vertically
        Hold the vertical displacement of all nodes (PA11 a), or of the top only (PA11 b).
    """
    law = CoulombInterface(
        normal_stiffness, shear_stiffness, cohesion=cohesion, friction_angle=friction_angle
    )
    blocks = make_blocks(
        NODES,
        CELLS,
        INTERFACE,
        HenckyElastic(youngs_modulus, 0.0),
        coulomb_interface.pack(law, np.zeros(1))[0],
        vertical_stress=-precompression,
    )
    is_prescribed = np.zeros(NODES.shape, dtype=bool)
    is_prescribed[BASE + TOP] = True
    is_prescribed[:, 1] |= is_held_vertically
    motion = np.zeros_like(NODES)
    motion[TOP, 0] = displacement / steps
    forces, residuals, slip = [], [], 0.0
    for _ in range(steps):
        blocks, equilibrium = load(blocks, is_prescribed, motion)
        forces.append(equilibrium.reaction[TOP, 0].sum())
        residuals.append(equilibrium.newton.residuals)
        slip += equilibrium.displacement[4, 0] - equilibrium.displacement[3, 0]
    top = displacement * np.arange(1, steps + 1) / steps
    # a block that is free to rock is a beam of one element, twice as flexible
    of_blocks = (2.0 if is_held_vertically else 4.0) / (youngs_modulus / 2.0)
    strength = cohesion + precompression * np.tan(friction_angle)
    exact = np.minimum(top / (of_blocks + 1.0 / shear_stiffness), strength)
    return InterfaceShearResult(
        top,
        np.array(forces),
        exact,
        slip,
        displacement - exact[-1] * of_blocks,
        tuple(residuals),
    )


Stress = Annotated[float, Unit("Pa")]
Stiffness = Annotated[float, Unit("Pa/m")]
Length = Annotated[float, Unit("m")]
Angle = Annotated[float, Unit("rad")]

DEGREES_24 = float(np.deg2rad(24.0))

ROUND_OFF = 1e-10
"""Relative residual that is round-off: a trial step is up to 5e6 times the strength."""


def pa11(
    *,
    E: Stress = 10e3,
    ks: Stiffness = 1e7,
    kn: Stiffness = 1e7,
    c: Stress = 0.1,
    phi: Angle = DEGREES_24,
    u: Length = 0.5,
) -> Outcome:
    """Two unit blocks, joined by an interface without normal stress, are sheared in ten steps.

    The force is the lesser of c L and the elastic springs in series, 1 / k = 1 / k_blocks + 1 /
    k_s.  With the data of Fig. 9 of the paper it is c L in every step.  (a) has all vertical
    displacements held, in (b) they are free at the interface.
    """
    results = {
        name: interface_shear(
            youngs_modulus=E,
            shear_stiffness=ks,
            normal_stiffness=kn,
            cohesion=c,
            friction_angle=phi,
            displacement=u,
            is_held_vertically=is_held,
        )
        for name, is_held in (("(a) ", True), ("(b) ", False))
    }
    checks = [check for name, result in results.items() for check in _checks(name, result, 1e-10)]
    return Outcome(
        checks=tuple(checks),
        series=tuple(_curve(name, result) for name, result in results.items()),
        residual_histories=tuple(
            tuple(history) for result in results.values() for history in result.residuals
        ),
        round_off=ROUND_OFF,
        pictures=(_picture(results["(a) "], E),),
    )


def pa12(
    *,
    E: Stress = 10e3,
    ks: Stiffness = 1e7,
    kn: Stiffness = 1e7,
    c: Stress = 0.1,
    phi: Angle = DEGREES_24,
    p: Stress = 1e3,
    u: Length = 0.5,
) -> Outcome:
    """As PA11 (a), under a uniform compression p: an elastic branch, then c L + p L tan(phi)."""
    result = interface_shear(
        youngs_modulus=E,
        shear_stiffness=ks,
        normal_stiffness=kn,
        cohesion=c,
        friction_angle=phi,
        precompression=p,
        displacement=u,
    )
    return Outcome(
        checks=_checks("", result, 1e-8),
        series=(_curve("", result),),
        residual_histories=tuple(tuple(history) for history in result.residuals),
        round_off=ROUND_OFF,
        pictures=(_picture(result, E),),
    )


def _picture(result: InterfaceShearResult, youngs_modulus: float) -> Picture:
    """Return the picture of the blocks, each of which is a shear spring of stiffness E / 2."""

    def draw() -> Any:
        from workflows.verification.paper_drawings import sheared_blocks

        curve = np.column_stack([result.displacement, result.force])
        of_block = float(result.force[-1]) / (youngs_modulus / 2.0)
        return sheared_blocks(of_block, result.slip, float(result.displacement[-1]), curve)

    return Picture("states", "Two blocks as in Fig. 9", draw)


def _checks(name: str, result: InterfaceShearResult, tolerance: float) -> tuple[Check, ...]:
    """Return the checks of the force at the first, the worst and the last step, and of the slip."""
    worst = int(np.argmax(np.abs(result.force / result.exact - 1.0)))
    force, exact = result.force, result.exact
    return (
        relative(f"{name}force at the first step, N/m", force[0], exact[0], tolerance),
        relative(f"{name}force, its worst step, N/m", force[worst], exact[worst], tolerance),
        relative(f"{name}force at the last step, N/m", force[-1], exact[-1], tolerance),
        relative(f"{name}slip at the end, m", result.slip, result.exact_slip, 1e-6),
        at_most(
            f"{name}Newton iterations of a step, largest",
            max(len(history) - 1 for history in result.residuals),
            3,
        ),
    )


def _curve(name: str, result: InterfaceShearResult) -> Series:
    return Series(
        f"{name}shear force",
        "displacement of the top, m",
        "force, N/m",
        tuple(result.displacement),
        tuple(result.force),
        tuple(result.exact),
    )


PROBLEMS = (
    Problem("PA11", "Two blocks sheared at a weak interface (paper, Fig. 9)", pa11, is_quick=True),
    Problem("PA12", "Two blocks sheared under compression", pa12, is_quick=True),
)
