"""Zero-thickness interface elements between soil and pile (paper, section 2.3 and 2.4).

The general element joins two deformable sides by paired facets: w = u_pile - u_soil = B u (eqs
5-9).  Where the pile is rigid its side has no nodes and u_pile is the prescribed rigid motion of
the point.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple, Protocol

import numpy as np

from install_mpm.cells import CellType, reference_cell, shape_functions
from install_mpm.constitutive import coulomb_interface
from install_mpm.constitutive.coulomb_interface import COHESION, TAN_FRICTION
from install_mpm.interface_axes import (
    angle_gradient,
    axes_of,
    polar_change,
    quarter_turned,
    turned_by,
)
from install_mpm.record import Field


class InterfaceElements(NamedTuple):
    """Topology of the interface: paired facets and the integration rule on them."""

    nodes: np.ndarray
    """Nodes of the soil side, then of a deformable pile, (n_elements, n_sides * n_facet_nodes)."""
    cell: np.ndarray
    """Background cell on the soil side, (n_elements,) int64."""
    shape_values: np.ndarray
    """Shape functions of a facet at its integration points, (n_facet_points, n_facet_nodes)."""
    weights: np.ndarray
    """Weights of the rule on a facet of unit size, (n_facet_points,)."""
    is_swept: np.ndarray | None = None
    """Points (n_points,) of surfaces that a rotation of the pile maps onto themselves; None: none.

    On a cylinder, a cone or a helicoid the normal is that of the place where the *soil* is, on any
    other surface it turns with the pile.
    """


class Facets(Protocol):
    """Facets on a pile and the rule on them, in any of the stages."""

    @property
    def nodes(self) -> np.ndarray:
        """Nodes of each facet on the soil side, vertices first, (n, n_facet_nodes)."""

    @property
    def shape_values(self) -> np.ndarray:
        """Shape functions of a facet at its points, (n_facet_points, n_facet_nodes)."""

    @property
    def weights(self) -> np.ndarray:
        """Weights of the rule on a facet of unit size, (n_facet_points,)."""


class InterfacePoints(NamedTuple):
    """Integration points of the interface, those of one element after the other."""

    position: Annotated[np.ndarray, Field(("interface_point", "dim"), "m", "current position")]
    normal: Annotated[
        np.ndarray, Field(("interface_point", "dim"), "", "exact unit normal from soil to pile")
    ]
    area: Annotated[
        np.ndarray, Field(("interface_point",), "m^2", "share of the surface, per metre run in 2D")
    ]
    traction: Annotated[
        np.ndarray,
        Field(
            ("interface_point", "dim"),
            "Pa",
            "traction on the soil in local axes, tangential first, normal last, tension positive",
        ),
    ]
    parameters: Annotated[
        np.ndarray,
        Field(
            ("interface_point", coulomb_interface.N_PARAMETERS),
            "SI",
            "normal and shear stiffness, cohesion, tan phi, tan psi, tensile limit, smoothing",
        ),
    ]
    part: Annotated[np.ndarray, Field(("interface_point",), "", "PilePart", "int64")]
    covered: Annotated[
        np.ndarray, Field(("interface_point",), "", "share of the area that soil covers, 0: off")
    ]


def facet_rule(n_facet_nodes: int, n_points: int) -> tuple[np.ndarray, np.ndarray]:
    """Return shape values (n_points, n_facet_nodes) and weights of a rule on a facet of unit size.

    On a line, with its two ends and the mid-side, it is a Gauss rule; eq. (5) of the paper is the
    two-node case.  On a triangle of six nodes, with vertices first, it is the rule of three points,
    one near each vertex.

    Raises
    ------
    ValueError
        If a triangle is asked for another number of points than three.
    """
    if n_facet_nodes == 6:
        if n_points != 3:
            raise ValueError(f"a triangle has a rule of 3 points, not of {n_points}")
        return _triangle_rule()
    xi, weights = np.polynomial.legendre.leggauss(n_points)
    ends = np.column_stack([(1.0 - xi) / 2.0, (1.0 + xi) / 2.0])
    if n_facet_nodes == 2:
        return ends, weights / 2.0
    values = np.column_stack([xi * (xi - 1.0) / 2.0, xi * (xi + 1.0) / 2.0, 1.0 - xi**2])
    return values, weights / 2.0


def _triangle_rule() -> tuple[np.ndarray, np.ndarray]:
    """Return shape values (3, 6) and weights of the three-point rule on a six-node triangle."""
    triangle = reference_cell(CellType.TRI6)
    values = np.empty((3, 6))
    for row, xi in zip(values, triangle.integration_coordinates, strict=True):
        shape_functions(triangle.cell_type, xi, row)
    return values, np.full(3, 1 / 3)


def no_interface(dim: int) -> tuple[InterfaceElements, InterfacePoints]:
    """Return an interface without elements, for problems that have none."""
    n_facet_nodes = 3 if dim == 2 else 6
    no_nodes, no_index = np.zeros((0, n_facet_nodes), dtype=np.int64), np.zeros(0, dtype=np.int64)
    elements = InterfaceElements(no_nodes, no_index, *facet_rule(n_facet_nodes, 3))
    vectors = np.zeros((0, dim))
    points = InterfacePoints(
        vectors,
        vectors,
        np.zeros(0),
        vectors,
        np.zeros((0, coulomb_interface.N_PARAMETERS)),
        no_index,
        np.zeros(0),
    )
    return elements, points


def with_strength_share(parameters: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Return packed ``parameters`` (n, 7) with the shear strength times ``share`` (n,).

    By the share facets stand for the exact surface, see ``exact_patches``.
    """
    scaled = parameters.copy()
    scaled[:, [COHESION, TAN_FRICTION]] *= share[:, None]
    return scaled


