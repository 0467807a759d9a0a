"""Rigid circular footing on weightless clay, material point method: 5.689 s_u and 6.048 s_u.

The same problem, meshes and result as ``circular_footing``, through the step of the installation
stage with axisymmetric kinematics.  The ground is stiff, so that the plateau is reached while the
settlement is far below a cell; the background mesh therefore stays where it is.
"""

from __future__ import annotations

from functools import partial
from typing import Annotated

import numpy as np

from install_mpm.background_mesh import make_background_mesh
from install_mpm.constitutive.parameters import Tresca
from install_mpm.conventions import Kinematics, Unit
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import Ground
from install_mpm.options import Numerics
from workflows.verification.body import advance, make_body
from workflows.verification.circular_footing import (
    RELATIVE_SETTLEMENT,
    SIZE_FAR,
    footing_supports,
    outcome,
)
from workflows.verification.footing_curve import FootingCurve
from workflows.verification.problem import Outcome, Problem
from workflows.verification.strip_footing_fe import footing_mesh

ROUND_OFF = 5e-9
"""Relative residual that further iterations do not lower, at the rigidity index of 20,000: 1e-9 in
late steps, 4e-9 in the first."""


def circular_footing(
    size_at_edge: float,
    *,
    is_rough: bool,
    radius: float = 1.0,
    undrained_shear_strength: float = 10e3,
    rigidity_index: float = 2e4,
    poissons_ratio: float = 0.49,
    steps: int = 48,
) -> FootingCurve:
    """Return the curve of a rigid footing; parameters are those of ``circular_footing``.

    Raises
    ------
    ProblemNotSolvedError
        If a step does not converge.
    """
    diameter, strength = 2.0 * radius, undrained_shear_strength
    fe_mesh = footing_mesh(diameter, size_at_edge * diameter, SIZE_FAR * diameter)
    mesh = make_background_mesh(fe_mesh.nodes, fe_mesh.cell_nodes)
    body = make_body(
        mesh,
        Ground(0.0, 1.0, Tresca(rigidity_index * strength, poissons_ratio, strength)),
        kinematics=Kinematics.AXISYMMETRIC,
        numerics=Numerics(tolerance=1e-8),
    )
    is_prescribed, under_footing = footing_supports(fe_mesh, radius, is_rough=is_rough)
    settlement = RELATIVE_SETTLEMENT / rigidity_index
    motion = np.zeros_like(mesh.nodes)
    motion[under_footing, 1] = -settlement * diameter / steps
    prescribed = Prescribed(is_prescribed, motion)
    loads, histories = [], []
    for number in range(steps):
        body, result = advance(body, prescribed, name=f"circular footing, step {number + 1}")
        loads.append(-result.equilibrium.reaction[under_footing, 1].sum())
        histories.append(tuple(result.equilibrium.newton.residuals))
    return FootingCurve(
        settlement=settlement * np.arange(1, steps + 1) / steps,
        bearing_factor=np.array(loads) / (np.pi * radius**2 * strength),
        residuals=tuple(histories),
    )


def pb2_mpm(
    *,
    R: Annotated[float, Unit("m")] = 1.0,
    su: Annotated[float, Unit("Pa")] = 10e3,
    E_over_su: float = 2e4,
    nu: float = 0.49,
) -> Outcome:
    """Smooth and rough rigid footings of radius R are pushed into weightless Tresca soil.

    The material point method of the installation stage; the settlement is 80 su R / E.
    """
    footing = partial(
        circular_footing,
        radius=R,
        undrained_shear_strength=su,
        rigidity_index=E_over_su,
        poissons_ratio=nu,
    )
    return outcome(footing, su, ROUND_OFF)


PROBLEM = Problem(
    "PB2",
    "Smooth and rough circular footing on Tresca soil, material points",
    pb2_mpm,
    is_quick=False,
)
