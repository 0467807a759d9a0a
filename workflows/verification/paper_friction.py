"""FIG6-SMOOTHING, FIG6-HENCKY: the elasto-plastic interface on the pile of the paper's Fig. 6.

The paper shows this interface on two blocks only (Fig. 9), and no such run.  With neo-Hookean soil
the pile goes the whole way on two meshes, and the smoothing of the opening (see
``coulomb_interface``) is shown to vanish.  With Hencky's solid no interface law goes the whole way:
the soil beside the tip corner loses ellipticity, with or without smoothing, with or without a
switch between sticking, slipping and opening.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.conventions import Unit
from install_mpm.discretisation import Scheme
from workflows.verification.body import Body
from workflows.verification.ellipticity import is_elliptic
from workflows.verification.paper_penetration import (
    FRICTION_ANGLE,
    elastic_law,
    friction_law,
)
from workflows.verification.paper_penetration_checks import excess_of_strength, reaction_curve
from workflows.verification.penetration import Penetration, PenetrationResult, penetrate
from workflows.verification.problem import Check, Outcome, Problem, at_least, at_most, relative

Pascal = Annotated[float, Unit("Pa")]
Stiffness = Annotated[float, Unit("Pa/m")]
Metre = Annotated[float, Unit("m")]
Radian = Annotated[float, Unit("rad")]

ONE_MESH_TO_ANOTHER = 0.02
STEPS_HALVED = 5
"""Steps made with the halved smoothing stresses; in longer runs points that are split or merged at
other steps hide the order."""
CUTS_BEFORE_THE_END = 3
"""Halvings of a step before a run in Hencky soil counts as ended."""

NO_REFERENCE_WITH_FRICTION = (
    "The paper shows no such run; two meshes are compared with each other, and the smoothed with "
    "the exact law."
)


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
    h_fine: Metre = 0.25,
    penetration: Metre = 4.0,
) -> Outcome:
    """Return the pile with the elasto-plastic interface of Fig. 9 in neo-Hookean soil.

    On both meshes with the exact law and with the smoothing stress d; the first steps also with
    d / 2 and d / 4.
    """
    checks: list[Check] = []
    exact: list[PenetrationResult] = []
    for h in (h_coarse, h_fine):
        laws = [
            _smooth(friction_law(kn, ks, c, phi), smoothing)
            for smoothing in (0.0, d, d / 2.0, d / 4.0)
        ]
        steps = round(penetration / Penetration.step)
        counts = (steps, steps, *2 * (min(steps, STEPS_HALVED),))
        runs = [
            penetrate(friction_problem(law, E, nu, h, count))
            for law, count in zip(laws, counts, strict=True)
        ]
        checks += _of_one_mesh(f"h = {h:.3g} m", runs, c, phi)
        exact.append(runs[0])
    coarse, fine = (float(result.reaction[-1]) for result in exact)
    text = "reaction on the coarse mesh against the fine, N/m"
    checks.append(relative(text, coarse, fine, ONE_MESH_TO_ANOTHER))
    return Outcome(
        tuple(checks),
        tuple(
            reaction_curve(f"h = {h:.3g} m", result, {})
            for h, result in zip((h_coarse, h_fine), exact, strict=True)
        ),
        (NO_REFERENCE_WITH_FRICTION,),
        exact[0].residuals + exact[1].residuals,
    )


def _of_one_mesh(
    name: str, runs: list[PenetrationResult], cohesion: float, friction_angle: float
) -> list[Check]:
    """Return the checks of the exact run and of those with d, d / 2 and d / 4."""
    exact, *smoothed = runs
    excess = excess_of_strength(exact, cohesion, friction_angle)
    first, second, third = (_changes(run, exact)[:STEPS_HALVED].max() for run in smoothed)
    largest = _changes(smoothed[0], exact).max()
    return [
        at_most(f"({name}) steps that were cut", max(run.cuts for run in runs), 0),
        at_most(f"({name}) shear beyond the strength, share", excess, 1e-9),
        at_most(f"({name}) change of the reaction by the smoothing d, share", largest, 0.005),
        at_least(f"({name}) change by d over that by d / 2, first steps", first / second, 1.5),
        at_least(f"({name}) change by d / 2 over that by d / 4", second / third, 1.5),
    ]


def _changes(run: PenetrationResult, exact: PenetrationResult) -> np.ndarray:
    """Return the change of the reaction over its largest value, (n,) at the full steps of both."""
    ends = Penetration.step * np.arange(1, 1 + round(run.penetration[-1] / Penetration.step))
    change = np.array([run.reaction_at(end) - exact.reaction_at(end) for end in ends])
    largest: np.ndarray = np.abs(change) / np.abs(exact.reaction).max()
    return largest


def friction_problem(
    law: CoulombInterface, E: float, nu: float, h: float, steps: int
) -> Penetration:
    """Return the pile with friction in neo-Hookean soil, default discretisation."""
    return Penetration(
        E, nu, size=h, steps=steps, law=law, scheme=Scheme.CARRIERS, is_neo_hookean=True
    )


def _smooth(law: CoulombInterface, smoothing: float) -> CoulombInterface:
    """Return the law with this smoothing stress in Pa."""
    return replace(law, smoothing_stress=smoothing)


def fig6_hencky(
    *,
    E: Pascal = 10e3,
    nu: float = 0.0,
    kn: Stiffness = 1e8,
    ks: Stiffness = 1e7,
    ks_small: Stiffness = 1e1,
    c: Pascal = 0.1,
    phi: Radian = FRICTION_ANGLE,
    d: Pascal = 200.0,
    h: Metre = 0.5,
    penetration: Metre = 4.0,
) -> Outcome:
    """Return how far the pile gets in Hencky soil, and where the soil has lost ellipticity.

    With the exact law, with the smoothed one, and with an elastic interface, which never switches.
    Every run that ends early has to have lost ellipticity before, and none may cut a step as long
    as all soil is elliptic.
    """
    laws = {
        "exact friction": friction_law(kn, ks, c, phi),
        "smoothed friction": _smooth(friction_law(kn, ks, c, phi), d),
        "elastic interface": elastic_law(kn, ks_small),
    }
    runs = {
        name: _penetrate_hencky(Penetration(
            E, nu, size=h, steps=round(penetration / Penetration.step), law=law,
            scheme=Scheme.CARRIERS,
            max_cuts=CUTS_BEFORE_THE_END,
        ))
        for name, law in laws.items()
    }  # fmt: skip
    checks: list[Check] = []
    for name, (result, loss) in runs.items():
        reached = float(result.penetration[-1])
        if result.failure:
            text = f"({name}) penetration at loss of ellipticity over that at the end"
            checks.append(at_most(text, loss.penetration / reached, 1.0))
        checks.append(at_least(f"({name}) first cut step over loss of ellipticity, m",
                               _first_cut(result), min(loss.penetration, reached)))  # fmt: skip
    losses = [runs[name][1].penetration for name in ("exact friction", "smoothed friction")]
    if np.isfinite(losses).all():
        text = "penetration at loss of ellipticity, smoothed against exact friction, m"
        checks.append(relative(text, losses[1], losses[0], 0.05))
    return Outcome(
        tuple(checks),
        tuple(reaction_curve(name, result, {}) for name, (result, _) in runs.items()),
        tuple(_in_words(name, *run) for name, run in runs.items()),
        tuple(history for result, _ in runs.values() for history in result.residuals),
    )


class _Loss(NamedTuple):
    """Where soil has lost ellipticity first."""

    penetration: float
    """In m; infinite if all soil is elliptic to the end."""
    points: int
    """How many material points."""
    beside: tuple[float, float]
    """Their mean place from the tip corner, away from the pile and upward, in m."""


def _penetrate_hencky(problem: Penetration) -> tuple[PenetrationResult, _Loss]:
    """Return the run as far as it goes, and the first loss of ellipticity."""
    nu = problem.poissons_ratio
    shear_modulus = problem.youngs_modulus / (2.0 * (1.0 + nu))
    first_lame = 2.0 * shear_modulus * nu / (1.0 - 2.0 * nu)
    losses: list[_Loss] = []

    def look(penetration: float, body: Body) -> None:
        is_lost = ~is_elliptic(body.points.elastic_log_strain, shear_modulus, first_lame)
        if is_lost.any() and not losses:
            corner = np.array([problem.half_width, -problem.embedment - penetration])
            x, z = (body.points.position[is_lost] - corner).mean(axis=0)
            losses.append(_Loss(penetration, int(is_lost.sum()), (float(x), float(z))))

    result = penetrate(problem, may_stop=True, observe=look)
    return result, losses[0] if losses else _Loss(np.inf, 0, (0.0, 0.0))


def _first_cut(result: PenetrationResult) -> float:
    """Return the penetration in m before the first step that is shorter than the full one."""
    lengths = np.diff(result.penetration, prepend=0.0)
    is_cut = lengths < 0.99 * Penetration.step
    ends = result.penetration - lengths
    return float(ends[is_cut][0] if is_cut.any() else result.penetration[-1])


def _in_words(name: str, result: PenetrationResult, loss: _Loss) -> str:
    """Return what became of a run in Hencky soil."""
    reached = f"({name}) the last step that converges ends at {result.penetration[-1]:.4g} m"
    if not loss.points:
        return f"{reached}; all soil is elliptic there."
    x, z = loss.beside
    return (
        f"{reached}; from {loss.penetration:.4g} m on soil is not elliptic, at first {loss.points} "
        f"points {x:.2g} m beside and {z:.2g} m above the tip corner."
    )


PROBLEMS = (
    Problem(
        "FIG6-SMOOTHING",
        "Pile with friction: the smooth opening vanishes with its stress",
        fig6_smoothing,
        is_quick=False,
    ),
    Problem(
        "FIG6-HENCKY",
        "Pile with friction in Hencky soil: loss of ellipticity",
        fig6_hencky,
        is_quick=False,
    ),
)
