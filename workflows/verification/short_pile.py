"""PD6: a short rigid pile with a free head is pushed sideways through clay, in space.

A quarter of the ground without weight is modelled.  The interface does not part from the soil, so
soil behind the pile pulls: Broms lets the upper 1.5 diameters carry nothing instead, and lets the
rest carry 9 s_u d.  Finite elements normally lie 0 to 25 % above his limit.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from handoff.fe_mesh import FEMesh
from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.conventions import Kinematics, Unit
from install_mpm.ground import Ground
from service_fe.load_step import Step
from service_fe.options import ServiceNumerics
from service_fe.problem import ServiceProblem
from service_fe.rigid_pile import PileControl, head_frame
from workflows.errors import CaseError
from workflows.verification.problem import Outcome, Problem, Series, at_least, at_most
from workflows.verification.quarter_ground import (
    QUARTERS,
    equal_area,
    quarter_mesh,
    quarter_solid,
    supports,
)
from workflows.verification.references.piles import broms_short_pile

SECTORS = 4
RADII = (0.0, 1.0, 1.25, 1.6, 2.2, 3.2, 5.0, 8.0, 14.0)
"""Lines of the mesh over the radius of the pile."""

DEPTHS = (
    0.0, 0.03, 0.07, 0.12, 0.18, 0.26, 0.36, 0.46, 0.56, 0.64, 0.72, 0.8, 0.88, 0.94, 1.0, 1.06,
    1.15, 1.3,
)  # fmt: skip
"""Lines of the mesh over the length of the pile."""

BASE, SHAFT = 0, 1
STEPS = 12
DISPLACEMENT = 120.0
"""Of the load's point at the end, times E / (s_u d), for a point at the surface."""

SPRING = 20.0
"""Stiffness of the interface times diameter over Young's modulus."""

EXCESS = 0.25
"""Above Broms' limit that finite elements normally reach."""


class Clay(NamedTuple):
    """Ground and pile; lengths in m, strength in Pa."""

    strength: float
    diameter: float
    length: float
    adhesion: float
    rigidity: float
    poissons_ratio: float


def pd6(
    *,
    su: Annotated[float, Unit("Pa")] = 50e3,
    d: Annotated[float, Unit("m")] = 1.0,
    L: Annotated[float, Unit("m")] = 10.0,
    e: Annotated[float, Unit("m")] = 5.0,
    alpha: float = 0.0,
    E_over_su: float = 2e4,
    nu: float = 0.49,
) -> Outcome:
    """A rigid pile is pushed at the surface, and at the height e: capacity against Broms."""
    if 1.5 * d >= L:
        raise CaseError("PD6: L: the pile has to be longer than 1.5 times its diameter")
    clay = Clay(su, d, L, alpha, E_over_su, nu)
    checks, series, histories = [], [], []
    for height in (0.0, e):
        place, load, residuals = push(clay, height)
        limit = broms_short_pile(
            undrained_shear_strength=su, diameter=d, length=L, load_height=height
        )
        what = f"load at {height:g} m over Broms' limit"
        checks += [
            at_least(what, load[-1] / limit, 1.0),
            at_most(f"{what}, excess", load[-1] / limit - 1.0, EXCESS),
            at_most(f"{what}, change over the last quarter",
                    load[-1] / load[-1 - STEPS // 4] - 1.0, 0.02),
        ]  # fmt: skip
        series.append(
            Series(f"Load at {height:g} m", "displacement E / (su d)", "load (kN)",
                   tuple(place * E_over_su / d), tuple(1e-3 * load), (1e-3 * limit,) * STEPS)
        )  # fmt: skip
        histories += residuals
    return Outcome(tuple(checks), tuple(series), residual_histories=tuple(histories))


def push(
    clay: Clay, height: float, steps: int = STEPS
) -> tuple[np.ndarray, np.ndarray, list[tuple[float, ...]]]:
    """Return displacement in m and load in N of a point ``height`` m above the ground, (step,)."""
    problem = _problem(clay)
    end = DISPLACEMENT / clay.rigidity * clay.diameter * (1.0 + height / clay.length)
    motion, is_loaded = np.zeros(6), np.zeros(6, dtype=bool)
    motion[0], is_loaded[4] = end / steps, True
    control = PileControl(is_loaded, motion, np.zeros(6), head_frame(height, 0.0))
    state, accepted = problem.wished_in_place_state(), list[Step]()
    for _ in range(steps):
        guess = accepted[-1].increment if accepted else None
        accepted.append(problem.solve(state, control, guess=guess))
        state = accepted[-1].state
    load = np.array([QUARTERS * step.pile_load[0] for step in accepted])
    return end * np.arange(1, steps + 1) / steps, load, [step.residuals for step in accepted]


def _problem(clay: Clay) -> ServiceProblem:
    soil = VonMises(clay.rigidity * clay.strength, clay.poissons_ratio, clay.strength)
    spring = SPRING * soil.youngs_modulus / clay.diameter
    mesh = _mesh(clay)
    return ServiceProblem(
        mesh,
        Ground(0.0, 1.0, soil),
        CoulombInterface(spring, spring, adhesion_factor=clay.adhesion),
        numerics=ServiceNumerics(tolerance=1e-8, max_iterations=30),
        is_fixed=supports(mesh, "odd", "even"),
        kinematics=Kinematics.THREE_D,
        normals=_normals,
    )


def _mesh(clay: Clay) -> FEMesh:
    radii = 0.5 * clay.diameter * equal_area(4 * SECTORS) * np.array(RADII)
    solid = quarter_solid(radii, clay.length * np.array(DEPTHS), SECTORS)
    slack = 1e-9 * clay.length

    def part(centres: np.ndarray) -> np.ndarray:
        """Facets of the pile: those inside its radius and not at the planes of symmetry."""
        x, y, z = centres.T
        inside = (np.hypot(x, y) < radii[1] + slack) & (z < -slack) & (z > -clay.length - slack)
        on_plane = np.minimum(x, y) < slack
        is_base = np.abs(z + clay.length) < slack
        return np.where(inside & ~on_plane, np.where(is_base, BASE, SHAFT), -1)

    x, y, z = solid.centroids.T
    is_pile = (np.hypot(x, y) < radii[1]) & (z > -clay.length)
    return quarter_mesh(solid, ~is_pile, part)


def _normals(part: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Return the normals (n, 3) from soil to pile."""
    normals = np.zeros_like(positions)
    normals[:, :2] = -positions[:, :2] / np.linalg.norm(positions[:, :2], axis=1)[:, None]
    normals[part == BASE] = 0.0, 0.0, 1.0
    return normals


PROBLEM = Problem("PD6", "Short rigid pile in clay, lateral", pd6, is_quick=False)
