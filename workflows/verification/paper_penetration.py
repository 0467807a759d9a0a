"""FIG6, FIG8: the paper's pile penetrates elastic soil, without slip and with interfaces.

FIG6-FRICTION adds the elasto-plastic interface, which the paper shows on two blocks only (Fig. 9).

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
Radian = Annotated[float, Unit("rad")]

FRICTION_ANGLE = float(np.deg2rad(24.0))
"""Of the interface in the paper's Fig. 9, in rad."""

NO_EXTERNAL_REFERENCE = (
    "The paper prints no numbers for this figure. The reference is a throw-away prototype, "
    "written independently; it is no external reference."
)

NO_REFERENCE_WITH_FRICTION = (
    "The paper shows no such run; two meshes are compared with each other. With Hencky's solid the "
    "step ends where soil beside the tip corner has been stretched beyond ln(stretch) = 1 and has "
    "lost ellipticity, whatever the interface law."
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
        problem = Penetration(E, nu, size=h, steps=_steps(penetration), is_side_fixed=is_side_fixed)
        result = penetrate(problem)
        table = prototype.NO_SLIP.get((h, is_side_fixed), {}) if nu == 0.0 else {}
        checks += _to_prototype(side, result, _scaled(table, E), TO_PROTOTYPE)
        checks.append(_energy(side, result, problem))
        series.append(_curve(side, result, _scaled(table, E)))
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
    problem = Penetration(E, nu, size=h, steps=_steps(penetration), scheme=Scheme.CARRIERS)
    result = penetrate(problem)
    checks = (
        at_most("steps that were cut", result.cuts, 0),
        _energy("roller side", result, problem),
    )
    remarks = (_dissipated("roller side", result, problem),)
    return Outcome(checks, (_curve("roller side", result, {}),), remarks, result.residuals)


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
        problem = Penetration(E, nu, size=h, steps=_steps(penetration), law=elastic_law(kn, ks))
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
        series.append(_curve(name, result, table))
        histories += result.residuals
    return Outcome(tuple(checks), tuple(series), tuple(remarks), tuple(histories))


def _miss(check: Check) -> str:
    """Return a comparison that is not claimed, in words."""
    return f"not claimed within {check.tolerance:.0%}: {check.quantity}, {check.error:+.1%}"


def fig6_friction(
    *,
    E: Pascal = 10e3,
    nu: float = 0.0,
    kn: Stiffness = 1e8,
    ks: Stiffness = 1e7,
    c: Pascal = 0.1,
    phi: Radian = FRICTION_ANGLE,
    h_coarse: Metre = 0.5,
    h_fine: Metre = 1.0 / 3.0,
    penetration: Metre = 4.0,
) -> Outcome:
    """Return the pile with the elasto-plastic interface of Fig. 9, on two meshes.

    The soil is neo-Hookean: Hencky's loses ellipticity beside the tip corner before 4 m.
    """
    law = friction_law(kn, ks, c, phi)
    checks: list[Check] = []
    series: list[Series] = []
    results: list[PenetrationResult] = []
    for h in (h_coarse, h_fine):
        result = penetrate(friction_problem(law, E, nu, h, _steps(penetration)))
        name = f"h = {h:.3g} m"
        excess = _excess_of_strength(result, c, phi)
        checks.append(at_most(f"({name}) steps that were cut", result.cuts, 0))
        checks.append(at_most(f"({name}) shear beyond the strength, share", excess, 1e-9))
        series.append(_curve(name, result, {}))
        results.append(result)
    coarse, fine = (float(result.reaction[-1]) for result in results)
    checks.append(relative("reaction on the coarse mesh against the fine, N/m", coarse, fine, 0.02))
    histories = results[0].residuals + results[1].residuals
    return Outcome(tuple(checks), tuple(series), (NO_REFERENCE_WITH_FRICTION,), histories)


def friction_problem(
    law: CoulombInterface, E: float = 10e3, nu: float = 0.0, h: float = 0.5, steps: int = 40
) -> Penetration:
    """Return the pile with friction in neo-Hookean soil, default discretisation."""
    return Penetration(
        E, nu, size=h, steps=steps, law=law, scheme=Scheme.CARRIERS, is_neo_hookean=True
    )


def _excess_of_strength(result: PenetrationResult, cohesion: float, friction: float) -> float:
    """Return by how much |t_s| exceeds c - t_n tan(phi), over the largest strength; 0 if never."""
    shear, normal = result.body.interface.traction.T
    strength = cohesion - normal * np.tan(friction)
    return float(max((np.abs(shear) - strength).max() / strength.max(), 0.0))


def elastic_law(kn: float, ks: float) -> CoulombInterface:
    """Return an interface that neither slips nor opens."""
    return CoulombInterface(kn, ks, cohesion=1e12)


def friction_law(
    kn: float = 1e8, ks: float = 1e7, c: float = 0.1, phi: float = FRICTION_ANGLE
) -> CoulombInterface:
    """Return the elasto-plastic interface, by default with the strength of the paper's Fig. 9."""
    return CoulombInterface(kn, ks, cohesion=c, friction_angle=phi)


def _steps(penetration: float) -> int:
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


def _curve(name: str, result: PenetrationResult, table: dict[int, float]) -> Series:
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
    Problem(
        "FIG6-FRICTION",
        "Pile with friction in neo-Hookean soil, two meshes",
        fig6_friction,
        is_quick=False,
    ),
    Problem("FIG8", "Pile with elastic interfaces (paper, Fig. 8)", fig8, is_quick=False),
)
