"""FIG6, FIG8: the paper's pile penetrates elastic soil, without slip and with interfaces.

FIG6-FRICTION adds the elasto-plastic interface, which the paper shows on two blocks only (Fig. 9).

The paper gives pictures only.  Reactions are compared with those of a prototype (see
``references.prototype``).  The soil is elastic, so with any parameters the energy that it stores is
at most the work of the pile; what is missing the scheme has lost.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np

from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.conventions import Unit
from install_mpm.discretisation import Scheme
from workflows.verification.paper_penetration_checks import (
    Run,
    checks_to_prototype,
    dissipation_remark,
    dragged_check,
    energy_check,
    excess_of_strength,
    geometry,
    is_of_the_paper,
    not_claimed,
    reaction_curve,
    scaled,
    states_picture,
)
from workflows.verification.penetration import (
    PenetrationResult,
    penetrate,
    surface,
)
from workflows.verification.problem import (
    Check,
    Outcome,
    Problem,
    Series,
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
    width: Metre = 5.0,
    depth: Metre = 15.0,
    half_width: Metre = 1.0,
    embedment: Metre = 8.0,
    step: Metre = 0.1,
) -> Outcome:
    """Return the no-slip pile with the paper's scheme, outer side as a roller and fixed."""
    checks: list[Check] = []
    series: list[Series] = []
    histories: list[tuple[float, ...]] = []
    runs: list[Run] = []
    remarks = [NO_EXTERNAL_REFERENCE]
    box = geometry(h, width, depth, half_width, embedment, step, penetration)
    for is_side_fixed, side in ((False, "roller side"), (True, "fixed side")):
        problem = replace(box, youngs_modulus=E, poissons_ratio=nu, is_side_fixed=is_side_fixed)
        result = penetrate(problem)
        runs.append((side, problem, result))
        has_table = nu == 0.0 and is_of_the_paper(problem)
        table = prototype.NO_SLIP.get((h, is_side_fixed), {}) if has_table else {}
        checks += checks_to_prototype(side, result, scaled(table, E), TO_PROTOTYPE)
        checks.append(energy_check(side, result, problem))
        series.append(reaction_curve(side, result, scaled(table, E)))
        remarks.append(dissipation_remark(side, result, problem))
        histories += result.residuals
    return Outcome(
        tuple(checks),
        tuple(series),
        tuple(remarks),
        tuple(histories),
        pictures=(states_picture(runs),),
    )  # fmt: skip


def fig6_default(
    *,
    E: Pascal = 10e3,
    nu: float = 0.0,
    h: Metre = 0.5,
    penetration: Metre = 4.0,
    width: Metre = 5.0,
    depth: Metre = 15.0,
    half_width: Metre = 1.0,
    embedment: Metre = 8.0,
    step: Metre = 0.1,
) -> Outcome:
    """Return the no-slip pile with the discretisation of the installation stage."""
    box = geometry(h, width, depth, half_width, embedment, step, penetration)
    problem = replace(box, youngs_modulus=E, poissons_ratio=nu, scheme=Scheme.CARRIERS)
    result = penetrate(problem)
    checks = (
        at_most("steps that were cut", result.cuts, 0),
        energy_check("roller side", result, problem),
    )
    remarks = (dissipation_remark("roller side", result, problem),)
    return Outcome(
        checks, (reaction_curve("roller side", result, {}),), remarks, result.residuals,
        pictures=(states_picture([("TRI6 carriers", problem, result)]),),
    )  # fmt: skip


