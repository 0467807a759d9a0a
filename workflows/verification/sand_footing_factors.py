"""Bearing capacity factors of sand: strip (PB3, PB4) and circle (PB5), finite elements.

Every factor is found on two meshes: it is approached from above and its error falls.  What is not
in a table of the references, such as another angle for N_gamma, is refused.

Without cohesion and surcharge (PB4) soil beside the edge of the footing carries some ten pascals at
shear strains of a third, and a point or two is at the apex, without stress.  Newton's method is
quadratic there because nothing but the law's own tangent counts (``frictional.APEX_STIFFNESS``);
the first step is cut until it finds the branches of these points.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.conventions import Kinematics, Unit
from workflows.errors import CaseError
from workflows.verification.footing_curve import (
    FootingCurve,
    curve_on_finest_mesh,
    error_over_size,
)
from workflows.verification.problem import (
    Check,
    Outcome,
    Problem,
    Series,
    at_least,
    at_most,
    relative,
)
from workflows.verification.references.bearing_capacity import (
    CIRCLE_SURCHARGE,
    CIRCLE_WEIGHT,
    STRIP_WEIGHT,
    strip_factors,
    tabulated,
)
from workflows.verification.sand_footing import Strength, sand_footing

Length = Annotated[float, Unit("m")]
Stress = Annotated[float, Unit("Pa")]
Angle = Annotated[float, Unit("rad")]
DEGREES_30 = float(np.deg2rad(30.0))

SIZES = (0.05, 0.0125)
"""Edge length of the elements at the footing's edge over its width."""
SIZES_OF_WEIGHT = (0.05, 0.00625)
"""The same for strips with weight alone: a rough one at 20 deg needs the finer mesh."""

TOLERANCE = 0.05
STEEP = np.deg2rad(35.0)
"""Angle above which the tolerance of N_q and N_c is ``TOLERANCE`` and not ``CLOSE``."""
SETTLEMENT, STEEP_SETTLEMENT = 12.0, 16.0
"""Final settlement times E / (q N B), and above ``STEEP``, where the plateau is reached later."""
CLOSE = 0.03
PLATEAU = 1e-3
"""Largest relative change of the load over the last quarter of the settlement."""


class Footing(NamedTuple):
    """A footing, what carries it, and its exact factor."""

    name: str
    strength: Strength
    is_rough: bool
    exact: float
    tolerance: float


def sand_outcome(
    footings: Sequence[Footing],
    sizes: Sequence[float],
    *,
    kinematics: Kinematics,
    width: float,
    unit: float,
    friction_angle: float,
    rigidity_index: float,
    poissons_ratio: float,
) -> Outcome:
    """Return the outcome of ``footings`` on meshes of ``sizes``; see ``sand_footing``."""
    checks: list[Check] = []
    series: list[Series] = []
    histories: list[tuple[float, ...]] = []
    for footing in footings:
        results = [
            sand_footing(
                size,
                footing.strength,
                footing.exact,
                friction_angle=friction_angle,
                is_rough=footing.is_rough,
                kinematics=kinematics,
                width=width,
                unit=unit,
                rigidity_index=rigidity_index,
                poissons_ratio=poissons_ratio,
                relative_settlement=STEEP_SETTLEMENT if friction_angle > STEEP else SETTLEMENT,
            )
            for size in sizes
        ]
        checks += _checks(footing, results)
        series += _series(footing, results, sizes)
        histories += [history for result in results for history in result.residuals]
    return Outcome(tuple(checks), tuple(series), residual_histories=tuple(histories))


def _checks(footing: Footing, results: Sequence[FootingCurve]) -> list[Check]:
    name, exact = footing.name, footing.exact
    coarse, fine = results[0].plateau, results[-1].plateau
    falls = abs((fine - exact) / (coarse - exact))
    return [
        relative(f"{name} on the finest mesh", fine, exact, footing.tolerance),
        at_least(f"{name} approached from above: finest mesh", fine, exact),
        at_most(f"{name}: error of the finest over that of the coarsest mesh", falls, 0.6),
        at_most(
            f"{name}: change of load over the last quarter",
            max(abs(result.slope) for result in results),
            PLATEAU,
        ),
    ]


def _series(
    footing: Footing, results: Sequence[FootingCurve], sizes: Sequence[float]
) -> list[Series]:
    name, exact = footing.name, footing.exact
    return [
        curve_on_finest_mesh(
            f"{name}, finest mesh", results[-1], exact, width="B", factor=footing.strength.value
        ),
        error_over_size(f"{name}, error", results, exact, sizes, width="B"),
    ]


