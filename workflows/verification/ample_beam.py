"""AMPLE-BEAM: the cantilever of PA2 beside the figures of another code for the same inputs."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from install_mpm.conventions import Unit
from workflows.verification.cantilever import bend
from workflows.verification.problem import Outcome, Problem, Series, at_most, relative
from workflows.verification.references import ample
from workflows.verification.references.ample import BeamInput
from workflows.verification.references.shear_beam import Section, cantilever_tips

TOLERANCE = 0.02


def ample_beam(
    *,
    l: Annotated[float, Unit("m")] = ample.BEAM.length,
    P: Annotated[float, Unit("N")] = ample.BEAM.load,
    cells: int = 2,
) -> Outcome:
    """AMPLE-BEAM: the tip at full load and on the way against AMPLE, ``cells`` squares deep (even).

    AMPLE's figures hold for d = l / 10, E = 1200 P / l and nu = 0.2, and scale with length.  On the
    way the distance of the tips counts, over the way of AMPLE's tip at full load: under the first
    load AMPLE is 4 % stiffer than a beam that is nearly linear there.
    """
    data = ample.BEAM
    run = bend(BeamInput(l, 0.1 * l, 1200.0 * P / l, 0.2, P, 0.1 * l / cells, data.steps))
    steps = np.array(tuple(ample.BEAM_9_POINTS_GHOST))
    scale = l / data.length
    computed = run.tip[steps - 1]
    ghost, plain = (
        np.array(list(tips.values())) * scale
        for tips in (ample.BEAM_9_POINTS_GHOST, ample.BEAM_9_POINTS)
    )
    section = Section(0.1 * l, 1200.0 * P / l, 0.2)
    beam = -cantilever_tips(section, l, P * steps / data.steps)
    distance, plain_distance = (
        np.linalg.norm(computed - tips, axis=1).max() / np.linalg.norm(tips[-1])
        for tips in (ghost, plain)
    )
    return Outcome(
        checks=(
            *(
                relative(f"displacement {name} of the tip [m]", computed[-1, axis], ghost[-1, axis],
                         TOLERANCE)
                for axis, name in enumerate("uv")
            ),
            at_most("largest distance of the tips in ten steps over the last", distance, TOLERANCE),
            at_most("the same, AMPLE without ghost penalty", plain_distance, TOLERANCE),
            relative("support reaction [N]", run.reaction[1], P, 1e-8),
        ),
        series=_curves(P * steps / data.steps, computed, ghost),
        remarks=(
            "the reference is AMPLE with ghost penalty, in which every step converged; in AMPLE"
            " without it, one step did not",
            *(_beside(name, tips, beam) for name, tips in (
                ("this code", computed), ("AMPLE with ghost penalty", ghost), ("AMPLE", plain),
            )),
        ),
        residual_histories=run.histories,
    )  # fmt: skip


def _curves(loads: np.ndarray, computed: np.ndarray, ghost: np.ndarray) -> tuple[Series, ...]:
    """Return both displacements of the tip (n, 2) in m under ``loads`` (n,) in N."""
    return tuple(
        Series(f"AMPLE's beam, displacement {name} of the tip", "load [N]", f"{name} [m]",
               tuple(loads), tuple(computed[:, axis]), tuple(ghost[:, axis]))
        for axis, name in enumerate("uv")
    )  # fmt: skip


def _beside(name: str, tips: np.ndarray, beam: np.ndarray) -> str:
    """Return how far ``tips`` are from the exact beam in the first and the last step, in words."""
    first, last = (f"u {tips[k, 0] / beam[k, 0] - 1.0:+.1%}, v {tips[k, 1] / beam[k, 1] - 1.0:+.1%}"
                   for k in (0, -1))  # fmt: skip
    u, v = tips[-1]
    return (
        f"{name}: u = {u:.4f} m, v = {v:.4f} m; from the exact beam {last} at full load, {first} in"
        " the first step"
    )


PROBLEM = Problem("AMPLE-BEAM", "AMPLE's beam", ample_beam, is_quick=False)
