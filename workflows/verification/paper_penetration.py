"""FIG6, FIG8: the paper's pile penetrates elastic soil, without slip and with interfaces.

The paper gives pictures only.  Reactions are compared with those of a prototype (see
``references.prototype``).  The soil is elastic, so with any parameters the energy that it stores is
at most the work of the pile; what is missing the scheme has lost.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.conventions import Unit
from install_mpm.discretisation import Scheme
from workflows.verification.penetration import (
    Penetration,
    PenetrationResult,
    penetrate,
    surface,
    work_and_energy,
)
from workflows.verification.problem import (
    Check,
    Outcome,
    Problem,
    Series,
    absolute,
    at_most,
    relative,
)
from workflows.verification.references import prototype

Pascal = Annotated[float, Unit("Pa")]
Stiffness = Annotated[float, Unit("Pa/m")]
Metre = Annotated[float, Unit("m")]

NO_EXTERNAL_REFERENCE = (
    "The paper prints no numbers for this figure. The reference is a throw-away prototype, "
    "written independently; it is no external reference."
)

TO_PROTOTYPE = 0.01
STEPS_COMPARED = 20
"""Steps of the smooth interface that are compared; rows of points leave their cells after that."""


def fig6(
    *,
    E: Pascal = 10e3,
    nu: float = 0.0,
    h: Metre = 0.5,
    penetration: Metre = 4.0,
) -> Outcome:
    """Return the no-slip pile with the paper's scheme, outer side as a roller and fixed."""
    checks: list[Check] = []
    series: list[Series] = []
    histories: list[tuple[float, ...]] = []
    remarks = [NO_EXTERNAL_REFERENCE]
    for is_side_fixed, side in ((False, "roller side"), (True, "fixed side")):
        problem = Penetration(
            E, nu, size=h, steps=steps_of(penetration), is_side_fixed=is_side_fixed
        )
        result = penetrate(problem)
        table = prototype.NO_SLIP.get((h, is_side_fixed), {}) if nu == 0.0 else {}
        checks += _to_prototype(side, result, _scaled(table, E), TO_PROTOTYPE)
        checks.append(_energy(side, result, problem))
        series.append(reaction_curve(side, result, _scaled(table, E)))
        remarks.append(_dissipated(side, result, problem))
        histories += result.residuals
    return Outcome(tuple(checks), tuple(series), tuple(remarks), tuple(histories))


def fig6_default(
    *,
    E: Pascal = 10e3,
    nu: float = 0.0,
    h: Metre = 0.5,
    penetration: Metre = 4.0,
) -> Outcome:
    """Return the no-slip pile with the discretisation of the installation stage."""
    problem = Penetration(E, nu, size=h, steps=steps_of(penetration), scheme=Scheme.CARRIERS)
    result = penetrate(problem)
    checks = (
        at_most("steps that were cut", result.cuts, 0),
        _energy("roller side", result, problem),
    )
    remarks = (_dissipated("roller side", result, problem),)
    return Outcome(checks, (reaction_curve("roller side", result, {}),), remarks, result.residuals)


