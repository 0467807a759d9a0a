"""FIG6, FIG8: the paper's pile penetrates elastic soil, without slip and with interfaces.

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
    geometry,
    is_of_the_paper,
    not_claimed,
    reaction_curve,
    scaled,
    states_picture,
)
from workflows.verification.penetration import (
    penetrate,
    surface,
)
from workflows.verification.problem import (
    Check,
    Outcome,
    Problem,
    Series,
    at_most,
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


def elastic_law(kn: float, ks: float) -> CoulombInterface:
    """Return an interface that neither slips nor opens."""
    return CoulombInterface(kn, ks, cohesion=1e12)


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
