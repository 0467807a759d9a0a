"""PA3: a block with free sides is stretched and pressed together while the mesh follows (Fig. 3).

The nodes obey eqs (1)-(2) of the paper: below the top of the block they stretch with it, above they
are compressed towards the top of the mesh.  Sideways the mesh follows the block as well, so that
its cells stay full; without Poisson's ratio the block keeps its width.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Annotated, Any, NamedTuple

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.constitutive.parameters import HenckyElastic
from install_mpm.conventions import Unit
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import Ground
from install_mpm.material_points import MaterialPoints
from install_mpm.mesh_motion import translate
from install_mpm.options import Numerics
from workflows.verification.body import advance, make_body
from workflows.verification.problem import Check, Outcome, Picture, Problem, Series, at_most
from workflows.verification.rectangle import rectangle_mesh
from workflows.verification.references.stretched_body import moved_heights
from workflows.verification.references.stretched_body import stretched_body as reference

STEPS = 10
COLUMNS, ROWS, ROWS_ABOVE = 3, 3, 2
TIGHT = Numerics(tolerance=1e-12, volumetric_term=0.0)
EXACT = 1e-8

Length = Annotated[float, Unit("m")]


def stretched_body(
    *,
    u: Length = 1.0,
    L_b: Length = 1.0,
    L_m: Length = 2.5,
    width: Length = 1.0,
    E: Annotated[float, Unit("Pa")] = 10e3,
    nu: float = 0.0,
) -> Outcome:
    """Return force, size and mesh of the block of height L_b, its top moved by u and by -u/2."""
    checks: list[Check] = []
    series, residuals = [], []
    states: list[tuple[str, State, float]] = []
    for sense, last in (("stretched", u), ("pressed", -0.5 * u)):
        pull = _pull(last, (L_b, L_m, width), HenckyElastic(E, nu))
        exact = reference(
            pull.displacement, height=L_b, width=width, youngs_modulus=E, poissons_ratio=nu
        )
        final = float(exact.force[-1])
        checks += [
            Check(f"force in N per metre, {sense}", pull.force[-1], final,
                  _largest_error(pull.force, exact.force), EXACT),
            Check(f"area of the material points in m^2, {sense}", pull.area[-1],
                  float(exact.area[-1]), _largest_error(pull.area, exact.area), EXACT),
            at_most(f"distance of the nodes from eqs (1)-(2) in m, {sense}", pull.distance, EXACT),
        ]  # fmt: skip
        x, computed, expected = map(tuple, (pull.displacement, pull.force, exact.force))
        title = f"Block {sense}"
        series.append(Series(title, "displacement in m", "force in N per metre", x, computed,
                             expected))  # fmt: skip
        residuals += pull.residuals
        if not states:
            states.append(("undeformed", pull.start, L_b))
        states.append((sense, pull.end, L_b + last))
    return Outcome(
        tuple(checks),
        tuple(series),
        residual_histories=tuple(residuals),
        pictures=(Picture("states", "Body and mesh as in Fig. 3", partial(_drawn, states)),),
    )


def _drawn(states: Sequence[tuple[str, State, float]]) -> Any:
    from workflows.verification.paper_drawings import stretched_states

    return stretched_states(states)


State = tuple[MaterialPoints, BackgroundMesh]


class _Pull(NamedTuple):
    """Curves of one block, (STEPS,)."""

    displacement: np.ndarray
    force: np.ndarray
    area: np.ndarray
    distance: float
    """Largest distance of a node from eqs (1)-(2) in m."""
    residuals: list[tuple[float, ...]]
    start: State
    end: State


def _pull(last: float, lengths: tuple[float, float, float], soil: HenckyElastic) -> _Pull:
    """Return the block of ``lengths`` (height, height of the mesh, width), its top at ``last``."""
    height, mesh_height, width = lengths
    levels = np.linspace(0.0, height, ROWS + 1)
    above = np.linspace(height, mesh_height, ROWS_ABOVE + 1)[1:]
    mesh = rectangle_mesh(np.linspace(0.0, width, COLUMNS + 1), np.append(levels, above))
    is_soil = mesh.nodes[mesh.cell_nodes[:, :3], 1].mean(axis=1) < height
    body = make_body(mesh, Ground(0.0, 1.0, soil), numerics=TIGHT, is_soil=is_soil)
    start = body.points, body.mesh
    x, y = mesh.reference_nodes.T
    on_top = np.abs(y - height) < 1e-9
    is_prescribed = np.column_stack([x < 1e-9, on_top | (y < 1e-9)])
    push = np.column_stack([np.zeros_like(x), np.where(on_top, last / STEPS, 0.0)])
    places = last * np.arange(1, STEPS + 1) / STEPS
    forces, areas, residuals, distance = [], [], [], 0.0
    for place in places:
        body, result = advance(
            body, Prescribed(is_prescribed, push), move_mesh=_follow(place, lengths, soil),
            name=f"stretching to {place:.4g} m",
        )  # fmt: skip
        forces.append(result.equilibrium.reaction[on_top, 1].sum())
        areas.append(body.points.volume.sum())
        residuals.append(tuple(result.equilibrium.newton.residuals))
        wanted = moved_heights(y, body_height=height, mesh_height=mesh_height, displacement=place)
        distance = max(distance, np.abs(body.mesh.nodes[:, 1] - wanted).max())
    end = body.points, body.mesh
    return _Pull(places, np.array(forces), np.array(areas), distance, residuals, start, end)


def _follow(
    place: float, lengths: tuple[float, float, float], soil: HenckyElastic
) -> Callable[[BackgroundMesh], BackgroundMesh]:
    """Return the law of the mesh when the top has moved by ``place``."""
    height, mesh_height, width = lengths
    narrowing = (
        float(
            reference(
                place, height=height, width=width, youngs_modulus=soil.youngs_modulus,
                poissons_ratio=soil.poissons_ratio,
            ).width
        )
        / width
    )  # fmt: skip

    def move(mesh: BackgroundMesh) -> BackgroundMesh:
        moved = translate(mesh, -place, height, (0.0, mesh_height))
        return moved._replace(nodes=moved.nodes * [narrowing, 1.0])

    return move


def _largest_error(computed: np.ndarray, exact: np.ndarray) -> float:
    """Return the largest relative error of a curve."""
    return float(np.abs(computed / exact - 1.0).max())


PROBLEM = Problem("PA3", "Stretched body, mesh moving by eqs (1)-(2)", stretched_body, True)
