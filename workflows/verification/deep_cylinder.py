"""PB6: a rigid cylinder moves through clay without weight, plane strain, far from any surface.

The soil is stiff, so that the plateau is reached while the displacement is far below a cell, where
the theory of small deformation holds.  A quarter of the section is enough: the motion is even
across the plane of motion and odd across the other.  Soil and cylinder do not part.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.conventions import Unit
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import Ground
from install_mpm.interface import reaction
from install_mpm.options import Numerics
from install_mpm.pile import PileMotion
from workflows.verification.body import Body, advance, make_body
from workflows.verification.polar_mesh import polar_mesh
from workflows.verification.problem import Check, Outcome, Problem, Series, at_most, relative
from workflows.verification.references.bearing_capacity import deep_cylinder_factor
from workflows.verification.rigid_facets import facet_elements, facet_points, rigid_interface

ROUND_OFF, TOLERANCE = 1e-9, 1e-8
"""Relative residuals: the soil is very stiff beside its strength."""

SPRING = 10.0
"""Stiffness of the interface times radius over Young's modulus: rigid beside the soil."""

SYMMETRY = 4.0
"""Whole cylinder over modelled quarter."""

FLAT = 2e-3
"""Largest relative change of the resistance over the last fifth of the curve."""


def deep_cylinder(
    *,
    alpha_1: float = 0.0,
    alpha_2: float = 0.5,
    alpha_3: float = 1.0,
    R: Annotated[float, Unit("m")] = 1.0,
    su: Annotated[float, Unit("Pa")] = 10e3,
    E_over_su: float = 2e4,
    nu: float = 0.49,
    displacement: float = 30.0,
    outer_ratio: float = 8.0,
    size: float = 0.1,
    steps: int = 15,
) -> Outcome:
    """Return the resistance over s_u and diameter for three values of adhesion over s_u.

    ``displacement`` is that times E / (s_u R); ``size`` of the cells is over their radius.
    """
    checks = list[Check]()
    series, histories = list[Series](), list[tuple[float, ...]]()
    reached = displacement * np.arange(1, steps + 1) / steps
    for alpha in (alpha_1, alpha_2, alpha_3):
        soil = VonMises(E_over_su * su, nu, su)
        body, is_held = _soil_around_cylinder(R, outer_ratio, size, soil, alpha)
        motion = PileMotion(np.array([0.0, displacement / E_over_su * R / steps]))
        factors = []
        for _ in range(steps):
            held = Prescribed(is_held, np.zeros_like(body.mesh.nodes))
            body, result = advance(body, held, motion=motion, name=f"cylinder, alpha {alpha:g}")
            force = -SYMMETRY * float(reaction(body.interface)[1])
            factors.append(force / (2.0 * R * su))
            histories.append(tuple(result.equilibrium.newton.residuals))
        exact = deep_cylinder_factor(adhesion=alpha)
        flatness = factors[-1] / factors[-1 - steps // 5] - 1.0
        checks += [
            relative(f"resistance / (su D), alpha = {alpha:g}", factors[-1], exact, 0.03),
            at_most(f"its change over the last fifth, alpha = {alpha:g}", flatness, FLAT),
        ]
        series.append(curve(alpha, reached, factors, exact))
    return Outcome(
        tuple(checks), tuple(series), residual_histories=tuple(histories), round_off=ROUND_OFF
    )


def polar_lines(radius: float, outer_ratio: float, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Return radii (m) and angles (rad) of a quarter; ``size`` of the cells is over the radius."""
    n_rings, n_facets = round(np.log(outer_ratio) / np.log1p(size)), round(0.5 * np.pi / size)
    radii = np.geomspace(radius, outer_ratio * radius, n_rings + 1)
    return radii, np.linspace(0.0, 0.5 * np.pi, n_facets + 1)


def curve(alpha: float, reached: np.ndarray, factors: list[float], exact: float) -> Series:
    """Return the resistance over the displacement ``reached``, beside the exact one."""
    return Series(
        title=f"Resistance of a deep cylinder, alpha = {alpha:g}",
        abscissa="displacement E / (su R) (-)",
        ordinate="resistance / (su D) (-)",
        x=tuple(reached),
        computed=tuple(factors),
        reference=(exact,) * len(factors),
    )


def _soil_around_cylinder(
    radius: float, outer_ratio: float, size: float, soil: VonMises, alpha: float
) -> tuple[Body, np.ndarray]:
    """Return a quarter of the soil around the cylinder, and which dofs are held."""
    radii, angles = polar_lines(radius, outer_ratio, size)
    mesh, polar = polar_mesh(radii, angles)
    elements = facet_elements(mesh, polar[:, 0] == radius)
    position = facet_points(elements, mesh)
    normal = -position / np.linalg.norm(position, axis=1)[:, None]
    area = np.tile(elements.weights, len(elements.nodes)) * angles[1] * radius
    stiffness = SPRING * soil.youngs_modulus / radius
    law = CoulombInterface(stiffness, stiffness, adhesion_factor=alpha)
    body = make_body(
        mesh,
        Ground(0.0, 1.0, soil),
        numerics=Numerics(tolerance=TOLERANCE),
        is_soil=np.ones(len(mesh.cell_nodes), dtype=bool),
        interface=(
            elements,
            rigid_interface(position, normal, area, law, soil.undrained_shear_strength),
        ),
    )
    is_held = np.zeros(mesh.nodes.shape, dtype=bool)
    is_held[:, 0] = (mesh.nodes == 0.0).any(axis=1)
    is_held[polar[:, 0] == polar[:, 0].max()] = True
    return body, is_held


PROBLEM = Problem("PB6", "Deep cylinder in clay", deep_cylinder, is_quick=False)
