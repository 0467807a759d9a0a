"""Interface between pile and soil in the finite-element model: zero-thickness quadratic elements.

The soil side is an edge of a quadratic triangle, the pile side moves rigidly.  With the relative
displacement

    w = G (u, q) ,   G = [-N, T] in local axes (tangential, normal), pile minus soil,

the traction t(w) on the soil gives the forces int G^T t and the stiffness int G^T D G.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from handoff.fe_mesh import FacetTag, FEMesh
from install_mpm.constitutive import coulomb_interface
from install_mpm.conventions import Kinematics
from install_mpm.pile import surface_normals, tangent_of
from service_fe.kinematics import width
from service_fe.rigid_pile import rigid_motion

GAUSS_POINTS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(3)
"""Three points on (-1, 1): exact for the stiffness of quadratic edges."""

N_SOIL = 6
"""Soil displacements of an element: two at each of three nodes; the pile's three follow."""


class InterfaceResponse(NamedTuple):
    """Interface at all its integration points after an increment of relative displacement."""

    traction: np.ndarray
    """Traction on the soil (n_i, 2) in Pa, (tangential, normal)."""
    tangent: np.ndarray
    """Consistent tangent (n_i, 2, 2) in Pa/m."""
    status: np.ndarray
    """``STICK``, ``SLIP`` or ``OPEN`` (n_i,)."""


class InterfaceStiffness(NamedTuple):
    """Blocks of the stiffness that couple soil (s) and pile (p)."""

    dofs: np.ndarray
    """Displacements 2 * node + axis (n_element, 6) of the soil side."""
    soil: np.ndarray
    """K_ss (n_element, 6, 6)."""
    soil_pile: np.ndarray
    """K_sp (n_dofs, 3)."""
    pile_soil: np.ndarray
    """K_ps (3, n_dofs)."""
    pile: np.ndarray
    """K_pp (3, 3)."""


def edge_shape_functions(coordinate: np.ndarray) -> np.ndarray:
    """Return the shape functions (n, 3) of a quadratic edge, ends first, at (n,) in (-1, 1)."""
    return np.column_stack(
        [
            0.5 * coordinate * (coordinate - 1.0),
            0.5 * coordinate * (coordinate + 1.0),
            1.0 - coordinate**2,
        ]
    )


class InterfaceForms:
    """Discrete interface on the pile's facets of a mesh; there may be none."""

    def __init__(self, mesh: FEMesh, kinematics: Kinematics = Kinematics.PLANE_STRAIN) -> None:
        is_pile = np.isin(mesh.facet_tag, (FacetTag.PILE_BASE, FacetTag.PILE_SHAFT))
        nodes = mesh.facet_nodes[is_pile]
        ends = mesh.nodes[nodes[:, :2]]
        shape = edge_shape_functions(GAUSS_POINTS)
        n_gauss = len(GAUSS_POINTS)
        self.n_dofs = 2 * len(mesh.nodes)
        self.positions = np.einsum("qa,fai->fqi", shape, mesh.nodes[nodes]).reshape(-1, 2)
        lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        self.areas = np.outer(lengths, 0.5 * GAUSS_WEIGHTS).ravel()
        self.areas *= width(self.positions, kinematics)
        self.parts = np.repeat(mesh.facet_tag[is_pile], n_gauss)
        self.normals = surface_normals(self.parts)
        self._dofs = (2 * nodes[:, :, None] + np.arange(2)).reshape(-1, N_SOIL)
        self._point_dofs = np.repeat(self._dofs, n_gauss, axis=0)

        axes = np.stack([tangent_of(self.normals), self.normals], axis=1)
        soil = np.einsum("pki,qa->pqkai", axes, shape)
        own = np.tile(np.arange(n_gauss), len(nodes))
        self._relative = np.concatenate(
            [
                -soil[np.arange(len(own)), own].reshape(-1, 2, N_SOIL),
                np.einsum("pki,pij->pkj", axes, rigid_motion(self.positions)),
            ],
            axis=2,
        )

    def relative_displacement(self, displacement: np.ndarray, motion: np.ndarray) -> np.ndarray:
        """Return pile minus soil (n_i, 2), local axes, of soil (node, 2) and pile motion (3,)."""
        soil = displacement.ravel()[self._point_dofs]
        pile = np.broadcast_to(motion, (len(soil), 3))
        return np.einsum("pkj,pj->pk", self._relative, np.concatenate([soil, pile], axis=1))

    def response(
        self, parameters: np.ndarray, traction_old: np.ndarray, slip_increment: np.ndarray
    ) -> InterfaceResponse:
        """Return the response to ``slip_increment`` (n_i, 2) from ``traction_old`` (n_i, 2)."""
        n_points = len(slip_increment)
        traction, tangent = np.empty((n_points, 2)), np.empty((n_points, 2, 2))
        status = np.zeros(n_points, dtype=np.int64)
        coulomb_interface.update_all(
            slip_increment, parameters, traction_old, traction, tangent, status
        )
        return InterfaceResponse(traction, tangent, status)

    def forces(self, traction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the internal forces on soil (node, 2) and pile (3,) of ``traction`` (n_i, 2).

        The pile's is the force and moment of the pile on the soil.
        """
        point_forces = np.einsum("p,pkj,pk->pj", self.areas, self._relative, traction)
        soil = np.bincount(
            self._point_dofs.ravel(), point_forces[:, :N_SOIL].ravel(), minlength=self.n_dofs
        )
        return soil.reshape(-1, 2), point_forces[:, N_SOIL:].sum(axis=0)

    def stiffness(self, tangent: np.ndarray) -> InterfaceStiffness:
        """Return the blocks of the stiffness of ``tangent`` (n_i, 2, 2)."""
        blocks = np.einsum(
            "p,pki,pkl,plj->pij", self.areas, self._relative, tangent, self._relative, optimize=True
        )
        blocks = blocks.reshape(-1, len(GAUSS_POINTS), N_SOIL + 3, N_SOIL + 3).sum(axis=1)
        soil_pile, pile_soil = np.zeros((self.n_dofs, 3)), np.zeros((self.n_dofs, 3))
        np.add.at(soil_pile, self._dofs, blocks[:, :N_SOIL, N_SOIL:])
        np.add.at(pile_soil, self._dofs, blocks[:, N_SOIL:, :N_SOIL].transpose(0, 2, 1))
        return InterfaceStiffness(
            dofs=self._dofs,
            soil=blocks[:, :N_SOIL, :N_SOIL],
            soil_pile=soil_pile,
            pile_soil=pile_soil.T,
            pile=blocks[:, N_SOIL:, N_SOIL:].sum(axis=0),
        )
