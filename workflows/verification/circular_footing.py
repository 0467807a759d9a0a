"""Rigid circular footing on weightless clay, finite elements: 5.689 s_u smooth, 6.048 s_u rough.

The exact mean pressure on Tresca soil comes from ``references.circular_footing``.  Von Mises soil,
whose strength in the other modes is not the one in simple shear, has no such solution.  As under
the strip, finite elements approach the limit load from above with an error of first order in the
size of the elements at the singular edge.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Annotated

import numpy as np

from handoff.fe_mesh import FEMesh
from install_mpm.constitutive.parameters import CoulombInterface, Tresca
from install_mpm.conventions import Kinematics, Unit
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
from workflows.verification.problem import (
    Check,
    Outcome,
    Problem,
    Series,
    at_least,
    at_most,
    relative,
)
from workflows.verification.references.circular_footing import circular_footing_pressure
from workflows.verification.strip_footing_fe import footing_mesh

SIZES = (0.05, 0.025, 0.0125)
"""Edge length of the elements at the footing's edge over its diameter: a study of convergence."""

SIZE_FAR = 0.35
"""Edge length far away, over the diameter."""

TOLERANCE = 0.03
RELATIVE_SETTLEMENT = 40.0
"""Final settlement times E / (2 s_u R); the plateau begins near 20."""


def circular_footing(
    size_at_edge: float,
    *,
    is_rough: bool,
    radius: float = 1.0,
    undrained_shear_strength: float = 10e3,
    rigidity_index: float = 1000.0,
    poissons_ratio: float = 0.49,
    steps: int = 24,
) -> FootingCurve:
    """Return the curve of a rigid footing that is pushed down in equal steps.

    Parameters
    ----------
    size_at_edge
        Edge length of the elements at the footing's edge over its diameter.
    is_rough
        The soil sticks to the footing; or it slides freely.
    radius
        Of the footing in m.
    undrained_shear_strength
        Shear strength in Pa.
    rigidity_index
        Young's modulus E over shear strength s_u; it only scales the settlement.
    poissons_ratio
        Below 0.5.
    steps
        Number of steps to ``RELATIVE_SETTLEMENT``.
    """
    diameter, strength = 2.0 * radius, undrained_shear_strength
    mesh = footing_mesh(diameter, size_at_edge * diameter, SIZE_FAR * diameter)
    is_fixed, under_footing = footing_supports(mesh, radius, is_rough=is_rough)
    problem = ServiceProblem(
        mesh,
        Ground(0.0, 1.0, Tresca(rigidity_index * strength, poissons_ratio, strength)),
        CoulombInterface(1.0, 1.0),
        numerics=ServiceNumerics(max_iterations=30),
        is_fixed=is_fixed,
        kinematics=Kinematics.AXISYMMETRIC,
    )
    settlement = RELATIVE_SETTLEMENT / rigidity_index
    motion = np.zeros_like(mesh.nodes)
    motion[under_footing, 1] = -settlement * diameter / steps
    state, accepted = problem.wished_in_place_state(), list[Step]()
    for _ in range(steps):
        guess = accepted[-1].increment if accepted else None
        accepted.append(problem.solve(state, held(), support_motion=motion, guess=guess))
        state = accepted[-1].state
    loads = np.array([-step.support_reaction[under_footing, 1].sum() for step in accepted])
    return FootingCurve(
        settlement=settlement * np.arange(1, steps + 1) / steps,
        bearing_factor=loads / (np.pi * radius**2 * strength),
        residuals=tuple(step.residuals for step in accepted),
    )


def footing_supports(
    mesh: FEMesh, radius: float, *, is_rough: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Return the supports (node, 2) bool of ground and footing, and the nodes under the footing."""
    r, z = mesh.nodes.T
    under_footing = (np.abs(z) < 1e-9 * radius) & (r < (1.0 + 1e-9) * radius)
    is_fixed = roller_supports(mesh)
    is_fixed[under_footing, 1] = True
    is_fixed[under_footing, 0] |= is_rough
    return is_fixed, under_footing


def pb2_fe(
    *,
    R: Annotated[float, Unit("m")] = 1.0,
    su: Annotated[float, Unit("Pa")] = 10e3,
    E_over_su: float = 1000.0,
    nu: float = 0.49,
) -> Outcome:
    """Smooth and rough rigid footings of radius R are pushed into weightless Tresca soil.

    The finite elements of the service stage; the settlement is 80 su R / E.
    """
    footing = partial(
        circular_footing,
        radius=R,
        undrained_shear_strength=su,
        rigidity_index=E_over_su,
        poissons_ratio=nu,
    )
    return outcome(footing, su)


def outcome(
    footing: Callable[..., FootingCurve],
    undrained_shear_strength: float,
    round_off: float = ROUND_OFF,
) -> Outcome:
    """Return the outcome of smooth and rough footings ``footing(size, is_rough=...)``."""
    checks: list[Check] = []
    series: list[Series] = []
    histories: list[tuple[float, ...]] = []
    for name, is_rough in (("smooth", False), ("rough", True)):
        exact = (
            circular_footing_pressure(
                undrained_shear_strength=undrained_shear_strength, is_rough=is_rough
            )
            / undrained_shear_strength
        )
        results = [footing(size, is_rough=is_rough) for size in SIZES]
        checks += _checks(name, results, exact)
        series += _series(name, results, exact)
        histories += [history for result in results for history in result.residuals]
    return Outcome(
        tuple(checks), tuple(series), residual_histories=tuple(histories), round_off=round_off
    )


def _checks(name: str, results: list[FootingCurve], exact: float) -> list[Check]:
    coarse, fine = results[0], results[-1]
    falls = abs((fine.plateau - exact) / (coarse.plateau - exact))
    return [
        relative(f"{name}: mean pressure / su on the finest mesh", fine.plateau, exact, TOLERANCE),
        at_least(f"{name}: approached from above, finest mesh", fine.plateau, exact),
        at_most(f"{name}: error of the finest over that of the coarsest mesh", falls, 0.6),
        at_most(f"{name}: change of load over the last quarter", abs(fine.slope), 1e-3),
    ]


def _series(name: str, results: list[FootingCurve], exact: float) -> list[Series]:
    return [
        curve_on_finest_mesh(
            f"{name} footing, finest mesh", results[-1], exact, width="2R",
            factor="mean pressure / su",
        ),
        error_over_size(
            f"{name} footing, error of the bearing factor", results, exact, SIZES, width="2R"
        ),
    ]  # fmt: skip


PROBLEM = Problem(
    "PB2-FE",
    "Smooth and rough circular footing on Tresca soil, finite elements",
    pb2_fe,
    is_quick=False,
)