def fig8(
    *,
    E: Pascal = 10e3,
    nu: float = 0.0,
    kn: Stiffness = 1e8,
    ks_large: Stiffness = 1e7,
    ks_small: Stiffness = 1e1,
    h: Metre = 0.5,
    penetration: Metre = 4.0,
    width: Metre = 5.0,
    depth: Metre = 15.0,
    half_width: Metre = 1.0,
    embedment: Metre = 8.0,
    step: Metre = 0.1,
) -> Outcome:
    """Return the pile with elastic interfaces of large and small shear stiffness."""
    checks: list[Check] = []
    series: list[Series] = []
    histories: list[tuple[float, ...]] = []
    runs: list[Run] = []
    remarks = [NO_EXTERNAL_REFERENCE]
    box = geometry(h, width, depth, half_width, embedment, step, penetration)
    has_table = (nu, kn, h, E) == (0.0, 1e8, 0.5, prototype.YOUNGS_MODULUS)
    has_table &= is_of_the_paper(box)
    for ks, name in ((ks_large, "large k_s"), (ks_small, "small k_s")):
        problem = replace(box, youngs_modulus=E, poissons_ratio=nu, law=elastic_law(kn, ks))
        result = penetrate(problem)
        runs.append((name, problem, result))
        table = prototype.ELASTIC_INTERFACE.get(ks, {}) if has_table else {}
        compared = checks_to_prototype(name, result, table, TO_PROTOTYPE)
        if ks == ks_small:
            remarks += [not_claimed(check) for check in compared[STEPS_COMPARED // 10 + 1 :]]
            compared = compared[: STEPS_COMPARED // 10 + 1]
        checks += compared
        levels = surface(result.body.points, problem)
        checks.append(
            at_most("unevenness of the surface beside a smooth pile, m", np.ptp(levels), 0.05)
            if ks == ks_small
            else dragged_check(levels, result, problem)
        )
        series.append(reaction_curve(name, result, table))
        histories += result.residuals
    return Outcome(
        tuple(checks),
        tuple(series),
        tuple(remarks),
        tuple(histories),
        pictures=(states_picture(runs),),
    )  # fmt: skip


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
    width: Metre = 5.0,
    depth: Metre = 15.0,
    half_width: Metre = 1.0,
    embedment: Metre = 8.0,
    step: Metre = 0.1,
) -> Outcome:
    """Return the pile with the elasto-plastic interface of Fig. 9, on two meshes.

    The soil is neo-Hookean: Hencky's loses ellipticity beside the tip corner before 4 m.
    """
    law = friction_law(kn, ks, c, phi)
    checks: list[Check] = []
    series: list[Series] = []
    runs: list[Run] = []
    results: list[PenetrationResult] = []
    for h in (h_coarse, h_fine):
        box = geometry(h, width, depth, half_width, embedment, step, penetration)
        problem = replace(
            box, youngs_modulus=E, poissons_ratio=nu, law=law, scheme=Scheme.CARRIERS,
            is_neo_hookean=True,
        )  # fmt: skip
        result = penetrate(problem)
        name = f"h = {h:.3g} m"
        runs.append((name, problem, result))
        excess = excess_of_strength(result, c, phi)
        checks.append(at_most(f"({name}) steps that were cut", result.cuts, 0))
        checks.append(at_most(f"({name}) shear beyond the strength, share", excess, 1e-9))
        series.append(reaction_curve(name, result, {}))
        results.append(result)
    coarse, fine = (float(result.reaction[-1]) for result in results)
    checks.append(relative("reaction on the coarse mesh against the fine, N/m", coarse, fine, 0.02))
    histories = results[0].residuals + results[1].residuals
    return Outcome(
        tuple(checks), tuple(series), (NO_REFERENCE_WITH_FRICTION,), histories,
        pictures=(states_picture(runs),),
    )  # fmt: skip


def elastic_law(kn: float, ks: float) -> CoulombInterface:
    """Return an interface that neither slips nor opens."""
    return CoulombInterface(kn, ks, cohesion=1e12)


def friction_law(
    kn: float = 1e8, ks: float = 1e7, c: float = 0.1, phi: float = FRICTION_ANGLE
) -> CoulombInterface:
    """Return the elasto-plastic interface, by default with the strength of the paper's Fig. 9."""
    return CoulombInterface(kn, ks, cohesion=c, friction_angle=phi)


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
