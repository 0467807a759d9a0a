"""A pile that penetrates a block of soil, as in the paper's Figs 6 and 8: set-up and steps.

Half model in plane strain with the ground surface at z = 0: soil 0 <= x <= width, -depth <= z <= 0,
without weight; the rigid pile fills x < half_width above its tip and moves down in equal steps.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from install_mpm import interface as interfaces
from install_mpm.background_mesh import BackgroundMesh
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic, NeoHookean
from install_mpm.conventions import GRAVITY
from install_mpm.discretisation import Scheme
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import Ground
from install_mpm.interface import InterfaceElements, InterfacePoints, facet_rule
from install_mpm.material_points import MaterialPoints
from install_mpm.mesh_motion import translate
from install_mpm.options import Numerics
from install_mpm.pile import Pile, PileMotion
from install_mpm.pile_surface import follow, initial_interface, pile_elements
from workflows.verification.body import (
    AT_REST,
    Body,
    ProblemNotSolvedError,
    advance,
    make_body,
)
from workflows.verification.paper_mesh import four_points_per_cell, lines, structured_mesh

ON_BOUNDARY = 1e-9
STEPS_BEFORE_GROWTH = 4
"""Steps that must converge after a cut before the step is doubled again."""


@dataclass(frozen=True)
class Penetration:
    """What is modelled; lengths in m, moduli in Pa.  The defaults are the paper's Fig. 6."""

    youngs_modulus: float = 10e3
    poissons_ratio: float = 0.0
    width: float = 5.0
    depth: float = 15.0
    half_width: float = 1.0
    embedment: float = 8.0
    step: float = 0.1
    steps: int = 40
    size: float = 0.5
    """Side of the squares that are split into triangles."""
    is_side_fixed: bool = False
    """Hold the outer side in both directions; otherwise it is a roller."""
    law: CoulombInterface | None = None
    """Interface law; without one the soil sticks to the pile."""
    scheme: Scheme = Scheme.QUADRATURE
    """``QUADRATURE``: three-node cells, four points each.

    ``CARRIERS``: six-node cells, as the installation stage uses them.
    """
    is_neo_hookean: bool = False
    """Neo-Hookean soil; Hencky's loses ellipticity where its logarithmic strain exceeds one."""
    headroom: float = 0.0
    """Empty mesh above the surface."""
    max_cuts: int = 6
    gravity: float = GRAVITY
    """In m/s^2; without effect on weightless ground."""

    @property
    def ground(self) -> Ground:
        """Weightless elastic ground."""
        law = NeoHookean if self.is_neo_hookean else HenckyElastic
        return Ground(0.0, 1.0, law(self.youngs_modulus, self.poissons_ratio))

    @property
    def pile(self) -> Pile:
        """The pile where it starts."""
        return Pile(self.half_width, self.embedment, 0.0)


class PenetrationResult(NamedTuple):
    """What the pile felt, and where the soil went."""

    penetration: np.ndarray
    """After each accepted step, (n,) in m."""
    reaction: np.ndarray
    """Upward soil reaction on the modelled half of the pile, (n,) in N per metre run."""
    cuts: int
    """Steps that were halved."""
    residuals: tuple[tuple[float, ...], ...]
    """Relative Newton residuals of the accepted steps."""
    start: tuple[MaterialPoints, BackgroundMesh]
    body: Body
    """State at the end."""
    failure: str = ""
    """Why the run has ended early; empty if it has not."""

    def reaction_at(self, penetration: float) -> float:
        """Return the reaction in N at the step that ended at ``penetration`` (m).

        Raises
        ------
        ValueError
            If no step ended there.
        """
        found = np.flatnonzero(np.abs(self.penetration - penetration) < 1e-6)
        if len(found) == 0:
            raise ValueError(f"penetration: no step ended at {penetration:.3f} m")
        return float(self.reaction[found[0]])


def penetrate(
    problem: Penetration,
    *,
    may_stop: bool = False,
    observe: Callable[[float, Body], None] = lambda penetration, body: None,
) -> PenetrationResult:
    """Return the result of all steps; a step that does not converge is halved.

    After every accepted step ``observe`` is called with the penetration in m and the state.

    Raises
    ------
    ProblemNotSolvedError
        If a step does not converge after ``problem.max_cuts`` halvings, unless it ``may_stop``.
    """
    body = start_body(problem)
    start = (body.points, body.mesh)
    target, done, size, cuts, since = problem.steps * problem.step, 0.0, problem.step, 0, 0
    record: list[tuple[float, float, tuple[float, ...]]] = []
    failure = ""
    while done < target - ON_BOUNDARY:
        # after cuts, steps still end on the multiples of the full step
        ahead = problem.step * (np.floor(done / problem.step + 1e-6) + 1.0) - done
        advance_by = min(size, ahead)
        try:
            moved, force, residuals = _advance(problem, body, done, advance_by)
        except ProblemNotSolvedError as error:
            if size <= problem.step * 0.5**problem.max_cuts:
                if not may_stop:
                    raise
                failure = str(error)
                break
            size, cuts, since = advance_by / 2.0, cuts + 1, 0
            body = body._replace(start=body.start * 0.5)
            continue
        body, done, since = moved, done + advance_by, since + 1
        record.append((done, force, residuals))
        observe(done, body)
        if since >= STEPS_BEFORE_GROWTH and size < problem.step:
            size, since = min(2.0 * size, problem.step), 0
    depths, forces, histories = zip(*record, strict=True)
    return PenetrationResult(
        np.array(depths), np.array(forces), cuts, histories, start, body, failure
    )


