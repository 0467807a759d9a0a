"""AMPLE-COLLAPSE: a block of clay collapses under its weight and flows into empty cells.

Half of a block between a plane of symmetry and a smooth base; the mesh stays.  Once with the
default discretisation (quadratic cells, points as carriers), once with the paper's (linear cells,
points as quadrature).  The references are figures of another code, so the tolerances are the few
per cent by which two discretisations of this size differ.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.constitutive.parameters import VonMises
from install_mpm.conventions import Unit
from install_mpm.discretisation import Scheme
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import Ground
from install_mpm.material_points import cauchy_stress
from install_mpm.options import Numerics
from workflows.verification.body import Body, make_body
from workflows.verification.gravity import load_gravity, with_weight_of_points
from workflows.verification.problem import Check, Outcome, Problem, Series, relative
from workflows.verification.rectangle import rectangle_mesh
from workflows.verification.references import ample
from workflows.verification.references.ample import COLLAPSE, CollapseInput

DISCRETISATIONS = {"default": Scheme.CARRIERS, "paper's": Scheme.QUADRATURE}
NEWTON_TOLERANCE = 1e-8


class Collapsed(NamedTuple):
    """The block under its full weight."""

    extent: np.ndarray
    """Largest x and largest y of the points after each step, (n_steps, 2) in m."""
    mean_stress: float
    """Volume mean of a third of the trace of the Cauchy stress, in Pa."""
    reaction: float
    """Of the base, in N."""
    histories: tuple[tuple[float, ...], ...]


def collapse(data: CollapseInput, scheme: Scheme) -> Collapsed:
    """Return the block after gravity has grown in equal steps."""
    body, prescribed = _block(data, scheme)
    extent, histories = [], list[tuple[float, ...]]()
    for shares in pairwise(np.linspace(0.0, 1.0, data.steps + 1)):
        body, result, residuals = load_gravity(
            body, data.density * data.gravity, shares, prescribed,
            name=f"collapse, {shares[1]:.3f} of the weight",
        )  # fmt: skip
        extent.append(body.points.position.max(axis=0))
        histories += residuals
    points = body.points
    pressure = np.trace(cauchy_stress(points), axis1=1, axis2=2) / 3.0
    return Collapsed(
        np.array(extent),
        float(np.average(pressure, weights=points.volume)),
        float(result.equilibrium.reaction[:, 1].sum()),
        tuple(histories),
    )


def _block(data: CollapseInput, scheme: Scheme) -> tuple[Body, Prescribed]:
    """Return the weightless block, with empty cells beside it as wide as itself."""
    soil = VonMises(data.youngs_modulus, data.poissons_ratio, data.undrained_shear_strength)
    columns, rows = (round(side / data.cell_size) for side in (data.width, data.height))
    mesh = rectangle_mesh(
        np.linspace(0.0, 2.0 * data.width, 2 * columns + 1),
        np.linspace(0.0, data.height, rows + 1),
        is_quadratic=scheme == Scheme.CARRIERS,
    )
    centre = mesh.nodes[mesh.cell_nodes[:, :3]].mean(axis=1)
    body = make_body(
        mesh,
        Ground(0.0, 1.0, soil),
        scheme=scheme,
        numerics=Numerics(tolerance=NEWTON_TOLERANCE),
        is_soil=centre[:, 0] < data.width,
    )
    on_rollers = np.abs(mesh.nodes) < 1e-9 * data.width
    return with_weight_of_points(body), Prescribed(on_rollers, np.zeros_like(mesh.nodes))


def collapse_against_ample(
    *,
    width: Annotated[float, Unit("m")] = COLLAPSE.width,
    rho: Annotated[float, Unit("kg/m^3")] = COLLAPSE.density,
    g: Annotated[float, Unit("m/s^2")] = COLLAPSE.gravity,
    cells: int = 16,
) -> Outcome:
    """Collapse with ``cells`` x ``cells`` squares of two triangles in the block.

    AMPLE's figures (8 x 8 squares) hold for E = 12.5 rho g width, a norm of the deviator of
    0.25 rho g width and nu = 0.3, and scale with length and stress.
    """
    stress = rho * g * width
    data = CollapseInput(
        width, width, 12.5 * stress, COLLAPSE.poissons_ratio, 0.25 * stress, rho, g, width / cells
    )
    runs = {name: collapse(data, scheme) for name, scheme in DISCRETISATIONS.items()}
    counts = {
        name: sum(len(history) - 1 for history in run.histories) for name, run in runs.items()
    }
    return Outcome(
        checks=tuple(check for name, run in runs.items() for check in _checks(data, name, run)),
        series=tuple(
            _curve(data, name, run, axis) for name, run in runs.items() for axis in (0, 1)
        ),
        remarks=(f"Newton iterations {counts}; AMPLE {ample.COLLAPSE_ITERATIONS}",),
        residual_histories=tuple(history for run in runs.values() for history in run.histories),
        round_off=1e-10,
    )


def _checks(data: CollapseInput, name: str, run: Collapsed) -> tuple[Check, ...]:
    """Return the comparison at full load with AMPLE's figures, scaled."""
    x, y = run.extent[-1]
    length = data.width / COLLAPSE.width
    weight = data.density * data.gravity
    reference_x, reference_y = ample.COLLAPSE_EXTENT[COLLAPSE.steps]
    mean_stress = (
        ample.COLLAPSE_MEAN_STRESS * length * weight / (COLLAPSE.density * COLLAPSE.gravity)
    )
    return (
        relative(f"largest x of the points [m], {name}", x, reference_x * length, 1e-2),
        relative(f"largest y of the points [m], {name}", y, reference_y * length, 1e-2),
        relative(f"mean stress [Pa], {name}", run.mean_stress, mean_stress, 1e-2),
        relative(
            f"base reaction [N], {name}", run.reaction, weight * data.width * data.height, 1e-7
        ),
    )


def _curve(data: CollapseInput, name: str, run: Collapsed, axis: int) -> Series:
    """Return the largest x (``axis`` 0) or y over the share of gravity, where AMPLE's is known."""
    length = data.width / COLLAPSE.width
    steps = tuple(ample.COLLAPSE_EXTENT)
    return Series(
        f"Collapse, largest {'xy'[axis]} of the points, {name} discretisation",
        "share of gravity",
        f"{'xy'[axis]} [m]",
        tuple(step / COLLAPSE.steps for step in steps),
        tuple(float(run.extent[step - 1, axis]) for step in steps),
        tuple(extent[axis] * length for extent in ample.COLLAPSE_EXTENT.values()),
    )


PROBLEM = Problem(
    "AMPLE-COLLAPSE", "Collapse of a block of clay", collapse_against_ample, is_quick=False
)
