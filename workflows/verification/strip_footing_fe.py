"""Rough rigid strip footing on weightless clay, finite elements: N_c = 2 + pi.

Prandtl's solution for a footing of width B on a von Mises (in plane strain: Tresca) half space with
shear strength s_u: the load tends to (2 + pi) s_u B.  Finite elements approach it from above, with
an error of first order in the size of the elements at the footing's edge, because the singular
corner cannot be represented.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from handoff.fe_mesh import FacetTag, FEMesh
from handoff.gmsh_triangles import triangulate
from install_mpm.constitutive.parameters import CoulombInterface, Tresca, VonMises
from install_mpm.conventions import Unit
from install_mpm.ground import Ground
from install_mpm.newton import ROUND_OFF
from service_fe.options import ServiceNumerics
from service_fe.problem import ServiceProblem, roller_supports
from service_fe.rigid_pile import held
from service_fe.step import Step
from workflows.verification.footing_curve import (
    FootingCurve,
    curve_on_finest_mesh,
    error_over_size,
)
from workflows.verification.problem import Outcome, Problem, at_least, at_most, relative
from workflows.verification.revolution import quadratic

EXACT = 2.0 + np.pi


@dataclass(frozen=True)
class StripFootingResult(FootingCurve):
    """Load-settlement curve of the strip, and what it has taken."""

    iterations: np.ndarray
    """Newton iterations (step,)."""
    n_dofs: int

    @property
    def error(self) -> float:
        """Relative error of the plateau against Prandtl."""
        return self.plateau / EXACT - 1.0


def strip_footing(
    size_at_corner: float,
    *,
    size_far: float = 0.35,
    width: float = 1.0,
    undrained_shear_strength: float = 10e3,
    rigidity_index: float = 1000.0,
    poissons_ratio: float = 0.49,
    relative_settlement: float = 40.0,
    steps: int = 32,
    law: type[VonMises | Tresca] = VonMises,
) -> StripFootingResult:
    """Return the curve of a rough rigid footing that is pushed down in equal steps.

    Parameters
    ----------
    size_at_corner, size_far
        Edge length of the elements at the footing's edge and far away, over the footing's width.
    width
        Width of the footing in m.
    undrained_shear_strength
        Shear strength in Pa.
    rigidity_index
        Young's modulus E over shear strength s_u; it only scales the settlement.
    poissons_ratio
        Below 0.5.
    relative_settlement, steps
        Final settlement times E / (s_u width), and number of steps; the plateau begins near 10.
    law
        Either has the same strength in plane strain.
    """
    settlement = relative_settlement / rigidity_index
    mesh = footing_mesh(width, size_at_corner * width, size_far * width)
    soil = law(rigidity_index * undrained_shear_strength, poissons_ratio, undrained_shear_strength)
    under_footing = (np.abs(mesh.nodes[:, 1]) < 1e-9) & (mesh.nodes[:, 0] < 0.5 * width + 1e-9)
    is_fixed = roller_supports(mesh)
    is_fixed[under_footing] = True
    problem = ServiceProblem(
        mesh,
        Ground(0.0, 1.0, soil),
        CoulombInterface(1.0, 1.0),
        numerics=ServiceNumerics(max_iterations=30),
        is_fixed=is_fixed,
    )
    motion = np.zeros_like(mesh.nodes)
    motion[under_footing, 1] = -settlement * width / steps
    state, accepted = problem.wished_in_place_state(), list[Step]()
    for _ in range(steps):
        guess = accepted[-1].increment if accepted else None
        accepted.append(problem.solve(state, held(), support_motion=motion, guess=guess))
        state = accepted[-1].state
    loads = [-2.0 * step.support_reaction[under_footing, 1].sum() for step in accepted]
    return StripFootingResult(
        settlement=settlement * np.arange(1, steps + 1) / steps,
        bearing_factor=np.array(loads) / (undrained_shear_strength * width),
        iterations=np.array([step.iterations for step in accepted]),
        residuals=tuple(step.residuals for step in accepted),
        n_dofs=2 * len(mesh.nodes),
    )


def footing_mesh(
    width: float,
    size_at_corner: float,
    size_far: float,
    *,
    side: float = 2.5,
    depth: float = 2.0,
    growth: float | None = None,
) -> FEMesh:
    """Return the mesh of the right half, graded to the footing's edge.

    Parameters
    ----------
    width, size_at_corner, size_far
        Width of the footing and edge lengths in m.
    side, depth
        Size of the half over the width of the footing.
    growth
        Growth of the edge length with the distance from the footing's edge; the default reaches
        ``size_far`` two widths away.
    """
    edge, side, depth = 0.5 * width, side * width, depth * width
    growth = (size_far - size_at_corner) / (2.0 * width) if growth is None else growth
    outline = np.array([(0.0, -depth), (side, -depth), (side, 0.0), (edge, 0.0), (0.0, 0.0)])
    vertices, triangles = triangulate(
        outline, lambda x, z: min(size_far, size_at_corner + growth * float(np.hypot(x - edge, z)))
    )
    nodes, cell_nodes, facet_nodes = quadratic(vertices, triangles)
    x, z = nodes[facet_nodes[:, 2]].T
    tags = np.full(len(x), int(FacetTag.SURFACE))
    tags[np.abs(z + depth) < 1e-9 * width] = FacetTag.BOTTOM
    tags[np.abs(x - side) < 1e-9 * width] = FacetTag.SIDE
    tags[np.abs(x) < 1e-9 * width] = FacetTag.SYMMETRY
    return FEMesh(nodes, cell_nodes, facet_nodes, tags)


SIZES = (0.05, 0.025, 0.0125)
"""Edge length of the elements at the footing's edge over its width: a study of convergence."""