def local_axes(points: InterfacePoints) -> np.ndarray:
    """Return the local axes (n, dim, dim) of the points: tangents first, normal last."""
    return axes_of(points.normal, points.position)


class StepAxes(NamedTuple):
    """Local axes (n, dim, dim) of the interface points in a step."""

    slip: np.ndarray
    """In which the slip of the step is measured: those of the middle of the way.

    A chord of a circle has no component along the normal of its middle, and a false penetration
    along any other.
    """
    slip_change: np.ndarray
    """By which the slip changes with the motion of the pile less that of the soil: on a surface
    that is swept the axes turn with the soil as well."""
    traction: np.ndarray
    """In which the traction acts on the soil at the end of the step."""


def step_axes(
    points: InterfacePoints,
    is_swept: np.ndarray | None,
    rotation: float,
    pile: np.ndarray,
    soil: np.ndarray,
) -> StepAxes:
    """Return the local axes in a step in which the pile turns by ``rotation`` (rad).

    ``pile`` and ``soil`` (n, dim) are the displacements in m of both sides at the points.  On a
    surface that is swept onto itself the soil meets the normal of the place where it is, so that
    pressure on a cylinder has no torque however far the soil stays behind.
    """
    start = local_axes(points)
    if is_swept is None:
        slip = turned_by(start, np.full(len(start), rotation / 2.0))
        return StepAxes(slip, slip, turned_by(start, np.full(len(start), rotation)))
    of_soil = np.where(is_swept, polar_change(points.position, soil), 0.0)
    slip = turned_by(start, (rotation + of_soil) / 2.0)
    behind = np.where(is_swept, (rotation - of_soil) / 2.0, 0.0)
    slip[:, -1] /= np.cos(behind)[:, None]  # so that motion along the radius counts in full
    by_angle = 0.5 * quarter_turned(slip)
    by_angle[:, -1] -= 0.5 * np.tan(behind)[:, None] * slip[:, -1]
    by_angle = np.einsum("pij,pj->pi", by_angle, pile - soil)
    turn = np.where(is_swept[:, None], angle_gradient(points.position + soil), 0.0)
    change = slip - by_angle[:, :, None] * turn[:, None, :]
    return StepAxes(slip, change, turned_by(start, np.where(is_swept, of_soil, rotation)))


def add_turning_of_traction(
    stiffness: np.ndarray, elements: InterfaceElements, forces: np.ndarray, position: np.ndarray
) -> None:
    """Add to ``stiffness`` that the traction turns with the soil on surfaces that are swept.

    ``stiffness`` is (n_elements, n_nodes, dim, n_nodes, dim); ``forces`` (n_points, dim) in N are
    those on the pile, at ``position`` (n_points, dim) in m, the place of the soil.
    """
    if elements.is_swept is None:
        return
    shape = elements.shape_values
    n_points, n_facet_nodes = shape.shape
    change = angle_gradient(position) * elements.is_swept[:, None]
    turned = quarter_turned(forces)
    dim = position.shape[1]
    stiffness[:, :n_facet_nodes, :, :n_facet_nodes, :] += np.einsum(
        "qa,eqi,qb,eqj->eaibj", shape, turned.reshape(-1, n_points, dim), shape,
        change.reshape(-1, n_points, dim), optimize=True,
    )  # fmt: skip


class Contact(NamedTuple):
    """Forces between pile and soil at the interface points at the end of a step."""

    position: np.ndarray
    """Where they act: place of the soil, (n, dim) in m."""
    force: np.ndarray
    """Of the soil on the pile, (n, dim) in N."""
    normal_force: np.ndarray
    """Its part along the normal, (n, dim) in N."""


def soil_displacement(elements: InterfaceElements, displacement: np.ndarray) -> np.ndarray:
    """Return the displacement (n_points, dim) in m of the soil at the interface points."""
    n_facet_nodes = elements.shape_values.shape[1]
    own = displacement[elements.nodes[:, :n_facet_nodes]]
    of_soil: np.ndarray = np.einsum("qa,eai->eqi", elements.shape_values, own)
    return of_soil.reshape(-1, displacement.shape[1])


def global_traction(points: InterfacePoints) -> np.ndarray:
    """Return the traction that the pile exerts on the soil in global axes, (n, dim) in Pa."""
    traction: np.ndarray = np.einsum("pij,pi->pj", local_axes(points), points.traction)
    return traction


def force_on_pile(points: InterfacePoints) -> np.ndarray:
    """Return the force (n, dim) in N of the soil on the pile at every point."""
    force: np.ndarray = -global_traction(points) * (points.area * points.covered)[:, None]
    return force


def reaction(points: InterfacePoints, selected: np.ndarray | None = None) -> np.ndarray:
    """Return the force (dim,) in N of the soil on the pile, over ``selected`` points or all."""
    force = force_on_pile(points)
    return np.asarray(force.sum(axis=0) if selected is None else force[selected].sum(axis=0))
