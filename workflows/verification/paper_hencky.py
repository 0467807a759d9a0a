"""FIG6-HENCKY: with Hencky's solid the pile of the paper's Fig. 6 does not go the whole way.

The soil beside the tip corner loses ellipticity, whatever the interface: with or without smooth
opening, with or without a switch between sticking, slipping and opening.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.conventions import Unit
from install_mpm.discretisation import Scheme
from workflows.verification.body import Body
from workflows.verification.ellipticity import is_elliptic
from workflows.verification.paper_friction import FRICTION_ANGLE, friction_law
from workflows.verification.paper_penetration import elastic_law
from workflows.verification.paper_penetration_checks import geometry, reaction_curve
from workflows.verification.penetration import Penetration, PenetrationResult, penetrate
from workflows.verification.problem import Check, Outcome, Problem, at_least, at_most, relative

Pascal = Annotated[float, Unit("Pa")]
Stiffness = Annotated[float, Unit("Pa/m")]
Metre = Annotated[float, Unit("m")]
Radian = Annotated[float, Unit("rad")]

CUTS_BEFORE_THE_END = 3
"""Halvings of a step before a run counts as ended."""

SAME_PLACE = 0.05


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
    width: Metre = 5.0,
    depth: Metre = 15.0,
    half_width: Metre = 1.0,
    embedment: Metre = 8.0,
    step: Metre = 0.1,
) -> Outcome:
    """Return how far the pile gets in Hencky soil, and where the soil has lost ellipticity.

    With the exact law, with the smoothed one, and with an elastic interface, which never switches.
    Every run that ends early has to have lost ellipticity before, and none may cut a step as long
    as all soil is elliptic.
    """
    exact = friction_law(kn, ks, c, phi)
    laws = {
        "exact friction": exact,
        "smoothed friction": replace(exact, smoothing_stress=d),
        "elastic interface": elastic_law(kn, ks_small),
    }
    box = geometry(h, width, depth, half_width, embedment, step, penetration)
    soil = replace(
        box, youngs_modulus=E, poissons_ratio=nu, scheme=Scheme.CARRIERS,
        max_cuts=CUTS_BEFORE_THE_END,
    )  # fmt: skip
    runs = {name: _penetrate_hencky(replace(soil, law=law)) for name, law in laws.items()}
    checks = [check for name, run in runs.items() for check in _checks(name, *run, step)]
    losses = [runs[name][1].penetration for name in ("exact friction", "smoothed friction")]
    if np.isfinite(losses).all():
        text = "penetration at loss of ellipticity, smoothed against exact friction, m"
        checks.append(relative(text, losses[1], losses[0], SAME_PLACE))
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


def _checks(name: str, result: PenetrationResult, loss: _Loss, step: float) -> list[Check]:
    """Return the checks of a run in steps of ``step`` (m): no cut, and no end, before the loss."""
    reached = float(result.penetration[-1])
    lengths = np.diff(result.penetration, prepend=0.0)
    is_cut = lengths < 0.99 * step
    first_cut = float((result.penetration - lengths)[is_cut][0] if is_cut.any() else reached)
    checks = [
        at_least(f"({name}) penetration at the first cut step against that at loss of ellipticity,"
                 " m", first_cut, min(loss.penetration, reached)),
    ]  # fmt: skip
    if result.failure:
        text = f"({name}) penetration at loss of ellipticity over that at the end"
        checks.append(at_most(text, loss.penetration / reached, 1.0))
    return checks


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


PROBLEM = Problem(
    "FIG6-HENCKY",
    "Pile with friction in Hencky soil: loss of ellipticity",
    fig6_hencky,
    is_quick=False,
)
