"""PA18: large expansion of a cylindrical and a spherical cavity in sand.

Mohr-Coulomb soil under an isotropic pressure.  The wall is driven as in ``cavity``, the outer
boundary is held, and so far away that this does not show: the plastic zone is tens of radii wide.
The reference is Yu and Houlsby's solution, integrated for the same expansion.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np

from install_mpm.constitutive.parameters import MohrCoulomb
from install_mpm.conventions import Kinematics, Unit
from workflows.verification.cavity import (
    Cavity,
    beside_exact,
    cylinder_ring,
    expand_cavity,
    sector,
)
from workflows.verification.problem import Outcome, Problem, relative
from workflows.verification.references.mohr_coulomb_cavity import (
    MohrCoulombSoil,
    cavity_pressure,
)

Stress = Annotated[float, Unit("Pa")]
Angle = Annotated[float, Unit("rad")]
DEGREES_30 = float(np.deg2rad(30.0))
TOLERANCE = 0.03
CHECKED_EXPANSIONS = (1.2, 2.0, 5.0)
SMALLEST_RESIDUAL, ROUND_OFF = 1e-10, 1e-11
"""Relative to the forces at the boundary, beside which those at the wall are small."""
NEAR_THE_LIMIT = 0.98
"""Share of the limit pressure above which the solution counts as having reached it."""


def _held_far_away(cavity: Cavity) -> Cavity:
    """Return the cavity with its outer boundary held."""
    radius = np.linalg.norm(cavity.mesh.nodes * cavity.radial_axes, axis=1)
    is_outer = radius > 0.99 * radius.max()  # nodes on the chords lie a little inside
    return replace(cavity, is_held=cavity.is_held | is_outer[:, None])


def _compare(
    cavity: Cavity, a: float, soil: MohrCoulombSoil, expansion: float, steps: int
) -> Outcome:
    """Return the outcome of expanding ``cavity`` beside Yu and Houlsby's solution."""
    law = MohrCoulomb(
        soil.youngs_modulus, soil.poissons_ratio, soil.cohesion, soil.friction_angle,
        soil.dilation_angle,
    )  # fmt: skip
    # small steps at first: the soil yields at an expansion of less than 1e-3
    expansions = 1.0 + (expansion - 1.0) * np.linspace(0.0, 1.0, steps + 1) ** 1.5
    ratio, pressure, histories = expand_cavity(
        _held_far_away(cavity), law, a, expansions, soil.initial_pressure, SMALLEST_RESIDUAL
    )
    is_sphere, p0 = cavity.volume_power == 3, soil.initial_pressure
    exact = np.array([cavity_pressure(value, soil, is_sphere=is_sphere) for value in ratio])
    values = [value for value in CHECKED_EXPANSIONS if value < expansion] + [expansion]
    checks, curve = beside_exact(ratio, pressure / p0, exact / p0, "p0", values, TOLERANCE)
    limit = cavity_pressure(np.inf, soil, is_sphere=is_sphere)
    remark = "the solution itself is farther than 2 % from its limit at the end of this expansion"
    if exact[-1] >= NEAR_THE_LIMIT * limit:
        checks.append(relative("limit pressure / p0", pressure[-1] / p0, limit / p0, TOLERANCE))
        remark = "the limit pressure is compared with that of the largest expansion"
    return Outcome(tuple(checks), (curve,), (remark,), histories, ROUND_OFF)


def pa18(
    *,
    a: Annotated[float, Unit("m")] = 1.0,
    p0: Stress = 100e3,
    E_over_p0: float = 1000.0,
    nu: float = 0.3,
    c: Stress = 0.0,
    phi: Angle = DEGREES_30,
    psi: Angle = 0.0,
    outer_ratio: float = 2000.0,
    expansion: float = 8.0,
    size: float = 0.2,
    steps: int = 60,
) -> Outcome:
    """Return the pressure in a cylindrical cavity in sand, axisymmetric.

    The plastic zone reaches 20 to 50 times as far as the cavity; ``outer_ratio`` is that of the
    held boundary, and ``size`` that of the cells over their radius.
    """
    soil = MohrCoulombSoil(p0, c, phi, psi, E_over_p0 * p0, nu)
    return _compare(cylinder_ring(a, outer_ratio, size), a, soil, expansion, steps)


def pa18_sphere(
    *,
    a: Annotated[float, Unit("m")] = 1.0,
    p0: Stress = 100e3,
    E_over_p0: float = 1000.0,
    nu: float = 0.3,
    c: Stress = 0.0,
    phi: Angle = DEGREES_30,
    psi: Angle = 0.0,
    outer_ratio: float = 200.0,
    expansion: float = 5.0,
    size: float = 0.15,
    steps: int = 80,
) -> Outcome:
    """Return the pressure in a spherical cavity in sand; see ``pa18``."""
    soil = MohrCoulombSoil(p0, c, phi, psi, E_over_p0 * p0, nu)
    cavity = sector(a, outer_ratio, size, Kinematics.AXISYMMETRIC)
    return _compare(cavity, a, soil, expansion, steps)


PROBLEMS = (
    Problem("PA18", "Cylindrical cavity in sand", pa18, is_quick=True),
    Problem("PA18-SPHERE", "Spherical cavity in sand", pa18_sphere, is_quick=False),
)
