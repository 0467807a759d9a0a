"""Rough rigid strip footing on weightless clay, material point method: N_c = 2 + pi.

The same problem, mesh and result as ``strip_footing_fe``, through the step of the installation
stage: quadratic cells with element-mean dilatation, material points as carriers, finite strain.
The ground is stiff, so that the plateau is reached while the settlement is far below a cell, where
the theory of small deformation holds; the background mesh therefore stays where it is.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from handoff.fe_mesh import FEMesh
from install_mpm.background_mesh import BackgroundMesh, make_background_mesh
from install_mpm.constitutive.parameters import VonMises
from install_mpm.conventions import Unit
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import Ground
from install_mpm.options import Numerics
from service_fe.problem import roller_supports
from workflows.verification.body import advance, make_body
from workflows.verification.problem import Outcome, Problem
from workflows.verification.strip_footing_fe import SIZES, StripFootingResult, footing_mesh, outcome


def strip_footing(
    size_at_corner: float,
    *,
    size_far: float = 0.35,
    width: float = 1.0,
    undrained_shear_strength: float = 10e3,
    rigidity_index: float = 2e4,
    poissons_ratio: float = 0.49,
    settlement: float = 2e-3,
    steps: int = 32,
    numerics: Numerics | None = None,
) -> StripFootingResult:
    """Return the curve of a rough rigid footing, pushed by ``settlement * width`` in equal steps.

    Parameters are those of ``strip_footing_fe.strip_footing``, and ``numerics`` of the installation
    stage.

    Raises
    ------
    RuntimeError
        If a step does not converge.
    """
    numerics = numerics or Numerics(tolerance=1e-8)
    fe_mesh = footing_mesh(width, size_at_corner * width, size_far * width)
    mesh = make_background_mesh(fe_mesh.nodes, fe_mesh.cell_nodes)
    soil = VonMises(
        rigidity_index * undrained_shear_strength, poissons_ratio, undrained_shear_strength
    )
    body = make_body(mesh, Ground(0.0, 1.0, soil), numerics=numerics)
    prescribed, under_footing = _rough_footing(fe_mesh, mesh, width, settlement * width / steps)
    loads, histories = [], []
    for number in range(steps):
        body, result = advance(body, prescribed, name=f"strip footing, step {number + 1}")
        loads.append(-2.0 * result.equilibrium.reaction[under_footing, 1].sum())
        histories.append(tuple(result.equilibrium.newton.residuals))
    return StripFootingResult(
        settlement=settlement * np.arange(1, steps + 1) / steps,
        bearing_factor=np.array(loads) / (undrained_shear_strength * width),
        iterations=np.array([len(history) - 1 for history in histories]),
        residuals=tuple(histories),
        n_dofs=mesh.nodes.size,
    )


def _rough_footing(
    fe_mesh: FEMesh, mesh: BackgroundMesh, width: float, advance: float
) -> tuple[Prescribed, np.ndarray]:
    """Return supports and the motion of the footing in a step, and which nodes lie under it."""
    x, z = mesh.nodes.T
    under_footing = (np.abs(z) < 1e-9) & (x < 0.5 * width + 1e-9)
    is_prescribed = roller_supports(fe_mesh)
    is_prescribed[under_footing] = True
    displacement = np.zeros_like(mesh.nodes)
    displacement[under_footing, 1] = -advance
    return Prescribed(is_prescribed, displacement), under_footing


ROUND_OFF_OVER_STIFFNESS = 5e-14
"""Relative residual that is round-off, over E / su: the stiffer, the larger beside the strength."""

PLATEAU = 20.0
"""Settlement times E / (su B) at the end; the plateau begins near 10."""

LARGEST_SETTLEMENT = 0.4 * SIZES[-1]
"""Over the width: small beside the cells at the footing's edge, which stay where they are."""


def pb1(
    *,
    B: Annotated[float, Unit("m")] = 1.0,
    su: Annotated[float, Unit("Pa")] = 10e3,
    E_over_su: float = 2e4,
    nu: float = 0.49,
) -> Outcome:
    """A rough rigid strip of width B is pushed into weightless clay: (2 + pi) su B (Prandtl).

    The step of the installation stage; the settlement is 20 su B / E, which has to stay small
    beside the cells, so that the ground has to be stiff.
    """
    settlement = PLATEAU / E_over_su
    if settlement > LARGEST_SETTLEMENT:
        raise ValueError(f"E_over_su has to be at least {PLATEAU / LARGEST_SETTLEMENT:.0f}")
    results = [
        strip_footing(
            size,
            width=B,
            undrained_shear_strength=su,
            rigidity_index=E_over_su,
            poissons_ratio=nu,
            settlement=settlement,
        )
        for size in SIZES
    ]
    return outcome(results, ROUND_OFF_OVER_STIFFNESS * E_over_su)


PROBLEM = Problem("PB1", "Strip footing on clay, material point method", pb1, is_quick=True)
