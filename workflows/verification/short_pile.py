"""PD6: a short rigid pile with a free head is pushed sideways through clay, in space.

Half of the ground is modelled.  Soil and pile part where the interface would have to pull: near the
surface the soil stands behind an open gap, further down its weight holds it to the pile.  Broms
lets the upper 1.5 diameters carry nothing, and lets the rest carry 9 s_u d, which is the
resistance of a deep smooth cylinder.  Finite elements normally lie 0 to 25 % above his limit.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from handoff.facet_points import FacetPoints
from handoff.fe_mesh import FEMesh
from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.conventions import Kinematics, Unit
from install_mpm.ground import Ground
from service_fe.along_pile import levels_of, soil_reaction
from service_fe.loading import ALONG, TILT, UP, ImposedStep, Mode
from service_fe.options import ServiceNumerics
from service_fe.problem import ServiceProblem
from service_fe.rigid_pile import head_frame
from service_fe.solve import advance
from workflows.errors import CaseError
from workflows.verification.problem import Check, Outcome, Problem, Series, at_least, at_most
from workflows.verification.references.piles import broms_reaction, broms_short_pile
from workflows.verification.round_ground import (
    HALF_TURN,
    HALVES,
    equal_area,
    round_mesh,
    round_solid,
    supports,
)

BASE, SHAFT = 0, 1

PLACES = (0.0, 3.0, 8.0, 16.0, 28.0, 44.0, 66.0, 96.0, 136.0, 190.0, 260.0)
"""Displacement of the load's point at the ends of the steps, times E / (s_u d), if e = 0."""

FLAT = 0.02
"""Largest change of the load in the last step."""

SPRING = 5.0
"""Stiffness of the interface times diameter over Young's modulus."""

SMOOTHING = 0.1
"""Contact pressure over s_u below which the interface opens smoothly."""

EXCESS = 0.25
"""Above Broms' limit that finite elements normally reach."""


class Lines(NamedTuple):
    """Lines of a mesh."""

    sectors: int
    """Sides of half of the pile."""
    radii: tuple[float, ...]
    """Over the radius of the pile."""
    depths: tuple[float, ...]
    """Over the length of the pile."""


COARSE = Lines(
    6,
    (0.0, 1.0, 1.4, 2.2, 4.0, 10.0),
    (0.0, 0.06, 0.15, 0.27, 0.4, 0.54, 0.67, 0.78, 0.88, 0.95, 1.0, 1.07, 1.3),
)
FINE = Lines(
    8,
    (0.0, 1.0, 1.25, 1.7, 2.6, 4.5, 10.0),
    (
        0.0, 0.04, 0.1, 0.18, 0.28, 0.4, 0.51, 0.61, 0.7, 0.78, 0.86, 0.93, 0.97, 1.0, 1.04, 1.12,
        1.35,
    ),
)  # fmt: skip


class Clay(NamedTuple):
    """Ground and pile; lengths in m, strength in Pa."""

    strength: float
    diameter: float
    length: float
    adhesion: float
    unit_weight: float
    """In N/m^3, of ground and pile."""
    rigidity: float
    """Young's modulus over the strength."""
    poissons_ratio: float

    def limit(self, height: float) -> float:
        """Return Broms' limit in N of a load at ``height`` in m."""
        return broms_short_pile(
            undrained_shear_strength=self.strength,
            diameter=self.diameter,
            length=self.length,
            load_height=height,
        )


class Push(NamedTuple):
    """How a pile was pushed."""

    place: np.ndarray
    """Displacement of the load's point (step,) in m."""
    load: np.ndarray
    """(step,) in N."""
    depth: np.ndarray
    """Of the levels (n_level,) in m, descending."""
    reaction: np.ndarray
    """Of the soil at the end against the load, per length (n_level,) in N/m."""
    residuals: list[tuple[float, ...]]


def pd6(
    *,
    su: Annotated[float, Unit("Pa")] = 50e3,
    d: Annotated[float, Unit("m")] = 1.0,
    L: Annotated[float, Unit("m")] = 10.0,
    e: Annotated[float, Unit("m")] = 5.0,
    alpha: float = 0.5,
    gamma: Annotated[float, Unit("N/m^3")] = 18e3,
    E_over_su: float = 500.0,
    nu: float = 0.49,
) -> Outcome:
    """A rigid pile is pushed at the surface, and at the height e: limit load against Broms.

    Clay and pile have the unit weight gamma, the clay equal stress in all directions; alpha is the
    adhesion of the pile over su.  The interface opens without tension.  The limit load is that of
    the plateau, when the point of load has moved by 260 (su / E) d (1 + e / L).
    """
    if 1.5 * d >= L:
        raise CaseError("PD6: L: the pile has to be longer than 1.5 times its diameter")
    clay = Clay(su, d, L, alpha, gamma, E_over_su, nu)
    checks, series, histories = list[Check](), list[Series](), list[tuple[float, ...]]()
    for height in (0.0, e):
        coarse, fine = (push(clay, height, lines) for lines in (COARSE, FINE))
        checks += _checks(clay, height, coarse, fine)
        series += _series(clay, height, fine)
        histories += coarse.residuals + fine.residuals
    return Outcome(tuple(checks), tuple(series), residual_histories=tuple(histories))