def start_body(problem: Penetration) -> Body:
    """Return the undisturbed soil around the pile."""
    is_quadratic = problem.scheme == Scheme.CARRIERS
    mesh = soil_mesh(problem, is_quadratic=is_quadratic)
    body = make_body(
        mesh,
        problem.ground,
        scheme=problem.scheme,
        numerics=Numerics() if is_quadratic else Numerics(soft_stiffness=0.0),
        interface=make_interface(problem, mesh),
        gravity=problem.gravity,
    )
    if is_quadratic:
        return body
    is_soil = mesh.nodes[mesh.cell_nodes, 1].mean(axis=1) < 0.0
    points = four_points_per_cell(mesh, problem.ground, np.flatnonzero(is_soil))
    return body._replace(points=points)


def soil_mesh(problem: Penetration, *, is_quadratic: bool) -> BackgroundMesh:
    """Return the mesh of the soil, and of the headroom, beside and below the pile."""
    size = problem.size
    x = _joined(
        lines(0.0, problem.half_width, size), lines(problem.half_width, problem.width, size)
    )
    z = _joined(
        lines(-problem.depth, -problem.embedment, size), lines(-problem.embedment, 0.0, size)
    )
    if problem.headroom > 0.0:
        z = _joined(z, lines(0.0, problem.headroom, size))
    is_pile = np.logical_and.outer(x[1:] <= problem.half_width, z[:-1] >= -problem.embedment)
    return structured_mesh(x, z, is_pile, is_quadratic=is_quadratic)


def _joined(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    return np.concatenate([first, second[1:]])


def make_interface(
    problem: Penetration, mesh: BackgroundMesh
) -> tuple[InterfaceElements, InterfacePoints] | None:
    """Return the interface on the pile, or None without a law: two points on straight facets."""
    if problem.law is None:
        return None
    quadratic = soil_mesh(problem, is_quadratic=True)
    elements, parts = pile_elements(quadratic, problem.pile)
    if mesh.cell_nodes.shape[1] == 3:
        shape_values, weights = facet_rule(2, 2)
        elements = elements._replace(
            nodes=np.ascontiguousarray(elements.nodes[:, :2]),
            shape_values=shape_values,
            weights=weights,
        )
    return elements, initial_interface(elements, parts, mesh, problem.ground, problem.law)


def _advance(
    problem: Penetration, body: Body, done: float, advance_by: float
) -> tuple[Body, float, tuple[float, ...]]:
    """Return body, upward reaction in N and residuals after ``advance_by`` (m) from ``done``."""
    prescribed, on_pile = _supports(problem, body.mesh, advance_by)
    moved, result = advance(
        body,
        prescribed,
        motion=PileMotion(np.array([0.0, -advance_by])) if problem.law else AT_REST,
        move_mesh=lambda mesh: translate(
            mesh,
            done + advance_by,
            -problem.embedment,
            (-problem.depth, problem.headroom),
        ),
        name=f"penetration {done + advance_by:.4f} m",
    )
    residuals = tuple(result.equilibrium.newton.residuals)
    if problem.law is None:
        return moved, -float(result.equilibrium.reaction[on_pile, 1].sum()), residuals
    force = float(interfaces.reaction(result.interface)[1])
    followed = follow(
        moved.interface, moved.model.elements, moved.mesh, problem.ground, problem.law
    )
    return moved._replace(interface=followed), force, residuals


def _supports(
    problem: Penetration, mesh: BackgroundMesh, advance_by: float
) -> tuple[Prescribed, np.ndarray]:
    """Return supports, with the pile's motion where the soil sticks to it, and its nodes."""
    x, z = mesh.reference_nodes.T
    at_side = np.abs(x - problem.width) < ON_BOUNDARY
    on_pile = (x < problem.half_width + ON_BOUNDARY) & (z > -problem.embedment - ON_BOUNDARY)
    is_prescribed = np.zeros(mesh.nodes.shape, dtype=bool)
    is_prescribed[:, 0] = (np.abs(x) < ON_BOUNDARY) | at_side
    is_prescribed[at_side, 1] = problem.is_side_fixed
    is_prescribed[np.abs(z + problem.depth) < ON_BOUNDARY] = True
    displacement = np.zeros_like(mesh.nodes)
    if problem.law is None:
        is_prescribed[on_pile] = True
        displacement[on_pile, 1] = -advance_by
    return Prescribed(is_prescribed, displacement), on_pile


def work_and_energy(result: PenetrationResult, problem: Penetration) -> tuple[float, float]:
    """Return the work of the pile (trapezoidal rule) and the energy stored, in J per metre run."""
    depth, force = (np.append(0.0, x) for x in (result.penetration, result.reaction))
    work = float((np.diff(depth) * (force[1:] + force[:-1]) / 2.0).sum())
    points, E, nu = result.body.points, problem.youngs_modulus, problem.poissons_ratio
    strain = points.elastic_log_strain
    squared = np.einsum("pij,pij->p", strain, strain)
    trace = np.trace(strain, axis1=1, axis2=2)
    density = E / (1.0 + nu) / 2.0 * (squared + nu / (1.0 - 2.0 * nu) * trace**2)
    return work, float((density * points.volume / points.volume_ratio).sum())


def surface(points: MaterialPoints, problem: Penetration, width: float = 0.5) -> np.ndarray:
    """Return the highest point of each strip beside the pile, in m above the bottom."""
    x, z = points.position.T
    edges = np.arange(problem.half_width, problem.width - 1e-9, width)
    strips = [(x >= left) & (x < left + width) for left in edges]
    return np.array([z[strip].max() for strip in strips if strip.any()]) + problem.depth
