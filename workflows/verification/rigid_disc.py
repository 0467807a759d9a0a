"""Rigid disc on an elastic half space: vertical stiffness, smooth and bonded.

A part of 200 radii is modelled, on rollers at its side and fixed at its bottom, which makes it
stiffer by almost the ratio of radius to extent; the pressure at the edge of the disc is
singular, which makes the elements stiffer in proportion to their size there.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic
from install_mpm.conventions import Kinematics, Unit
from install_mpm.ground import Ground
from service_fe.problem import ServiceProblem, roller_supports
from service_fe.rigid_pile import held
from workflows.verification.problem import Outcome, Problem, Series, at_most, relative
from workflows.verification.references.discs import disc_stiffness
from workflows.verification.revolution import half_space_mesh

EXTENT = 200.0
"""Radius and depth of the modelled ground over the radius of the disc."""

SIZES = (0.1, 0.05, 0.025)
"""Edge length of the elements at the edge of the disc over its radius: a study of convergence."""

GROWTH = 0.2
"""Growth of the edge length per distance."""

TOLERANCE = 0.02


def vertical_stiffness(
    size_at_edge: float,
    *,
    is_bonded: bool,
    radius: float,
    shear_modulus: float,
    poissons_ratio: float,
    extent: float = EXTENT,
) -> tuple[float, tuple[float, ...]]:
    """Return the stiffness in N/m of a rigid disc, and the residuals of the step.

    Parameters
    ----------
    size_at_edge, extent
        Edge length of the elements at the disc's edge, and size of the ground, over the radius.
    is_bonded
        The ground sticks to the disc; or it slides freely.
    radius, shear_modulus, poissons_ratio
        Of the disc in m, of the ground in Pa; below 0.5.
    """
    mesh = half_space_mesh(radius, extent * radius, size_at_edge * radius, GROWTH)
    r, z = mesh.nodes.T
    under_disc = (np.abs(z) < 1e-9 * radius) & (r < (1.0 + 1e-9) * radius)
    is_fixed = roller_supports(mesh)
    is_fixed[under_disc, 1] = True
    is_fixed[under_disc, 0] |= is_bonded
    soil = HenckyElastic(2.0 * (1.0 + poissons_ratio) * shear_modulus, poissons_ratio)
    problem = ServiceProblem(
        mesh,
        Ground(0.0, 1.0, soil),
        CoulombInterface(1.0, 1.0),
        is_fixed=is_fixed,
        kinematics=Kinematics.AXISYMMETRIC,
    )
    settlement = 1e-3 * radius
    motion = np.zeros_like(mesh.nodes)
    motion[under_disc, 1] = -settlement
    step = problem.solve(problem.wished_in_place_state(), held(), support_motion=motion)
    return float(-step.support_reaction[under_disc, 1].sum() / settlement), step.residuals


def pd1(
    *,
    R: Annotated[float, Unit("m")] = 1.0,
    G: Annotated[float, Unit("Pa")] = 1e6,
    nu: float = 0.3,
) -> Outcome:
    """A rigid disc of radius R is pressed on an elastic half space: V = 4 G R / (1 - nu) smooth.

    Bonded, V = 4 G R ln(3 - 4 nu) / (1 - 2 nu).  The ground is a cylinder of 200 R by 200 R.
    """
    exact = disc_stiffness(radius=R, shear_modulus=G, poissons_ratio=nu)
    checks, series, histories = [], [], []
    for name, is_bonded, reference in (
        ("smooth", False, exact.vertical),
        ("bonded", True, exact.vertical_bonded),
    ):
        study = [
            vertical_stiffness(
                size, is_bonded=is_bonded, radius=R, shear_modulus=G, poissons_ratio=nu
            )
            for size in SIZES
        ]
        errors = [stiffness / reference - 1.0 for stiffness, _ in study]
        checks += [
            relative(f"V / G R, {name}", study[-1][0] / (G * R), reference / (G * R), TOLERANCE),
            at_most(f"{name}: error of the finest over that of the coarsest mesh",
                    abs(errors[-1] / errors[0]), 0.6),
        ]  # fmt: skip
        series.append(
            Series(
                f"{name} disc, error of the stiffness",
                "size at the edge of the disc / R",
                "relative error",
                SIZES,
                tuple(abs(error) for error in errors),
                is_logarithmic=True,
            )
        )
        histories += [residuals for _, residuals in study]
    return Outcome(tuple(checks), tuple(series), residual_histories=tuple(histories))


PROBLEM = Problem("PD1-V", "Rigid disc on a half space, vertical", pd1, is_quick=True)