def _checks(clay: Clay, height: float, coarse: Push, fine: Push) -> list[Check]:
    what = f"load at {height:g} m over Broms' limit"
    rough, near = (pushed.load[-1] / clay.limit(height) for pushed in (coarse, fine))
    return [
        at_least(what, near, 1.0),
        at_most(f"{what}, excess", near - 1.0, EXCESS),
        at_most(f"{what}, change in the last step", fine.load[-1] / fine.load[-2] - 1.0, FLAT),
        at_least(f"{what}, that of a coarse mesh over this", rough / near, 1.0),
    ]


def _series(clay: Clay, height: float, pushed: Push) -> list[Series]:
    limit, strength = clay.limit(height), clay.strength * clay.diameter
    broms = broms_reaction(
        pushed.depth, undrained_shear_strength=clay.strength, diameter=clay.diameter,
        length=clay.length, load_height=height,
    )  # fmt: skip
    return [
        Series(f"Load at {height:g} m", "displacement E / (su d)", "load (kN)",
               tuple(pushed.place * clay.rigidity / clay.diameter), tuple(1e-3 * pushed.load),
               (1e-3 * limit,) * len(pushed.load)),
        Series(f"Soil reaction, load at {height:g} m", "depth / d", "p / (su d)",
               tuple(pushed.depth / clay.diameter), tuple(pushed.reaction / strength),
               tuple(broms / strength)),
    ]  # fmt: skip


def push(clay: Clay, height: float, lines: Lines, places: tuple[float, ...] = PLACES) -> Push:
    """Return how the pile is pushed at a point ``height`` m above the ground.

    ``places`` are those of the point at the ends of the steps, from zero, as in ``PLACES``.  The
    pile may move up and down, and it bears its own weight.
    """
    problem, mode = _problem(clay, lines), _mode(height)
    reach = clay.diameter / clay.rigidity * (1.0 + height / clay.length) * np.array(places)
    state = problem.wished_in_place_state()
    load = problem.pile_load(state) @ mode.frame
    ways, guess = np.diff(reach), None
    loads, residuals = list[float](), list[tuple[float, ...]]()
    for number, way in enumerate(ways):
        first = None if guess is None else guess.scaled(way / ways[number - 1])
        taken = advance(problem, state, ImposedStep(mode, way * mode.measure, load, load), first)
        state, guess = taken.last.state, taken.increment
        loads.append(HALVES * taken.last.pile_load[ALONG])
        residuals.append(taken.last.residuals)
    levels = levels_of(problem)
    assert levels is not None  # there is a pile
    reaction = -HALVES * soil_reaction(problem, state, levels)[:, 0]
    return Push(reach[1:], np.array(loads), -levels.height, reaction, residuals)


def _mode(height: float) -> Mode:
    """Return the control of a load at ``height`` m: in the direction x, the head free to tilt."""
    is_loaded = np.isin(np.arange(6), [UP, TILT])
    return Mode(head_frame(height, 0.0), is_loaded, np.eye(6)[ALONG])


def _problem(clay: Clay, lines: Lines) -> ServiceProblem:
    soil = VonMises(clay.rigidity * clay.strength, clay.poissons_ratio, clay.strength)
    spring = SPRING * soil.youngs_modulus / clay.diameter
    mesh = _mesh(clay, lines)
    section = 0.25 * np.pi * clay.diameter**2
    return ServiceProblem(
        mesh,
        Ground(clay.unit_weight, 1.0, soil),
        CoulombInterface(
            spring,
            spring,
            adhesion_factor=clay.adhesion,
            smoothing_stress=SMOOTHING * clay.strength,
            tensile_strength=0.0,
        ),
        pile_weight=clay.unit_weight * section * clay.length / HALVES,
        numerics=ServiceNumerics(tolerance=1e-7, max_iterations=30),
        is_fixed=supports(mesh, None, "even"),
        kinematics=Kinematics.THREE_D,
        normals=_normals,
    )


def _mesh(clay: Clay, lines: Lines) -> FEMesh:
    sides = 2 * lines.sectors
    radii = 0.5 * clay.diameter * equal_area(sides) * np.array(lines.radii)
    depths = clay.length * np.array(lines.depths)
    solid = round_solid(radii, depths, lines.sectors, HALF_TURN)
    slack = 1e-9 * clay.length

    def part(centres: np.ndarray) -> np.ndarray:
        """Facets of the pile: those inside its radius and not at the plane of symmetry."""
        x, y, z = centres.T
        inside = (np.hypot(x, y) < radii[1] + slack) & (z < -slack) & (z > -clay.length - slack)
        is_base = np.abs(z + clay.length) < slack
        return np.where(inside & (y > slack), np.where(is_base, BASE, SHAFT), -1)

    x, y, z = solid.centroids.T
    is_pile = (np.hypot(x, y) < radii[1]) & (z > -clay.length)
    return round_mesh(solid, ~is_pile, part)


def _normals(facets: FacetPoints) -> np.ndarray:
    """Return the normals (n_i, 3) of a round pile with a flat end, from soil to pile."""
    normals = np.zeros_like(facets.positions)
    across = facets.positions[:, :2]
    normals[:, :2] = -across / np.linalg.norm(across, axis=1)[:, None]
    normals[facets.parts == BASE] = 0.0, 0.0, 1.0
    return normals


PROBLEM = Problem("PD6", "Short rigid pile in clay, lateral", pd6, is_quick=False)