def _known(identifier: str, table: dict[int, float], friction_angle: float) -> float:
    """Return the factor of a table, or refuse the angle in the words of a case."""
    try:
        return tabulated(table, friction_angle)
    except ValueError as error:
        raise CaseError(f"{identifier}: phi: {error}") from error


def pb3(
    *,
    B: Length = 1.0,
    q: Stress = 10e3,
    E_over_q: float = 1e4,
    nu: float = 0.3,
    phi: Angle = DEGREES_30,
) -> Outcome:
    """A rough strip of width B on weightless sand: N_q with a surcharge q, N_c with c = q.

    Prandtl's and Reissner's solutions; flow is associated.  The settlement is 12 N q B / E,
    above 35 deg 16.
    """
    if phi <= 0.0:
        raise CaseError("PB3: phi: the soil has friction; PB1 is the strip on soil without")
    n_q, n_c = strip_factors(friction_angle=phi)
    tolerance = TOLERANCE if phi > STEEP else CLOSE
    footings = (
        Footing("N_q", Strength.SURCHARGE, True, n_q, tolerance),
        Footing("N_c", Strength.COHESION, True, n_c, tolerance),
    )
    return sand_outcome(
        footings, SIZES, kinematics=Kinematics.PLANE_STRAIN, width=B, unit=q,
        friction_angle=phi, rigidity_index=E_over_q, poissons_ratio=nu,
    )  # fmt: skip


def _pb4(
    is_rough: bool, B: float, gamma: float, E_over_gamma_B: float, nu: float, phi: float
) -> Outcome:
    base = "rough" if is_rough else "smooth"
    exact = _known(f"PB4-{base.upper()}", STRIP_WEIGHT[base], phi)
    footing = Footing(f"N_gamma, {base}", Strength.WEIGHT, is_rough, exact, TOLERANCE)
    return sand_outcome(
        (footing,), SIZES_OF_WEIGHT, kinematics=Kinematics.PLANE_STRAIN, width=B,
        unit=0.5 * gamma * B, friction_angle=phi, rigidity_index=2.0 * E_over_gamma_B,
        poissons_ratio=nu,
    )  # fmt: skip


def pb4_smooth(
    *,
    B: Length = 1.0,
    gamma: Annotated[float, Unit("N/m^3")] = 20e3,
    E_over_gamma_B: float = 5e3,
    nu: float = 0.3,
    phi: Angle = DEGREES_30,
) -> Outcome:
    """A smooth strip of width B on sand with weight and no cohesion: N_gamma.

    Flow is associated; phi is 20, 25, 30, 35 or 40 deg.
    """
    return _pb4(False, B, gamma, E_over_gamma_B, nu, phi)


def pb4_rough(
    *,
    B: Length = 1.0,
    gamma: Annotated[float, Unit("N/m^3")] = 20e3,
    E_over_gamma_B: float = 5e3,
    nu: float = 0.3,
    phi: Angle = DEGREES_30,
) -> Outcome:
    """A rough strip of width B on sand with weight and no cohesion; see ``pb4_smooth``."""
    return _pb4(True, B, gamma, E_over_gamma_B, nu, phi)


def pb5(
    *,
    D: Length = 1.0,
    q: Stress = 10e3,
    E_over_q: float = 1e4,
    nu: float = 0.3,
    phi: Angle = DEGREES_30,
) -> Outcome:
    """Circles of diameter D on sand: N_gamma, smooth, with gamma = 2 q / D; N_q with surcharge q.

    Flow is associated, cohesion zero; phi is 20, 25, 30 or 35 deg.
    """
    known = partial(_known, "PB5", friction_angle=phi)
    footings = (
        Footing("N_gamma, smooth", Strength.WEIGHT, False, known(CIRCLE_WEIGHT["smooth"]),
                TOLERANCE),
        Footing("N_q, smooth", Strength.SURCHARGE, False, known(CIRCLE_SURCHARGE["smooth"]),
                TOLERANCE),
        Footing("N_q, rough", Strength.SURCHARGE, True, known(CIRCLE_SURCHARGE["rough"]),
                TOLERANCE),
    )  # fmt: skip
    return sand_outcome(
        footings, SIZES, kinematics=Kinematics.AXISYMMETRIC, width=D, unit=q,
        friction_angle=phi, rigidity_index=E_over_q, poissons_ratio=nu,
    )  # fmt: skip


PROBLEMS = (
    Problem("PB3", "Strip footing on weightless sand, finite elements", pb3, is_quick=False),
    Problem("PB4-SMOOTH", "Smooth strip footing on sand, finite elements", pb4_smooth,
            is_quick=False),
    Problem("PB4-ROUGH", "Rough strip footing on sand, finite elements", pb4_rough,
            is_quick=False),
    Problem("PB5", "Circular footing on sand, finite elements", pb5, is_quick=False),
)  # fmt: skip
