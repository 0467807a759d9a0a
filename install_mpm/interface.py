"""Zero-thickness interface elements between soil and pile (paper, section 2.3 and 2.4).

The general element joins two deformable sides by paired facets: w = u_pile - u_soil = B u (eqs
5-9).  Where the pile is rigid its side has no nodes and u_pile is the prescribed rigid motion of
the point.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.constitutive import coulomb_interface
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
    """Weights of the rule on a facet of unit length, (n_facet_points,)."""


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
    """Return shape values (n_points, n_facet_nodes) and weights of a Gauss rule on a line.

    Nodes are the two ends, then the mid-side; eq. (5) of the paper is the two-node case.
    """
    xi, weights = np.polynomial.legendre.leggauss(n_points)
    ends = np.column_stack([(1.0 - xi) / 2.0, (1.0 + xi) / 2.0])
    if n_facet_nodes == 2:
        return ends, weights / 2.0
    values = np.column_stack([xi * (xi - 1.0) / 2.0, xi * (xi + 1.0) / 2.0, 1.0 - xi**2])
    return values, weights / 2.0


def no_interface(dim: int) -> tuple[InterfaceElements, InterfacePoints]:
    """Return an interface without elements, for problems that have none."""
    no_nodes, no_index = np.zeros((0, 3), dtype=np.int64), np.zeros(0, dtype=np.int64)
    elements = InterfaceElements(no_nodes, no_index, *facet_rule(3, 3))
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


def frames(normals: np.ndarray, rotation: float) -> np.ndarray:
    """Return the local axes (n, 2, 2) of interface points.

    Rows tangent and normal, turned by ``rotation``.

    The gap is measured in the frame of the middle of a step, the traction acts in that of its end:
    a chord of a circle has no normal component in the mid-step frame, and a false penetration in
    any other.
    """
    cosine, sine = np.cos(rotation), np.sin(rotation)
    normal = normals @ np.array([[cosine, sine], [-sine, cosine]])
    tangent = np.column_stack([-normal[:, 1], normal[:, 0]])
    return np.stack([tangent, normal], axis=1)


def global_traction(points: InterfacePoints) -> np.ndarray:
    """Return the traction that the pile exerts on the soil in global axes, (n, dim) in Pa."""
    axes = frames(points.normal, 0.0)
    traction: np.ndarray = np.einsum("pij,pi->pj", axes, points.traction)
    return traction


def reaction(points: InterfacePoints, selected: np.ndarray | None = None) -> np.ndarray:
    """Return the force (dim,) in N of the soil on the pile, over ``selected`` points or all."""
    force = -global_traction(points) * (points.area * points.covered)[:, None]
    return np.asarray(force.sum(axis=0) if selected is None else force[selected].sum(axis=0))
