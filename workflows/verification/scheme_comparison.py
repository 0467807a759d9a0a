"""SCHEMES: the stress error of every discretisation that a case can choose, on two problems.

A column under its own weight, whose mesh is stretched to its height so that points cross cells
inside it; and level ground at rest while the mesh moves through it by eqs (1)-(2), so that its
surface cuts cells.  Cells have the same size and twelve points each.  In the column the error of
the default has to be the smallest; in the ground, where the cut cells at the surface decide, it is
not, and nothing is claimed.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.constitutive.parameters import HenckyElastic
from install_mpm.conventions import Unit
from install_mpm.discretisation import Scheme
from install_mpm.equilibrium import Prescribed
from install_mpm.geostatic import geostatic_gradient
from install_mpm.ground import Ground, geostatic_stress
from install_mpm.material_points import cauchy_stress
from install_mpm.mesh_motion import stretch, translate
from install_mpm.options import Numerics
from workflows.verification.body import Body, advance, make_body
from workflows.verification.gravity import load_gravity, mesh_to, with_weight_of_points
from workflows.verification.problem import Outcome, Problem, at_most
from workflows.verification.rectangle import rectangle_mesh
from workflows.verification.references.column import column

POINT_QUADRATURE = Numerics(volumetric_term=0.0, soft_stiffness=0.0)


class Choice(NamedTuple):
    """A discretisation as ``[discretisation]`` of a case names it."""

    name: str
    scheme: Scheme = Scheme.CARRIERS
    is_quadratic: bool = True
    is_cell_weighted: bool = False

    @property
    def numerics(self) -> Numerics:
        """Numerical parameters; points as quadrature have no soft stiffness, as in the paper."""
        return Numerics() if self.scheme == Scheme.CARRIERS else POINT_QUADRATURE


DEFAULT = Choice("carriers, tri6")
CHOICES = (
    DEFAULT,
    Choice("carriers, tri3", is_quadratic=False),
    Choice("quadrature, tri6", Scheme.QUADRATURE),
    Choice("quadrature, tri3", Scheme.QUADRATURE, is_quadratic=False),
    Choice("quadrature, tri3, weighted", Scheme.QUADRATURE, False, True),
)

Length = Annotated[float, Unit("m")]
Modulus = Annotated[float, Unit("Pa")]
UnitWeight = Annotated[float, Unit("N/m^3")]


def schemes(
    *,
    E: Modulus = 10e3,
    L0: Length = 50.0,
    gamma: UnitWeight = 400.0,
    rows: int = 16,
    steps: int = 20,
    E_ground: Modulus = 10e6,
    K0: float = 0.5,
    gamma_ground: UnitWeight = 18e3,
) -> Outcome:
    """Return the stress error of every scheme in the column and in the ground.

    The column has height L0, modulus E and unit weight gamma; the ground K0 and its own modulus.
    """
    soil = HenckyElastic(E, 0.0)
    ground = Ground(gamma_ground, K0, HenckyElastic(E_ground, 0.3))
    of_column, of_ground = {}, {}
    residuals: list[tuple[float, ...]] = []
    for choice in CHOICES:
        of_column[choice.name], own = _column_error(choice, soil, L0, gamma, rows, steps)
        of_ground[choice.name], others = _ground_error(choice, ground)
        residuals += own + others
    remarks = tuple(
        f"{text}: " + ", ".join(f"{name} {error:.1e}" for name, error in errors.items())
        for text, errors in (
            ("column, mean stress error of the points over gamma L0", of_column),
            (
                "ground at rest, largest error over gamma times depth (not claimed)",
                of_ground,
            ),
        )
    )
    checks = (
        at_most("column: stress error of the default", of_column[DEFAULT.name], 0.25 / rows),
        *(
            at_most(f"column: error of the default over that of {name}",
                    of_column[DEFAULT.name] / error, 1.0)
            for name, error in of_column.items()
            if name != DEFAULT.name
        ),
    )  # fmt: skip
    return Outcome(checks, remarks=remarks, residual_histories=tuple(residuals))


def _body(choice: Choice, x: np.ndarray, z: np.ndarray, ground: Ground) -> Body:
    """Return the ground below z = 0, or all of the mesh if it is weightless."""
    mesh = rectangle_mesh(x, z, is_crossed=True, is_quadratic=choice.is_quadratic)
    height = mesh.nodes[mesh.cell_nodes[:, :3], 1].mean(axis=1)
    is_soil = np.ones(len(height), dtype=bool) if ground.unit_weight == 0.0 else height < 0.0
    return make_body(
        mesh, ground, scheme=choice.scheme, is_cell_weighted=choice.is_cell_weighted,
        numerics=choice.numerics, is_soil=is_soil,
    )  # fmt: skip


def _rollers(body: Body, bottom: float, width: float) -> Prescribed:
    """Return rollers at both sides and at the bottom."""
    x, z = body.mesh.nodes.T
    slack = 1e-9 * width
    held = np.column_stack([(x < slack) | (x > width - slack), z < bottom + slack])
    return Prescribed(held, np.zeros_like(body.mesh.nodes))


def _column_error(
    choice: Choice, soil: HenckyElastic, height: float, unit_weight: float, rows: int, steps: int
) -> tuple[float, list[tuple[float, ...]]]:
    """Return the volume mean of the error of the vertical stress over unit weight times height.

    And the residuals of each step.
    """
    width = height / rows
    body = _body(
        choice, np.array([0.0, width]), np.linspace(0.0, height, rows + 1), Ground(0.0, 1.0, soil)
    )
    if choice.scheme == Scheme.CARRIERS:
        body = with_weight_of_points(body)
    prescribed = _rollers(body, 0.0, width)
    top = body.mesh.reference_nodes[:, 1] > (1.0 - 1e-9) * height
    residuals: list[tuple[float, ...]] = []
    for shares in pairwise(np.linspace(0.0, 1.0, steps + 1)):
        ground = Ground(unit_weight * shares[1], 1e-9, soil)
        body = body._replace(gradient=geostatic_gradient(ground, vertical=1))
        body, result, own = load_gravity(body, unit_weight, shares, prescribed, name=choice.name)
        residuals += own
        level = (body.mesh.nodes + result.equilibrium.displacement)[top, 1].mean()
        body = mesh_to(body, stretch(body.mesh, (1.0, float(level) / height)))
    points = body.points
    exact = column(
        points.position[:, 1] - points.displacement[:, 1],
        length=height, youngs_modulus=soil.youngs_modulus, poissons_ratio=soil.poissons_ratio,
        density=unit_weight, gravity=1.0,
    ).vertical_stress  # fmt: skip
    share = points.volume / points.volume_ratio
    error = np.abs(cauchy_stress(points)[:, 1, 1] - exact) @ share / share.sum()
    return float(error / (unit_weight * height)), residuals


def _ground_error(choice: Choice, ground: Ground) -> tuple[float, list[tuple[float, ...]]]:
    """Return the largest stress error after the mesh has moved by a cell in ten steps.

    And the residuals of each step.
    """
    depth, headroom, size = 4.0, 0.5, 0.5
    z = np.arange(-depth, headroom + 0.5 * size, size)
    body = _body(choice, np.arange(0.0, 2.0 + 0.5 * size, size), z, ground)
    prescribed, residuals = _rollers(body, -depth, 2.0), []
    for advance_by in np.linspace(0.0, size, 11)[1:]:
        moved = translate(body.mesh, float(advance_by), -0.5 * depth, (-depth, headroom))
        body, result = advance(mesh_to(body, moved), prescribed, name=choice.name)
        residuals.append(tuple(result.equilibrium.newton.residuals))
        body = body._replace(start=np.zeros_like(body.start))
    points = body.points
    exact = geostatic_stress(ground, points.position[:, 1], 1)
    error = np.abs(cauchy_stress(points) - exact).max()
    return float(error / (ground.unit_weight * depth)), residuals


PROBLEM = Problem(
    "SCHEMES", "Stress error of the discretisations on two problems", schemes, is_quick=False
)
