"""The soil as rings of quadratic triangles: strain, nodal forces and stiffness of the whole body.

Strain and stress live at the three points of the plane element.  The strain there is the mean of
the displacement's strain, weighted by the radius and the linear function L_q that is one at the
point and zero at the two others; the force is its dual,

    eps_q = int L_q eps(u) 2 pi r dA / w_q ,   w_q = int L_q 2 pi r dA ,
    f . u = sum_q w_q sigma_q : eps_q

With r = 1 this is the plane element, whose strain is linear.  The mean keeps what makes that
element good: a stress that is linear in a cell is integrated exactly, so undisturbed ground is in
balance, and incompressible soil puts three conditions on a cell, not one at every point, so that
nothing locks (Sloan and Randolph 1982).  The hoop strain u_r / r is never divided by r = 0.

Orders are those of ``soil_forms``; only the components xx, yy, zz (hoop) and xy are not zero.
Every rank of MPI computes the whole body: it is small.
"""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from handoff.fe_mesh import FEMesh
from install_mpm.assembly import sparsity_pattern
from service_fe import compat
from service_fe.partition import Partition

POINT_DEGREE = 2
"""The rule whose points carry the stress: three in a triangle."""

EXACT_DEGREE = 4
"""The rule of the integrals over a cell, which are cubic."""

N_POINTS, N_COMPONENTS, N_DOFS = 3, 4, 12
"""Points of a cell, strain components xx, yy, zz, xy, and displacements of a cell."""