TOLERANCE = 0.02


def outcome(results: Sequence[StripFootingResult], round_off: float = ROUND_OFF) -> Outcome:
    """Return the outcome of footings on meshes of ``SIZES``."""
    coarse, fine = results[0], results[-1]
    falls = abs(fine.error / coarse.error)
    return Outcome(
        checks=(
            relative("N_c on the finest mesh", fine.plateau, EXACT, TOLERANCE),
            at_least("N_c approached from above: finest mesh", fine.plateau, EXACT),
            at_most("error of the finest over that of the coarsest mesh", falls, 0.6),
            at_most("change of load over the last quarter", abs(fine.slope), 1e-3),
        ),
        series=(
            curve_on_finest_mesh(
                "finest mesh", fine, EXACT, width="B", factor="mean pressure / su"
            ),
            error_over_size("error of N_c", results, EXACT, SIZES, width="B"),
        ),
        residual_histories=tuple(history for result in results for history in result.residuals),
        round_off=round_off,
    )


def pb1_fe(
    *,
    B: Annotated[float, Unit("m")] = 1.0,
    su: Annotated[float, Unit("Pa")] = 10e3,
    E_over_su: float = 1000.0,
    nu: float = 0.49,
) -> Outcome:
    """A rough rigid strip of width B is pushed into weightless clay: (2 + pi) su B (Prandtl).

    The finite elements of the service stage; the settlement is 40 su B / E.
    """
    return _outcome_of(VonMises, B, su, E_over_su, nu)


def pb1_fe_tresca(
    *,
    B: Annotated[float, Unit("m")] = 1.0,
    su: Annotated[float, Unit("Pa")] = 10e3,
    E_over_su: float = 1000.0,
    nu: float = 0.49,
) -> Outcome:
    """A rough rigid strip of width B is pushed into weightless Tresca soil; see ``pb1_fe``."""
    return _outcome_of(Tresca, B, su, E_over_su, nu)


def _outcome_of(
    law: type[VonMises | Tresca], width: float, strength: float, rigidity_index: float, nu: float
) -> Outcome:
    return outcome(
        [
            strip_footing(
                size,
                width=width,
                undrained_shear_strength=strength,
                rigidity_index=rigidity_index,
                poissons_ratio=nu,
                law=law,
            )
            for size in SIZES
        ]
    )


PROBLEMS = (
    Problem("PB1-FE", "Strip footing on clay, finite elements", pb1_fe, is_quick=False),
    Problem(
        "PB1-FE-TRESCA",
        "Strip footing on Tresca soil, finite elements",
        pb1_fe_tresca,
        is_quick=False,
    ),
)
