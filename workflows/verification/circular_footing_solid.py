"""PB2 in space: a rough circular footing on weightless clay, 6.048 s_u, from a quarter of it.

The ground is stiff, so that the plateau is reached while the settlement is far below a cell; the
background mesh therefore stays where it is.  Cells are graded towards the edge of the footing,
where slip lines start; the load falls towards the exact one as they are refined.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.constitutive.parameters import Tresca
from install_mpm.conventions import Unit
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import Ground
from install_mpm.options import Numerics
from workflows.verification.body import advance, make_body
from workflows.verification.problem import Outcome, Problem, Series, at_least, relative
from workflows.verification.references.circular_footing import circular_footing_pressure
from workflows.verification.solid_meshes import extruded, quadratic_mesh, sector

EXTENT = 4.0
"""Radius and depth of the ground over the radius of the footing."""
STEPS = 20
RELATIVE_SETTLEMENT = 60.0
"""Settlement over R at the end, times E over su; the plateau begins at about half of that."""
ROUND_OFF = 5e-9
COARSE, FINE = 1.0, 1.7
"""Cells in radius and depth over those of the coarse mesh."""
SECTORS = 4
"""Sides of a quarter of the footing."""


class Loading(NamedTuple):
    """Curve of a footing, (STEPS,)."""

    settlement: np.ndarray
    """Over the radius."""
    factor: np.ndarray
    """Mean pressure over su."""
    residuals: tuple[tuple[float, ...], ...]


def circular_footing(
    *,
    R: Annotated[float, Unit("m")] = 1.0,
    su: Annotated[float, Unit("Pa")] = 10e3,
    E_over_su: float = 2e4,
    nu: float = 0.49,
) -> Outcome:
    """Return the bearing capacity factor of a rough footing on two meshes."""
    soil = Tresca(E_over_su * su, nu, su)
    exact = circular_footing_pressure(undrained_shear_strength=su, is_rough=True) / su
    coarse, fine = (press(R, soil, fineness) for fineness in (COARSE, FINE))
    excess = [loading.factor[-1] / exact - 1.0 for loading in (coarse, fine)]
    curve = Series(
        "Rough circular footing", "settlement over radius times E over su",
        "mean pressure over su", tuple(fine.settlement * E_over_su), tuple(fine.factor),
        (exact,) * STEPS,
    )  # fmt: skip
    return Outcome(
        (
            relative("mean pressure over su, fine mesh", fine.factor[-1], exact, 0.05),
            at_least("excess of the coarse mesh over that of the fine one", excess[0] / excess[1],
                     1.3),
        ),
        (curve,),
        (f"excess of the coarse mesh {excess[0]:.1%}, of the fine one {excess[1]:.1%}",),
        coarse.residuals + fine.residuals,
        ROUND_OFF,
    )  # fmt: skip


def press(radius: float, soil: Tresca, fineness: float) -> Loading:
    """Return the curve of a footing of ``radius`` in m on a mesh of ``fineness``."""
    mesh = quarter_mesh(radius, fineness)
    body = make_body(mesh, Ground(0.0, 1.0, soil), numerics=Numerics(tolerance=1e-7))
    is_prescribed, under = _supports(mesh, radius)
    ratio = RELATIVE_SETTLEMENT * soil.undrained_shear_strength / soil.youngs_modulus
    motion = np.zeros_like(mesh.nodes)
    motion[under, 2] = -ratio * radius / STEPS
    area = 0.5 * SECTORS * np.sin(0.5 * np.pi / SECTORS) * radius**2  # of the polygon
    factors, residuals = [], []
    for number in range(STEPS):
        body, result = advance(
            body, Prescribed(is_prescribed, motion), name=f"circular footing, step {number + 1}"
        )
        load = -result.equilibrium.reaction[under, 2].sum()
        factors.append(load / area / soil.undrained_shear_strength)
        residuals.append(tuple(result.equilibrium.newton.residuals))
    settlement = ratio * np.arange(1, STEPS + 1) / STEPS
    return Loading(settlement, np.array(factors), tuple(residuals))


def quarter_mesh(radius: float, fineness: float) -> BackgroundMesh:
    """Return a quarter of the ground, with ``fineness`` times the cells in radius and depth."""
    radii = _refined(np.array([0.0, 0.6, 0.9, 1.0, 1.1, 1.4, 2.2, EXTENT]), fineness)
    depths = _refined(np.array([0.0, 0.1, 0.35, 0.8, 1.8, EXTENT]), fineness)
    angles = np.linspace(0.0, 0.5 * np.pi, SECTORS + 1)
    return quadratic_mesh(extruded(sector(radius * radii, angles), -radius * depths[::-1]))


def _refined(lines: np.ndarray, fineness: float) -> np.ndarray:
    """Return ``fineness`` times as many intervals between ``lines``; the edge at 1 stays a line."""
    places = np.arange(len(lines))
    edge = int(np.argmin(np.abs(lines - 1.0)))
    inside, outside = round(fineness * edge), round(fineness * (places[-1] - edge))
    wanted = np.append(
        np.linspace(0.0, edge, inside + 1), np.linspace(edge, places[-1], outside + 1)[1:]
    )
    finer: np.ndarray = np.interp(wanted, places, lines)
    return finer


def _supports(mesh: BackgroundMesh, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Return which dofs are given (n_nodes, 3), and the nodes (n_nodes,) under the footing."""
    x, y, z = mesh.nodes.T
    slack = 1e-9 * radius
    distance = np.hypot(x, y)
    is_prescribed = np.column_stack([x < slack, y < slack, np.zeros(len(x), dtype=bool)])
    is_wall = distance > 0.95 * EXTENT * radius  # the middle of a side is nearer than its ends
    is_prescribed[(z < -EXTENT * radius + slack) | is_wall] = True
    under = (z > -slack) & (distance < radius + slack)
    is_prescribed[under] = True
    return is_prescribed, under


PROBLEM = Problem(
    "PB2-3D", "Rough circular footing on Tresca soil, in space", circular_footing, is_quick=False
)
