"""PC7: a buried circular plate is pulled up in sand with associated flow, finite elements.

The cone that opens upward by phi from the edge of the plate is a mechanism of limit analysis; its
weight bounds the load from above.  Finite elements approach the limit load from above too, with an
error of first order in their size at the cone, where the velocity jumps.  So what is compared with
the bound is the load at elements of no size: the straight line through that of three meshes.

The ground under the level of the plate is fixed, and the plate leaves it at once.  That is so in
the mechanism as well; the bound holds for this problem.
"""

from __future__ import annotations

from functools import partial
from typing import Annotated

import numpy as np

from handoff.fe_mesh import FEMesh
from handoff.gmsh_triangles import triangulate
from install_mpm.constitutive.parameters import CoulombInterface, MohrCoulomb
from install_mpm.conventions import Kinematics, Unit
from install_mpm.ground import Ground
from service_fe.options import ServiceNumerics
from service_fe.problem import ServiceProblem, roller_supports
from workflows.verification.footing_curve import FootingCurve, curve_on_finest_mesh, error_over_size
from workflows.verification.problem import Outcome, Problem, at_least, at_most, relative
from workflows.verification.references.bearing_capacity import plate_uplift_bound
from workflows.verification.revolution import outer_tags, quadratic
from workflows.verification.sand_footing import push

SIZES = (0.05, 0.025, 0.0125)
"""Edge length of the elements at the cone over the diameter of the plate."""

SIZE_FAR, GROWTH = 0.4, 0.25
"""Edge length far away over the diameter, and its growth with the distance from the cone."""

STEPS = 20
RELATIVE_UPLIFT = 8.0
"""Final uplift times E / (N gamma H D), with the bound N; the plateau begins near 4."""

TOLERANCE, EXTRAPOLATED = 0.02, 0.005
"""Of the load on the finest mesh above the bound, and of that at elements of no size."""


def plate_uplift(
    size_at_cone: float,
    *,
    diameter: float,
    depth: float,
    friction_angle: float,
    unit_weight: float,
    k0: float,
    rigidity_index: float,
) -> FootingCurve:
    """Return the uplift over the diameter, and the mean pressure over gamma H.

    Parameters
    ----------
    size_at_cone
        Edge length of the elements at the cone over the diameter.
    diameter, depth
        Of the plate, in m.
    friction_angle
        In rad; the dilation angle is the same.
    unit_weight
        In N/m3.
    k0
        Horizontal over vertical stress at rest.
    rigidity_index
        Young's modulus over gamma H; it only scales the uplift.

    Raises
    ------
    StepNotConvergedError
        If a step does not converge in parts either.
    """
    mesh = plate_mesh(size_at_cone * diameter, diameter, depth, friction_angle)
    overburden = unit_weight * depth
    soil = MohrCoulomb(rigidity_index * overburden, 0.3, 0.0, friction_angle, friction_angle)
    at_plate_level = np.abs(mesh.nodes[:, 1] + depth) < 1e-9 * diameter
    on_plate = at_plate_level & (mesh.nodes[:, 0] < (0.5 + 1e-9) * diameter)
    is_fixed = roller_supports(mesh)
    is_fixed[at_plate_level] = True
    problem = ServiceProblem(
        mesh,
        Ground(unit_weight, k0, soil),
        CoulombInterface(1.0, 1.0),
        numerics=ServiceNumerics(max_iterations=40, tolerance=1e-8),
        is_fixed=is_fixed,
        kinematics=Kinematics.AXISYMMETRIC,
    )
    bound = plate_uplift_bound(depth_ratio=depth / diameter, friction_angle=friction_angle)
    uplift = RELATIVE_UPLIFT * bound / rigidity_index * np.linspace(0.0, 1.0, STEPS + 1) ** 1.5
    accepted = push(problem, on_plate, -np.diff(uplift) * diameter, 0.0)
    risen = [step.increment.displacement[on_plate, 1].mean() for step in accepted]
    loads = np.array([step.support_reaction[on_plate, 1].sum() for step in accepted])
    return FootingCurve(
        settlement=np.cumsum(risen) / diameter,
        bearing_factor=loads / (0.25 * np.pi * diameter**2 * overburden),
        residuals=tuple(step.residuals for step in accepted),
    )


def plate_mesh(size_at_cone: float, diameter: float, depth: float, friction_angle: float) -> FEMesh:
    """Return the mesh of the ground above the plate's level, graded to the cone; sizes in m."""
    radius, slope = 0.5 * diameter, float(np.tan(friction_angle))
    side = radius + depth * slope + diameter

    def size(r: float, z: float) -> float:
        from_cone = abs(r - radius - (z + depth) * slope) * np.cos(friction_angle)
        return min(SIZE_FAR * diameter, size_at_cone + GROWTH * float(from_cone))

    outline = np.array([(0.0, -depth), (radius, -depth), (side, -depth), (side, 0.0), (0.0, 0.0)])
    nodes, cell_nodes, facet_nodes = quadratic(*triangulate(outline, size))
    return FEMesh(nodes, cell_nodes, facet_nodes, outer_tags(nodes[facet_nodes[:, 2]], side, depth))


def pc7(
    *,
    D: Annotated[float, Unit("m")] = 1.0,
    H: Annotated[float, Unit("m")] = 2.0,
    phi: Annotated[float, Unit("rad")] = float(np.deg2rad(30.0)),
    gamma: Annotated[float, Unit("N/m^3")] = 10e3,
    K0: float = 0.5,
    E_over_gamma_H: float = 2000.0,
) -> Outcome:
    """A plate of diameter D at depth H is pulled up in sand of friction and dilation angle phi."""
    bound = plate_uplift_bound(depth_ratio=H / D, friction_angle=phi)
    curve_of = partial(
        plate_uplift, diameter=D, depth=H, friction_angle=phi, unit_weight=gamma, k0=K0,
        rigidity_index=E_over_gamma_H,
    )  # fmt: skip
    curves = [curve_of(size) for size in SIZES]
    plateaus = np.array([curve.plateau for curve in curves])
    slope, limit = np.polyfit(SIZES, plateaus, 1)
    fine = curves[-1]
    checks = (
        at_most(
            "limit load at elements of no size above the bound", limit / bound - 1.0, EXTRAPOLATED
        ),
        relative("mean pressure / (gamma H) on the finest mesh", fine.plateau, bound, TOLERANCE),
        at_least("slope of the load over the size: approached from above", float(slope), 0.0),
        at_most("change of load over the last quarter", abs(fine.slope), 2e-3),
    )
    series = (
        curve_on_finest_mesh(
            "plate, finest mesh",
            fine,
            bound,
            width="D",
            factor="mean pressure / (gamma H)",
            way="uplift",
        ),
        error_over_size(
            "plate, load above the bound", curves, bound, SIZES, width="D", place="cone"
        ),
    )
    histories = tuple(history for curve in curves for history in curve.residuals)
    return Outcome(checks, series, residual_histories=histories)


PROBLEM = Problem(
    "PC7",
    "Uplift of a buried circular plate in sand: the cone of weight is an upper bound",
    pc7,
    is_quick=False,
)
