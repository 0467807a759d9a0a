"""FIG6-FRICTION, FIG6-SMOOTHING: the elasto-plastic interface on the pile of the paper's Fig. 6.

The paper shows this interface on two blocks only (Fig. 9), and no such run.  The soil is
neo-Hookean; with Hencky's the pile does not go the whole way, see ``paper_hencky``.  Two meshes are
compared with each other, and the law with smooth opening (see ``coulomb_interface``) with the exact
one: what it changes has to vanish with its smoothing stress.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Annotated

import numpy as np

from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.conventions import Unit
from install_mpm.discretisation import Scheme
from workflows.verification.paper_penetration_checks import (
    Run,
    excess_of_strength,
    geometry,
    reaction_curve,
    states_picture,
)
from workflows.verification.penetration import Penetration, PenetrationResult, penetrate
from workflows.verification.problem import (
    Check,
    Outcome,
    Problem,
    Series,
    at_least,
    at_most,
    relative,
)

Pascal = Annotated[float, Unit("Pa")]
Stiffness = Annotated[float, Unit("Pa/m")]
Metre = Annotated[float, Unit("m")]
Radian = Annotated[float, Unit("rad")]

FRICTION_ANGLE = float(np.deg2rad(24.0))
"""Of the interface in the paper's Fig. 9, in rad."""

FIRST_STEPS = 5
"""Steps with the halved smoothing stresses: later a point that is split or merged a step earlier
hides the order."""

LARGEST_CHANGE = 0.005
"""Of the reaction by the smoothing, over the largest reaction."""

FALL = 1.5
"""Least fall of that change when the smoothing stress is halved."""

NO_REFERENCE_WITH_FRICTION = (
    "The paper shows no such run; two meshes are compared with each other. With Hencky's solid the "
    "step ends where soil beside the tip corner has been stretched beyond ln(stretch) = 1 and has "
    "lost ellipticity, whatever the interface law."
)


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
        problem = _in_neo_hookean_soil(box, E, nu, law)
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


def fig6_smoothing(
    *,
    E: Pascal = 10e3,
    nu: float = 0.0,
    kn: Stiffness = 1e8,
    ks: Stiffness = 1e7,
    c: Pascal = 0.1,
    phi: Radian = FRICTION_ANGLE,
    d: Pascal = 200.0,
    h_coarse: Metre = 0.5,
    h_fine: Metre = 1.0 / 3.0,
    penetration: Metre = 4.0,
    width: Metre = 5.0,
    depth: Metre = 15.0,
    half_width: Metre = 1.0,
    embedment: Metre = 8.0,
    step: Metre = 0.1,
) -> Outcome:
    """Return the change of the reaction by the smoothing stresses d, d / 2 and d / 4.

    In the first steps on both meshes; d on the coarse mesh over the whole penetration.
    """
    law = friction_law(kn, ks, c, phi)
    checks: list[Check] = []
    remarks: list[str] = []
    histories: list[tuple[float, ...]] = []
    first = min(penetration, FIRST_STEPS * step)
    for h, name in ((h_coarse, "coarse mesh"), (h_fine, "fine mesh")):
        box = geometry(h, width, depth, half_width, embedment, step, first)
        problem = _in_neo_hookean_soil(box, E, nu, law)
        exact, *smoothed = _with_smoothing(problem, (0.0, d, d / 2.0, d / 4.0))
        changes = [np.abs(_changes(run, exact)[1]).max() for run in smoothed]
        checks += _vanishing(name, changes)
        remarks.append(_in_words(name, d, changes))
        histories += [history for run in smoothed for history in run.residuals]
    box = geometry(h_coarse, width, depth, half_width, embedment, step, penetration)
    exact, smooth = _with_smoothing(_in_neo_hookean_soil(box, E, nu, law), (0.0, d))
    ends, change = _changes(smooth, exact)
    worst = np.abs(change).max()
    checks.append(at_most("whole penetration: change of the reaction by d", worst, LARGEST_CHANGE))
    checks.append(at_most("whole penetration: steps that were cut", smooth.cuts, 0))
    return Outcome(
        tuple(checks),
        (_change_curve(ends, change), reaction_curve("smoothed", smooth, {})),
        tuple(remarks),
        (*histories, *smooth.residuals),
    )


def _with_smoothing(problem: Penetration, stresses: tuple[float, ...]) -> list[PenetrationResult]:
    """Return the results with each of the smoothing ``stresses`` in Pa."""
    assert problem.law is not None
    laws = [replace(problem.law, smoothing_stress=stress) for stress in stresses]
    return [penetrate(replace(problem, law=law)) for law in laws]


def _changes(run: PenetrationResult, exact: PenetrationResult) -> tuple[np.ndarray, np.ndarray]:
    """Return where steps of both end, (n,) in m, and the change there over the largest reaction."""
    is_shared = np.isclose(exact.penetration[:, None], run.penetration, rtol=0.0, atol=1e-6)
    ends = exact.penetration[is_shared.any(axis=1)]
    change = np.array([run.reaction_at(end) - exact.reaction_at(end) for end in ends])
    return ends, change / np.abs(exact.reaction).max()


def _vanishing(name: str, changes: list[float]) -> list[Check]:
    """Return the checks of the largest changes by d, d / 2 and d / 4."""
    text = f"({name}) first steps: change of the reaction by d"
    falls = [before / after for before, after in pairwise(changes)]
    return [
        at_most(f"{text}, over the largest reaction", changes[0], LARGEST_CHANGE),
        at_least(f"{text} over that by d / 2", falls[0], FALL),
        at_least(f"{text} / 2 over that by d / 4", falls[1], FALL),
    ]


def _in_words(name: str, stress: float, changes: list[float]) -> str:
    """Return the largest changes by the smoothing ``stress`` in Pa, its half and its quarter."""
    parts = (f"{change:.1e} with {stress / 2**k:g} Pa" for k, change in enumerate(changes))
    return f"({name}) change over the largest reaction in the first steps: {', '.join(parts)}."


def _change_curve(ends: np.ndarray, change: np.ndarray) -> Series:
    return Series(
        "Change of the reaction by the smoothing",
        "penetration, m",
        "change over the largest reaction",
        tuple(ends),
        tuple(change),
    )


def _in_neo_hookean_soil(
    box: Penetration, E: float, nu: float, law: CoulombInterface
) -> Penetration:
    """Return the pile with the interface ``law``, default discretisation."""
    return replace(
        box, youngs_modulus=E, poissons_ratio=nu, law=law, scheme=Scheme.CARRIERS,
        is_neo_hookean=True,
    )  # fmt: skip


def friction_law(kn: float, ks: float, c: float, phi: float) -> CoulombInterface:
    """Return the elasto-plastic interface without smoothing."""
    return CoulombInterface(kn, ks, cohesion=c, friction_angle=phi)


PROBLEMS = (
    Problem(
        "FIG6-FRICTION",
        "Pile with friction in neo-Hookean soil, two meshes",
        fig6_friction,
        is_quick=False,
    ),
    Problem(
        "FIG6-SMOOTHING",
        "Pile with friction: the smooth opening vanishes with its stress",
        fig6_smoothing,
        is_quick=False,
    ),
)
