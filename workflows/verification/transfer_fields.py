"""PF1: stress fields carried from material points to the points of a mesh that does not match them.

The material points stand at shaken places of a grid; the targets are the integration points of
meshes made by gmsh, a square of triangles and the ground around a screw pile.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from handoff.gmsh_triangles import triangulate
from handoff.options import HandoffOptions
from handoff.screw_mesh import make_screw_mesh
from handoff.surface import level_surface
from handoff.transfer import transfer_least_squares
from install_mpm.conventions import Unit
from install_mpm.options import Box
from install_mpm.screw_pile import Helix, ScrewPile
from workflows.verification.problem import Check, Outcome, Problem, Series, at_least, at_most

SPACINGS = {2: (1 / 16, 1 / 32, 1 / 64), 3: (1 / 8, 1 / 12, 1 / 18)}
"""Distance of the grid's points over the side of the block: a study of convergence."""

SHAKEN = 0.3
"""Largest shift of a point over the distance of the grid."""

ROUND_OFF, LINEAR, ORDER = 1e-10, 1e-8, 1.8


def pf1(
    *,
    sigma: Annotated[float, Unit("Pa")] = 100e3,
    a: Annotated[float, Unit("m")] = 4.0,
    neighbours: int = 32,
    seed: int = 1,
) -> Outcome:
    """Constant, linear and quadratic fields of size sigma in a block of side a.

    Constant ones come out to 1e-10, linear ones to 1e-8, quadratic ones with second order.
    """
    random = np.random.default_rng(seed)
    checks, series = list[Check](), list[Series]()
    for dim, targets in ((2, _in_square(a)), (3, _around_pile(a))):
        errors = [_errors(random, sigma, a, targets, spacing, neighbours)
                  for spacing in SPACINGS[dim]]  # fmt: skip
        constant, linear, quadratic = np.array(errors).T
        orders = np.diff(np.log(quadratic)) / np.diff(np.log(SPACINGS[dim]))
        checks += [
            at_most(f"{dim}D: constant field, largest error / sigma", constant.max(), ROUND_OFF),
            at_most(f"{dim}D: linear field, largest error / sigma", linear.max(), LINEAR),
            at_least(f"{dim}D: quadratic field, lowest order", orders.min(), ORDER),
        ]
        series.append(
            Series(f"Quadratic field in {dim}D", "distance of the points / a",
                   "root mean square error / sigma", SPACINGS[dim], tuple(quadratic),
                   is_logarithmic=True)
        )  # fmt: skip
    return Outcome(tuple(checks), tuple(series))


def _errors(
    random: np.random.Generator, size: float, side: float, targets: np.ndarray, spacing: float,
    neighbours: int,
) -> tuple[float, float, float]:  # fmt: skip
    """Return the errors over ``size`` of a constant, a linear and a quadratic tensor field."""
    dim = targets.shape[1]
    line = (np.arange(round(1.0 / spacing)) + 0.5) * spacing
    grid = np.stack(np.meshgrid(*[line] * dim), axis=-1).reshape(-1, dim)
    points = side * (grid + SHAKEN * spacing * random.uniform(-1.0, 1.0, grid.shape))
    volumes = random.uniform(0.5, 1.5, len(points))
    tensor = random.normal(size=(3, 3, 3))
    slope = random.normal(size=(dim, 3, 3)) / side
    curvature = random.normal(size=(dim, dim, 3, 3)) / side**2

    def fields(places: np.ndarray) -> np.ndarray:
        constant = np.broadcast_to(tensor[0], (len(places), 3, 3))
        linear = tensor[1] + np.einsum("ni,ikl->nkl", places, slope)
        quadratic = tensor[2] + np.einsum("ni,nj,ijkl->nkl", places, places, curvature)
        return size * np.stack([constant, linear, quadratic], axis=1)

    error = fields(targets) - transfer_least_squares(
        points, volumes, fields(points), targets, neighbours
    )
    largest = np.abs(error).max(axis=(0, 2, 3))
    mean = np.sqrt((error[:, 2] ** 2).mean())
    return float(largest[0] / size), float(largest[1] / size), float(mean / size)


def _in_square(side: float) -> np.ndarray:
    """Return the integration points (n, 2) of triangles in a square of ``side`` m."""
    corners = side * np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    vertices, triangles = triangulate(corners, lambda _x, _z: 0.07 * side)
    shares = np.full((3, 3), 1.0 / 6.0) + 0.5 * np.eye(3)
    return np.einsum("qk,ckd->cqd", shares, vertices[triangles]).reshape(-1, 2)


def _around_pile(side: float) -> np.ndarray:
    """Return the integration points (n, 3) around a screw pile that lie in a cube of ``side`` m."""
    helix = Helix(
        diameter=0.4 * side, pitch=0.1 * side, thickness=0.02 * side, height=0.1 * side
    )  # fmt: skip
    pile = ScrewPile(0.1 * side, 0.5 * side, (helix,), 0.0)
    options = HandoffOptions(size_at_pile=0.05 * side, size_far=0.3 * side)
    box = Box(width=0.75 * side, depth=1.1 * side, headroom=0.1 * side)
    mesh = make_screw_mesh(pile, 0.3, box, options, level_surface())
    near = 0.25 * (1.0 - 1.0 / np.sqrt(5.0))
    shares = np.full((4, 4), near) + (1.0 - 4.0 * near) * np.eye(4)
    corners = mesh.nodes[mesh.cell_nodes[:, :4]]
    places = np.einsum("qk,ckd->cqd", shares, corners).reshape(-1, 3)
    places += side * np.array([0.5, 0.5, 1.0])
    inside = ((places > 0.0) & (places < side)).all(axis=1)
    return np.asarray(places[inside])


PROBLEM = Problem("PF1", "Fields from material points to finite elements", pf1, is_quick=True)