def quadratic_shape(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return shape functions (n, 6) and reference gradients (n, 6, 2) of an ``FEMesh`` cell."""
    first = 1.0 - points.sum(axis=1)
    area = np.column_stack([first, points])
    slope = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
    start, end = [0, 1, 2], [1, 2, 0]
    shape = np.column_stack([area * (2.0 * area - 1.0), 4.0 * area[:, start] * area[:, end]])
    vertex = (4.0 * area - 1.0)[:, :, None] * slope
    middle = 4.0 * (area[:, start, None] * slope[end] + area[:, end, None] * slope[start])
    return shape, np.concatenate([vertex, middle], axis=1)


def linear_through(points: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return at ``at`` (n, 2) the linear functions (n, 3) that are one at one of three points."""
    monomials = np.column_stack([np.ones(len(at)), at])
    values: np.ndarray = monomials @ np.linalg.inv(np.column_stack([np.ones(3), points]))
    return values


class AxisymmetricForms:
    """Discrete body of revolution on a mesh (r, z) of six-node triangles.

    Raises
    ------
    ValueError
        If the mid-side nodes are not in the middle of straight edges, a node belongs to no cell, or
        the radius is negative.
    """

    def __init__(self, mesh: FEMesh) -> None:
        self.mesh = mesh
        self.n_dofs = 2 * len(mesh.nodes)
        self.row_of_dof = np.arange(self.n_dofs)
        corners = mesh.nodes[mesh.cell_nodes[:, :3]]
        middle = 0.5 * (corners + np.roll(corners, -1, axis=1))
        if np.abs(middle - mesh.nodes[mesh.cell_nodes[:, 3:]]).max() > 1e-9 * np.ptp(mesh.nodes):
            raise ValueError("a mid-side node is not in the middle of a straight edge of the mesh")
        if mesh.nodes[:, 0].min() < -1e-9 * np.ptp(mesh.nodes):
            raise ValueError("a body of revolution has no negative radius; move the mesh to r >= 0")
        if len(np.unique(mesh.cell_nodes)) < len(mesh.nodes):
            raise ValueError("the mesh has nodes that belong to no cell; remove them")
        self._pattern = sparsity_pattern([mesh.cell_nodes], len(mesh.nodes), 2)
        self._dofs = self._pattern.dofs[0]
        self._integrate(corners)
        self.matrix = self._empty_matrix()

    def _integrate(self, corners: np.ndarray) -> None:
        """Integrate strain operator, volumes and weight over the cells, (cell, 3, 2) corners."""
        points, _ = compat.quadrature_rule(POINT_DEGREE)
        exact, weights = compat.quadrature_rule(EXACT_DEGREE)
        edges = corners[:, 1:] - corners[:, :1]
        self.integration_positions = (
            corners[:, None, 0] + np.einsum("qr,cri->cqi", points, edges)
        ).reshape(-1, 2)
        shape, slope = quadratic_shape(exact)
        gradient = np.einsum("gar,cir->cgai", slope, np.linalg.inv(edges))
        radius = corners[:, :1, 0] + edges[:, :, 0] @ exact.T
        area = 2.0 * np.pi * np.abs(np.linalg.det(edges))[:, None] * weights
        linear = linear_through(points, exact)

        ring = area * radius
        volumes = ring @ linear
        slope_mean = np.einsum("cg,gq,cgai->cqai", ring, linear, gradient, optimize=True)
        hoop = np.einsum("cg,gq,ga->cqa", area, linear, shape, optimize=True)
        operator = np.zeros((len(corners), N_POINTS, N_COMPONENTS, 6, 2))
        operator[:, :, 0, :, 0] = slope_mean[..., 0]
        operator[:, :, 1, :, 1] = slope_mean[..., 1]
        operator[:, :, 2, :, 0] = hoop
        operator[:, :, 3] = slope_mean[..., ::-1] / np.sqrt(2.0)
        operator /= volumes[:, :, None, None, None]
        self._operator = operator.reshape(-1, N_POINTS * N_COMPONENTS, N_DOFS)
        self.integration_volumes = volumes.ravel()
        self.partition = Partition(MPI.COMM_SELF, np.arange(volumes.size))
        self._unit_weight = np.zeros((len(corners), 6, 2))
        self._unit_weight[:, :, 1] = ring @ shape

    def _empty_matrix(self) -> PETSc.Mat:
        """Return the matrix with the pattern of the cells."""
        size, pattern = (self.n_dofs, self.n_dofs), self._pattern
        rows = (pattern.indptr, pattern.indices, np.zeros(len(pattern.indices)))
        return PETSc.Mat().createAIJ(size, csr=rows, comm=PETSc.COMM_SELF)

    def strain(self, displacement: np.ndarray) -> np.ndarray:
        """Return the strain (n_q, 6), Mandel, of nodal displacements (node, 2) in m."""
        of_cell = displacement.ravel()[self._dofs]
        strain = np.zeros((len(self.integration_volumes), 6))
        strain[:, :N_COMPONENTS] = (self._operator @ of_cell[:, :, None]).reshape(-1, N_COMPONENTS)
        return strain

    def internal_force(self, stress: np.ndarray) -> np.ndarray:
        """Return the nodal forces (node, 2) in N of the Mandel stress (n_q, 6) in Pa."""
        force = self.integration_volumes[:, None] * stress[:, :N_COMPONENTS]
        of_cell = force.reshape(-1, 1, N_POINTS * N_COMPONENTS) @ self._operator
        return self._assembled(of_cell)

    def weight(self, unit_weight: np.ndarray) -> np.ndarray:
        """Return the nodal forces (node, 2) in N of gravity, ``unit_weight`` (n_q,) in N/m^3.

        A cell weighs the mean over its points.
        """
        of_cell = self.integration_volumes.reshape(-1, N_POINTS)
        weight = unit_weight.reshape(-1, N_POINTS) * of_cell
        mean = weight.sum(axis=1) / of_cell.sum(axis=1)
        return -self._assembled(mean[:, None, None] * self._unit_weight)

    def stiffness(self, tangent: np.ndarray) -> PETSc.Mat:
        """Return the stiffness in N/m of the tangent (n_q, 6, 6) in Pa.

        The same matrix is filled at each call.
        """
        modulus = self.integration_volumes[:, None, None] * tangent[:, :N_COMPONENTS, :N_COMPONENTS]
        by_point = self._operator.reshape(-1, N_COMPONENTS, N_DOFS)
        forces = (modulus @ by_point).reshape(self._operator.shape)
        blocks = self._operator.transpose(0, 2, 1) @ forces
        pattern = self._pattern
        values = np.bincount(
            pattern.slots[0].ravel(), blocks.ravel(), minlength=len(pattern.indices)
        )
        self.matrix.zeroEntries()  # also those between twins, which are not in the pattern
        self.matrix.setValuesCSR(pattern.indptr, pattern.indices, values)
        self.matrix.assemble()
        return self.matrix

    def rigid_modes(self) -> np.ndarray:
        """Return the nodal displacements (n_dofs, 1) of the one rigid motion, along the axis."""
        return np.tile([0.0, 1.0], len(self.mesh.nodes))[:, None]

    def _assembled(self, of_cell: np.ndarray) -> np.ndarray:
        """Return the sum (node, 2) at the nodes of the values of cells."""
        total = np.bincount(self._dofs.ravel(), of_cell.ravel(), minlength=self.n_dofs)
        return total.reshape(-1, 2)