def fig8(
    *,
    E: Pascal = 10e3,
    nu: float = 0.0,
    kn: Stiffness = 1e8,
    ks_large: Stiffness = 1e7,
    ks_small: Stiffness = 1e1,
    h: Metre = 0.5,
    penetration: Metre = 4.0,
) -> Outcome:
    """Return the pile with elastic interfaces of large and small shear stiffness."""
    checks: list[Check] = []
    series: list[Series] = []
    histories: list[tuple[float, ...]] = []
    remarks = [NO_EXTERNAL_REFERENCE]
    has_table = (nu, kn, h, E) == (0.0, 1e8, 0.5, prototype.YOUNGS_MODULUS)
    for ks, name in ((ks_large, "large k_s"), (ks_small, "small k_s")):
        problem = Penetration(E, nu, size=h, steps=steps_of(penetration), law=elastic_law(kn, ks))
        result = penetrate(problem)
        table = prototype.ELASTIC_INTERFACE.get(ks, {}) if has_table else {}
        compared = _to_prototype(name, result, table, TO_PROTOTYPE)
        if ks == ks_small:
            remarks += [_miss(check) for check in compared[STEPS_COMPARED // 10 + 1 :]]
            compared = compared[: STEPS_COMPARED // 10 + 1]
        checks += compared
        levels = surface(result.body.points, problem)
        checks.append(
            at_most("unevenness of the surface beside a smooth pile, m", np.ptp(levels), 0.05)
            if ks == ks_small
            else _dragged(levels, result)
        )
        series.append(reaction_curve(name, result, table))
        histories += result.residuals
    return Outcome(tuple(checks), tuple(series), tuple(remarks), tuple(histories))


def _miss(check: Check) -> str:
    """Return a comparison that is not claimed, in words."""
    return f"not claimed within {check.tolerance:.0%}: {check.quantity}, {check.error:+.1%}"


def elastic_law(kn: float, ks: float) -> CoulombInterface:
    """Return an interface that neither slips nor opens."""
    return CoulombInterface(kn, ks, cohesion=1e12)


def steps_of(penetration: float) -> int:
    """Return the number of steps of the paper in a penetration in m."""
    return round(penetration / Penetration.step)


def _scaled(table: dict[int, float], youngs_modulus: float) -> dict[int, float]:
    factor = youngs_modulus / prototype.YOUNGS_MODULUS
    return {number: factor * force for number, force in table.items()}


def _to_prototype(
    name: str,
    result: PenetrationResult,
    table: dict[int, float],
    tolerance: float,
) -> list[Check]:
    """Return checks of the reaction at the steps of the table that were made."""
    return [
        relative(
            f"({name}) reaction at step {number} against the prototype, N/m",
            result.reaction_at(Penetration.step * number),
            force,
            tolerance,
        )
        for number, force in table.items()
        if Penetration.step * number <= result.penetration[-1] + 1e-9
    ]


def _energy(name: str, result: PenetrationResult, problem: Penetration) -> Check:
    """Return the check that no energy comes from nowhere: elastic soil stores the work at most."""
    work, energy = work_and_energy(result, problem)
    beyond = max(energy / work - 1.0, 0.0)
    return at_most(f"({name}) energy beyond the work of the pile, share", beyond, 0.01)


def _dissipated(name: str, result: PenetrationResult, problem: Penetration) -> str:
    """Return the remark on the work that the scheme loses from step to step."""
    work, energy = work_and_energy(result, problem)
    return (
        f"({name}) work {work / 1e3:.2f} kJ/m, stored {energy / 1e3:.2f} kJ/m: the scheme loses "
        f"{100.0 * (1.0 - energy / work):.1f} %; steps cut: {result.cuts}."
    )


def _dragged(levels: np.ndarray, result: PenetrationResult) -> Check:
    """Return the check of the surface that sticks to the pile against the prototype's, Fig. 6."""
    if abs(result.penetration[-1] - 4.0) > 1e-9 or len(levels) != 8:
        rise = max(levels[0] - levels[-1], 0.0)
        return at_most("rise of the surface towards a rough pile, m", rise, 0.0)
    worst = int(np.abs(levels - prototype.NO_SLIP_SURFACE).argmax())
    return absolute(
        "surface beside a rough pile against the prototype without slip, worst, m",
        levels[worst],
        prototype.NO_SLIP_SURFACE[worst],
        0.02,
    )


def reaction_curve(name: str, result: PenetrationResult, table: dict[int, float]) -> Series:
    """Return the reaction; the reference is the table, between its steps linear."""
    steps = result.penetration / Penetration.step
    reference: tuple[float, ...] = ()
    if table:
        reference = tuple(np.interp(steps, [0, *table], [0.0, *table.values()]))
    return Series(
        f"({name}) reaction on the half pile",
        "penetration, m",
        "reaction, N/m",
        tuple(result.penetration),
        tuple(result.reaction),
        reference,
    )


PROBLEMS = (
    Problem("FIG6", "Pile without slip, the paper's scheme (paper, Fig. 6)", fig6, is_quick=False),
    Problem(
        "FIG6-DEFAULT",
        "Pile without slip, carriers and quadratic cells",
        fig6_default,
        is_quick=False,
    ),
    Problem("FIG8", "Pile with elastic interfaces (paper, Fig. 8)", fig8, is_quick=False),
)
