"""Interface between pile and soil in the finite-element model: zero-thickness quadratic elements.

The soil side is a facet of a quadratic triangle or tetrahedron, the pile side moves rigidly or, on
a deformable pile, has nodes of its own.  With the relative displacement

    w = G (u, q) ,   G = [-N, T] in local axes (tangential, normal), pile minus soil,

the traction t(w) on the soil gives the forces int G^T t and the stiffness int G^T D G.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from handoff.facet_points import FacetPoints, NormalsOf, facet_points
from handoff.fe_mesh import FEMesh
from install_mpm.constitutive import coulomb_interface
from install_mpm.conventions import Kinematics
from install_mpm.interface_axes import axes_of
from install_mpm.pile import surface_normals
from service_fe.kinematics import width
from service_fe.rigid_pile import rigid_motion


def flat_normals(facets: FacetPoints) -> np.ndarray:
    """Return the normals (n_i, 2) of a flat-ended pile, those of its parts.

    Raises
    ------
    ValueError
        If the pile is one in space, which has normals of its own.
    """
    dim, parts = facets.coordinates.shape[1], facets.parts
    if dim == 3 and len(parts):
        raise ValueError("a pile in space has no flat normals; give those of its surface")
    return surface_normals(parts).reshape(-1, dim)


class InterfaceResponse(NamedTuple):
    """Interface at all its integration points after an increment of relative displacement."""

    traction: np.ndarray
    """Traction on the soil (n_i, dim) in Pa, (tangential ..., normal)."""
    tangent: np.ndarray
    """Consistent tangent (n_i, dim, dim) in Pa/m."""
    status: np.ndarray
    """``STICK``, ``SLIP`` or ``OPEN`` (n_i,)."""


class InterfaceStiffness(NamedTuple):
    """Blocks of the stiffness that couple soil (s) and pile (p)."""

    dofs: np.ndarray
    """Displacements dim * node + axis (n_element, n_soil) of the meshed side, or sides."""
    soil: np.ndarray
    """K_ss (n_element, n_soil, n_soil)."""
    soil_pile: np.ndarray
    """K_sp (n_dofs, n_motions)."""
    pile_soil: np.ndarray
    """K_ps (n_motions, n_dofs)."""
    pile: np.ndarray
    """K_pp (n_motions, n_motions)."""


def facet_geometry(mesh: FEMesh, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray | None]:
    """Return sizes (n,) in m or m^2 of facets and, in space, normals (n, 3) out of the soil.

    ``nodes`` (n, n_facet_nodes) are those of the facets.

    None in the plane, where the surface of the pile is made of straight lines and the exact normals
    are those of its edges.
    """
    corners = mesh.nodes[nodes[:, : mesh.nodes.shape[1]]]
    if corners.shape[1] == 2:
        return np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1), None
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    twice_area = np.linalg.norm(normal, axis=1)
    return 0.5 * twice_area, normal / twice_area[:, None]


def _dofs_of(nodes: np.ndarray, dim: int) -> np.ndarray:
    """Return the displacements dim * node + axis (n, n_nodes * dim) of ``nodes`` (n, n_nodes)."""
    dofs: np.ndarray = dim * nodes[:, :, None] + np.arange(dim)
    return dofs.reshape(len(nodes), nodes.shape[1] * dim)


class InterfaceForms:
    """Discrete interface on the pile's facets of a mesh; there may be none.

    ``normals`` gives those of the pile's surface.  ``twin`` (node,) is the node on the
    pile's side of a node of the soil; facets whose nodes have none (-1) face a rigid pile, as all
    do without it.
    """

    def __init__(
        self,
        mesh: FEMesh,
        kinematics: Kinematics = Kinematics.PLANE_STRAIN,
        normals: NormalsOf = flat_normals,
        twin: np.ndarray | None = None,
    ) -> None:
        self.facets = facets = facet_points(mesh)
        nodes, shape, weights = facets.nodes, facets.shape_values, facets.weights
        self.n_dofs, self.n_points = mesh.nodes.size, len(weights)
        self.positions, self.parts = facets.positions, facets.parts
        self.normals = normals(facets)
        sizes, of_facet = facet_geometry(mesh, nodes)
        is_plane = of_facet is None
        self.facet_normals = self.normals if is_plane else np.repeat(of_facet, len(weights), axis=0)
        self.areas = np.outer(sizes, weights).ravel() * width(self.positions, kinematics)
        self._dofs = _dofs_of(nodes, mesh.nodes.shape[1])
        self._relative = self._against_rigid_pile(shape)
        if twin is not None:
            self._dofs, self._relative = self._against_twins(nodes, twin)
        self.n_soil = self._dofs.shape[1]
        self._point_dofs = np.repeat(self._dofs, len(weights), axis=0)

    def _against_rigid_pile(self, shape: np.ndarray) -> np.ndarray:
        """Return G (n_i, dim, n_soil + n_motions) of all points."""
        axes = axes_of(self.normals, self.positions)
        own = np.tile(shape, (len(self._dofs), 1))
        soil = -np.einsum("pki,pa->pkai", axes, own).reshape(*axes.shape[:2], self._dofs.shape[1])
        pile = np.einsum("pki,pij->pkj", axes, rigid_motion(self.positions))
        return np.concatenate([soil, pile], axis=2)

    def _against_twins(self, nodes: np.ndarray, twin: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return displacements and G of both sides; a facet (n, n_nodes) without twins keeps its G.

        It then has its own nodes on the other side as well, with G zero.
        """
        is_rigid = (twin[nodes] < 0).all(axis=1)
        other = np.where(is_rigid[:, None], nodes, twin[nodes])
        soil, rigid = np.split(self._relative, [self._dofs.shape[1]], axis=2)
        at_point = np.repeat(is_rigid, self.n_points)[:, None, None]
        dofs = np.hstack([self._dofs, _dofs_of(other, self.facet_normals.shape[1])])
        relative = [soil, np.where(at_point, 0.0, -soil), np.where(at_point, rigid, 0.0)]
        return dofs, np.concatenate(relative, axis=2)

    def relative_displacement(self, displacement: np.ndarray, motion: np.ndarray) -> np.ndarray:
        """Return pile minus soil (n_i, dim), local axes.

        Of the displacement of the soil (node, dim) and the motion (n_motions,) of the pile.
        """
        soil = displacement.ravel()[self._point_dofs]
        pile = np.broadcast_to(motion, (len(soil), len(motion)))
        return np.einsum("pkj,pj->pk", self._relative, np.concatenate([soil, pile], axis=1))

    def response(
        self, parameters: np.ndarray, traction_old: np.ndarray, slip_increment: np.ndarray
    ) -> InterfaceResponse:
        """Return the response to ``slip_increment`` (n_i, dim) from ``traction_old`` (n_i, dim)."""
        n_points, dim = slip_increment.shape
        traction, tangent = np.empty((n_points, dim)), np.empty((n_points, dim, dim))
        status = np.zeros(n_points, dtype=np.int64)
        coulomb_interface.update_all(
            slip_increment, parameters, traction_old, traction, tangent, status
        )
        return InterfaceResponse(traction, tangent, status)

    def forces(self, traction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the internal forces on soil (node, dim) and pile (n_motions,).

        ``traction`` is (n_i, dim).  The pile's is the force and moment of the pile on the soil.
        """
        point_forces = np.einsum("p,pkj,pk->pj", self.areas, self._relative, traction)
        soil = np.bincount(
            self._point_dofs.ravel(), point_forces[:, : self.n_soil].ravel(), minlength=self.n_dofs
        )
        return soil.reshape(-1, traction.shape[1]), point_forces[:, self.n_soil :].sum(axis=0)

    def stiffness(self, tangent: np.ndarray) -> InterfaceStiffness:
        """Return the blocks of the stiffness of ``tangent`` (n_i, dim, dim)."""
        blocks = np.einsum(
            "p,pki,pkl,plj->pij", self.areas, self._relative, tangent, self._relative, optimize=True
        )
        size = blocks.shape[1]
        blocks = blocks.reshape(-1, self.n_points, size, size).sum(axis=1)
        soil_pile = np.zeros((self.n_dofs, size - self.n_soil))
        pile_soil = np.zeros_like(soil_pile)
        np.add.at(soil_pile, self._dofs, blocks[:, : self.n_soil, self.n_soil :])
        np.add.at(pile_soil, self._dofs, blocks[:, self.n_soil :, : self.n_soil].transpose(0, 2, 1))
        return InterfaceStiffness(
            dofs=self._dofs,
            soil=blocks[:, : self.n_soil, : self.n_soil],
            soil_pile=soil_pile,
            pile_soil=pile_soil.T,
            pile=blocks[:, self.n_soil :, self.n_soil :].sum(axis=0),
        )
