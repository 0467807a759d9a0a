"""Thick-walled Tresca cylinder under internal pressure, small strain, finite elements.

A slice of the cylinder is widened from inside, axisymmetric and in plane strain.  The radius c up
to which it is plastic follows from the displacement of the outer surface, where it is elastic,

    u_b = 2 (1 - nu^2) s_u c^2 / (E b) .
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from handoff.fe_mesh import FacetTag, FEMesh
from install_mpm.constitutive.parameters import CoulombInterface, Tresca
from install_mpm.conventions import Kinematics, Unit
from install_mpm.ground import Ground
from service_fe.problem import ServiceProblem
from service_fe.rigid_pile import held
from workflows.verification.problem import Outcome, Problem, Series, at_most, relative
from workflows.verification.references.thick_cylinder import collapse_pressure, internal_pressure
from workflows.verification.revolution import quadratic

CELLS = (5, 10, 20)
"""Cells across the wall: a study of convergence."""

STEPS = 20
TOLERANCE = 0.01


class Widening(NamedTuple):
    """Curves of a cylinder that is widened from inside."""

    inner_displacement: np.ndarray
    """In m, (step,)."""
    outer_displacement: np.ndarray
    """In m, (step,)."""
    pressure: np.ndarray
    """Internal pressure in Pa, (step,)."""
    residuals: tuple[tuple[float, ...], ...]
    """Relative residuals of each step."""


def widen(
    n_cells: int,
    *,
    inner_radius: float,
    outer_radius: float,
    undrained_shear_strength: float,
    youngs_modulus: float,
    poissons_ratio: float,
) -> Widening:
    """Return the curves of a cylinder with ``n_cells`` across its wall, up to collapse.

    Radii in m, strength and modulus in Pa.
    """
    mesh = _slice(inner_radius, outer_radius, n_cells)
    r = mesh.nodes[:, 0]
    is_inner = r < inner_radius * (1.0 + 1e-9)
    is_fixed = np.zeros_like(mesh.nodes, dtype=bool)
    is_fixed[:, 1] = True
    is_fixed[is_inner, 0] = True
    soil = Tresca(youngs_modulus, poissons_ratio, undrained_shear_strength)
    problem = ServiceProblem(
        mesh,
        Ground(0.0, 1.0, soil),
        CoulombInterface(1.0, 1.0),
        is_fixed=is_fixed,
        kinematics=Kinematics.AXISYMMETRIC,
    )
    # collapse is near for c = b; the plastic radius goes with the root of the displacement
    final = 4.0 * undrained_shear_strength / youngs_modulus * outer_radius**2 / inner_radius
    target = final * np.linspace(0.0, 1.0, STEPS + 1) ** 2
    area = 2.0 * np.pi * inner_radius * np.ptp(mesh.nodes[:, 1])
    state, motion, outer = problem.wished_in_place_state(), np.zeros_like(mesh.nodes), 0.0
    outers, pressures, histories = [], [], []
    for increment in np.diff(target):
        motion[is_inner, 0] = increment
        step = problem.solve(state, held(), support_motion=motion)
        state = step.state
        outer += float(step.increment.displacement[np.argmax(r), 0])
        outers.append(outer)
        pressures.append(step.support_reaction[is_inner, 0].sum() / area)
        histories.append(step.residuals)
    return Widening(target[1:], np.array(outers), np.array(pressures), tuple(histories))


def pd10(
    *,
    a: Annotated[float, Unit("m")] = 1.0,
    b: Annotated[float, Unit("m")] = 5.0,
    su: Annotated[float, Unit("Pa")] = 30e3,
    E_over_su: float = 1000.0,
    nu: float = 0.3,
) -> Outcome:
    """A thick Tresca cylinder is widened to collapse at 2 su ln(b / a) (Hill).

    Finite elements of the service stage.  The axial stress is between the two others, as the
    solution needs, if ln(b / a) < (1 - nu) / (1 - 2 nu).
    """
    radii = {"inner_radius": a, "outer_radius": b, "undrained_shear_strength": su}
    curves = [
        widen(n_cells, youngs_modulus=E_over_su * su, poissons_ratio=nu, **radii)
        for n_cells in CELLS
    ]
    fine, collapse = curves[-1], collapse_pressure(**radii)
    plastic_radius = np.sqrt(fine.outer_displacement * b * E_over_su / (2.0 * (1.0 - nu**2)))
    is_partial = (plastic_radius > a) & (plastic_radius < 0.999 * b)
    exact = internal_pressure(plastic_radius[is_partial], **radii)
    errors = tuple(abs(curve.pressure[-1] / collapse - 1.0) for curve in curves)
    largest = float(np.abs(fine.pressure[is_partial] / exact - 1.0).max())
    pressure_at = PchipInterpolator(plastic_radius[is_partial], fine.pressure[is_partial])
    first_yield = fine.pressure[0] * (a / plastic_radius[0]) ** 2  # the first step is elastic
    computed = {a: first_yield} | {c: pressure_at(c) for c in a + (b - a) * np.array([0.25, 0.5])}
    checks = (
        *(relative(f"pressure for c = {c:g} m (Pa)", float(value),
                   float(internal_pressure(c, **radii)), TOLERANCE)
          for c, value in computed.items()),
        at_most("largest relative error of p(c) from first yield to collapse", largest, TOLERANCE),
        relative("collapse pressure (Pa)", float(fine.pressure[-1]), collapse, TOLERANCE),
        at_most("error of the collapse pressure, finest over coarsest", errors[-1] / errors[0],
                0.3),
    )  # fmt: skip
    curve = Series(
        "internal pressure", "plastic radius (m)", "pressure (Pa)",
        tuple(plastic_radius[is_partial]), tuple(fine.pressure[is_partial]), tuple(exact),
    )  # fmt: skip
    histories = tuple(history for curve in curves for history in curve.residuals)
    return Outcome(checks, (curve, _convergence(errors)), residual_histories=histories)


def _convergence(errors: tuple[float, ...]) -> Series:
    """Return the error of the collapse pressure over the size of the cells."""
    sizes = tuple(1.0 / n_cells for n_cells in CELLS)
    return Series(
        "error of the collapse pressure",
        "size of the cells / (b - a)",
        "relative error",
        sizes,
        errors,
        is_logarithmic=True,
    )


def _slice(inner_radius: float, outer_radius: float, n_cells: int) -> FEMesh:
    """Return a slice with ``n_cells`` squares across the wall, each cut by both diagonals."""
    r = np.linspace(inner_radius, outer_radius, n_cells + 1)
    height = r[1] - r[0]
    vertices = np.concatenate(
        [
            np.column_stack([r, np.full_like(r, -height)]),
            np.column_stack([r, np.zeros_like(r)]),
            np.column_stack([0.5 * (r[1:] + r[:-1]), np.full(n_cells, -0.5 * height)]),
        ]
    )
    low = np.arange(n_cells)
    high, centre = low + n_cells + 1, low + 2 * n_cells + 2
    corners = np.stack([low, low + 1, high + 1, high])
    triangles = np.concatenate(
        [
            np.column_stack([corners[side], corners[(side + 1) % 4], centre])
            for side in range(4)
        ]
    )  # fmt: skip
    nodes, cell_nodes, facet_nodes = quadratic(vertices, triangles)
    return FEMesh(nodes, cell_nodes, facet_nodes, np.full(len(facet_nodes), FacetTag.SURFACE))


PROBLEM = Problem("PD10", "Thick Tresca cylinder under internal pressure", pd10, is_quick=True)
