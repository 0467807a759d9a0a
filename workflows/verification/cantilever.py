"""PA2 and AMPLE-BEAM: elastic cantilever that a dead load at its tip turns by more than 80 degrees.

The mesh follows every node of the cantilever: a body a few cells deep would be held by its partly
filled cells if it turned through a mesh that stays.  Every step still ends on straight-edged cells,
in which the points are located again.  The points are the integration points of quadratic cells;
as carriers they would give the bending stress of the middle of a sub-region to an integration point
nearer to the edge.

The elastica neither stretches nor shears, and its strains are small.  A solid of depth d differs
from it by a share of (d / l)^2: two cantilevers of the same load number, d and d / 2 deep, are
extrapolated to depth zero.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.background_mesh import BackgroundMesh, straightened
from install_mpm.constitutive.parameters import HenckyElastic
from install_mpm.conventions import Unit
from install_mpm.discretisation import Scheme
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import Ground
from workflows.verification.body import Body, advance, make_body
from workflows.verification.problem import Outcome, Problem, Series, relative
from workflows.verification.rectangle import rectangle_mesh
from workflows.verification.references import ample
from workflows.verification.references.ample import BeamInput
from workflows.verification.references.elastica import cantilever_tip


class Bent(NamedTuple):
    """The cantilever under the growing load."""

    tip: np.ndarray
    """Displacement (x, y) of the middle of the tip after each step, (n_steps, 2) in m."""
    reaction: np.ndarray
    """Sum over the supports at full load, (2,) in N."""
    histories: tuple[tuple[float, ...], ...]


def bend(data: BeamInput) -> Bent:
    """Return the cantilever after its load has grown in equal steps.

    The cells number even over the depth, so that the middle line is a line of the mesh.
    """
    columns = round(data.length / data.cell_size)
    rows = 2 * round(0.5 * data.depth / data.cell_size)
    mesh = rectangle_mesh(
        np.linspace(0.0, data.length, columns + 1),
        np.linspace(-0.5 * data.depth, 0.5 * data.depth, rows + 1),
    )
    body = make_body(
        mesh,
        Ground(0.0, 1.0, HenckyElastic(data.youngs_modulus, data.poissons_ratio)),
        scheme=Scheme.QUADRATURE,
        is_soil=np.ones(len(mesh.cell_nodes), dtype=bool),
    )
    is_fixed, share, at_tip = _supports_and_load(data, mesh)
    tip, histories = [], list[tuple[float, ...]]()
    for number in range(1, data.steps + 1):
        force = np.zeros_like(mesh.nodes)
        force[:, 1] = -data.load * number / data.steps * share
        prescribed = Prescribed(is_fixed, np.zeros_like(force), force)
        body, reaction, residuals = _advance_with_mesh(
            body, prescribed, f"cantilever, step {number}"
        )
        tip.append(body.mesh.nodes[at_tip] - [data.length, 0.0])
        histories.append(residuals)
    return Bent(np.array(tip), reaction.sum(axis=0), tuple(histories))


def _supports_and_load(data: BeamInput, mesh: BackgroundMesh) -> tuple[np.ndarray, np.ndarray, int]:
    """Return fixed dofs, the share of the load of each node, and the node in the middle of the tip.

    The load is spread evenly over the end (Simpson's rule on quadratic edges); x is fixed on the
    other end, y in the middle of it.
    """
    x, y = mesh.nodes.T
    is_clamped = np.abs(x) < 1e-9 * data.length
    is_fixed = np.stack([is_clamped, is_clamped & (np.abs(y) < 1e-9 * data.depth)], axis=1)
    at_end = np.flatnonzero(np.abs(x - data.length) < 1e-9 * data.length)
    at_end = at_end[np.argsort(y[at_end])]
    share = np.zeros(len(x))
    share[at_end] = np.where(np.arange(len(at_end)) % 2 == 1, 4.0, 2.0)
    share[at_end[[0, -1]]] = 1.0
    return is_fixed, share / share.sum(), int(np.argmin(np.hypot(x - data.length, y)))


def _advance_with_mesh(
    body: Body, prescribed: Prescribed, name: str
) -> tuple[Body, np.ndarray, tuple[float, ...]]:
    """Return the body after a step in which the mesh moves with its nodes, reaction and residuals.

    The law of motion has to be known when the points are located, so the step is solved first and
    then taken.
    """
    _, solved = advance(body, prescribed, name=name)
    displacement = solved.equilibrium.displacement
    moved, taken = advance(
        body._replace(start=displacement), prescribed, move_mesh=_by(displacement), name=name
    )
    return moved, taken.equilibrium.reaction, tuple(solved.equilibrium.newton.residuals)


def _by(displacement: np.ndarray) -> Callable[[BackgroundMesh], BackgroundMesh]:
    """Return the law that moves every node by ``displacement`` (n_nodes, 2) in m."""
    return lambda mesh: straightened(mesh._replace(nodes=mesh.nodes + displacement))


def cantilever(
    *,
    l: Annotated[float, Unit("m")] = 10.0,
    d: Annotated[float, Unit("m")] = 1.0,
    E: Annotated[float, Unit("Pa")] = 12e6,
    nu: float = 0.2,
    P: Annotated[float, Unit("N")] = 100e3,
    cells: int = 2,
    steps: int = 50,
) -> Outcome:
    """PA2: the tip against the inextensible elastica, ``cells`` squares over the depth (even)."""
    deep_input = BeamInput(l, d, E, nu, P, d / cells, steps)
    deep = bend(deep_input)
    slender = bend(BeamInput(l, 0.5 * d, E, nu, 0.125 * P, 0.5 * d / cells, steps))
    tip = (4.0 * slender.tip - deep.tip) / 3.0
    u, w = _elastica(deep_input).T
    return Outcome(
        checks=(
            relative("deflection w of the tip at depth 0 [m]", -tip[-1, 1], w[-1], 0.02),
            relative("shortening u of the tip at depth 0 [m]", -tip[-1, 0], u[-1], 0.02),
            relative(
                "deflection w of the tip at depth d / 2 [m]", -slender.tip[-1, 1], w[-1], 0.02
            ),
            relative("deflection w of the tip at depth d [m]", -deep.tip[-1, 1], w[-1], 0.02),
            relative("support reaction [N]", deep.reaction[1], P, 1e-8),
        ),
        series=(
            _curve("deflection w", P, -tip[:, 1], w),
            _curve("shortening u", P, -tip[:, 0], u),
        ),
        remarks=(
            f"at depth d, w is {-deep.tip[-1, 1] / w[-1] - 1.0:.2%} and u"
            f" {-deep.tip[-1, 0] / u[-1] - 1.0:.2%} more than of the elastica",
        ),
        residual_histories=deep.histories + slender.histories,
    )


def _elastica(data: BeamInput) -> np.ndarray:
    """Return shortening and deflection of the elastica after each step, (n_steps, 2) in m."""
    loads = data.load * np.arange(1, data.steps + 1) / data.steps
    tips = [
        cantilever_tip(
            load=load,
            length=data.length,
            depth=data.depth,
            youngs_modulus=data.youngs_modulus,
            poissons_ratio=data.poissons_ratio,
        )
        for load in loads
    ]
    return np.array([(tip.shortening, tip.deflection) for tip in tips])


def _curve(name: str, load: float, computed: np.ndarray, reference: np.ndarray) -> Series:
    steps = len(computed)
    return Series(
        f"Cantilever, {name} of the tip, extrapolated to depth 0",
        "load [N]",
        f"{name} [m]",
        tuple(load * np.arange(1, steps + 1) / steps),
        tuple(computed),
        tuple(reference),
    )


def ample_beam(
    *,
    l: Annotated[float, Unit("m")] = ample.BEAM.length,
    P: Annotated[float, Unit("N")] = ample.BEAM.load,
    cells: int = 2,
) -> Outcome:
    """AMPLE-BEAM: the tip at full load against AMPLE, ``cells`` squares over the depth (even).

    AMPLE's figures hold for d = l / 10, E = 1200 P / l and nu = 0.2, and scale with length.
    """
    data = ample.BEAM
    run = bend(BeamInput(l, 0.1 * l, 1200.0 * P / l, 0.2, P, 0.1 * l / cells, data.steps))
    steps = tuple(ample.BEAM_9_POINTS_GHOST)
    scale = l / data.length
    references = np.array([ample.BEAM_9_POINTS_GHOST[step] for step in steps]) * scale
    computed = run.tip[np.array(steps) - 1]
    names = ("x", "y")
    return Outcome(
        checks=(
            *(
                relative(
                    f"displacement in {name} of the tip [m]",
                    computed[-1, axis],
                    references[-1, axis],
                    0.02,
                )
                for axis, name in enumerate(names)
            ),
            relative("support reaction [N]", run.reaction[1], P, 1e-8),
        ),
        series=tuple(
            Series(
                f"AMPLE's beam, displacement in {name} of the tip",
                "load [N]",
                f"{name} [m]",
                tuple(P * step / data.steps for step in steps),
                tuple(computed[:, axis]),
                tuple(references[:, axis]),
            )
            for axis, name in enumerate(names)
        ),
        remarks=("the reference is AMPLE with ghost penalty, in which every step converged",),
        residual_histories=run.histories,
    )


PROBLEMS = (
    Problem("PA2", "Cantilever, elastica", cantilever, is_quick=False),
    Problem("AMPLE-BEAM", "AMPLE's beam", ample_beam, is_quick=False),
)
