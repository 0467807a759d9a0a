"""The soil as quadratic triangles in dolfinx: strain, nodal forces and stiffness.

Everything outside this module is in the order of the ``FEMesh``: nodal arrays are (node, 2),
integration points run over its cells and, within a cell, over the points of the rule.  dolfinx
renumbers both; the maps are made here once.  Only the three in-plane components xx, yy, xy of the
six-vectors enter the forms, because the out-of-plane strain is zero.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc

from handoff.fe_mesh import FEMesh
from service_fe import compat

DEGREE = 2
"""Integration is exact for quadratic polynomials: three points in a triangle."""

IN_PLANE = np.array([0, 1, 3])
"""Components xx, yy, xy of a Mandel six-vector; axis 1 is the vertical."""

BASIX_ORDER = np.array([0, 1, 2, 4, 5, 3])
"""Nodes of an ``FEMesh`` cell (mid-sides 01, 12, 20) as basix orders them (12, 02, 01)."""


def in_plane_strain(displacement: Any) -> Any:
    """Return the UFL vector (xx, yy, xy) of the small strain, Mandel scaling."""
    strain = ufl.sym(ufl.grad(displacement))
    return ufl.as_vector([strain[0, 0], strain[1, 1], np.sqrt(2.0) * strain[0, 1]])


class SoilForms:
    """Discrete soil on a mesh of six-node triangles.

    Raises
    ------
    ValueError
        If the mid-side nodes are not in the middle of straight edges, or more than one rank is
        used.
    """

    def __init__(self, mesh: FEMesh) -> None:
        if MPI.COMM_WORLD.size > 1:
            raise ValueError("the service stage runs on one rank; start it without mpirun")
        self.mesh = mesh
        self.n_dofs = 2 * len(mesh.nodes)
        vertices, triangles = np.unique(mesh.cell_nodes[:, :3], return_inverse=True)
        triangles = triangles.reshape(-1, 3)
        with compat.quiet_compiler():
            self.domain = compat.make_triangle_mesh(mesh.nodes[vertices], triangles)
            cells = self.domain.topology.original_cell_index
            self.original_cell = np.asarray(cells, dtype=np.int64)
            self.space = compat.make_displacement_space(self.domain)
            self.row_of_dof = self._row_of_dof()
            self._make_forms()

    def _row_of_dof(self) -> np.ndarray:
        """Return the matrix row (n_dofs,) of each displacement 2 * node + axis."""
        blocks = compat.cell_blocks(self.space, len(self.original_cell))
        node_block = np.full(len(self.mesh.nodes), -1)
        node_block[self.mesh.cell_nodes[self.original_cell][:, BASIX_ORDER]] = blocks
        if (node_block < 0).any():
            raise ValueError("the mesh has nodes that belong to no cell; remove them")
        place = self.space.tabulate_dof_coordinates()[node_block, :2]
        if np.abs(place - self.mesh.nodes).max() > 1e-9 * np.ptp(self.mesh.nodes):
            raise ValueError("a mid-side node is not in the middle of a straight edge of the mesh")
        return (2 * node_block[:, None] + np.arange(2)).ravel()

    def _make_forms(self) -> None:
        points, weights = compat.quadrature_rule(DEGREE)
        corners = self.mesh.nodes[self.mesh.cell_nodes[:, :3]]
        edges = corners[:, 1:] - corners[:, :1]
        self.integration_positions = (
            corners[:, None, 0] + np.einsum("qr,cri->cqi", points, edges)
        ).reshape(-1, 2)
        self.integration_volumes = np.outer(np.abs(np.linalg.det(edges)), weights).ravel()

        dx = compat.make_measure(self.domain, DEGREE)
        test, trial = ufl.TestFunction(self.space), ufl.TrialFunction(self.space)
        self._displacement = fem.Function(self.space)
        self._stress = fem.Function(compat.make_quadrature_space(self.domain, (3,), DEGREE))
        self._tangent = fem.Function(compat.make_quadrature_space(self.domain, (3, 3), DEGREE))
        self._unit_weight = fem.Function(compat.make_quadrature_space(self.domain, (), DEGREE))
        self._unit_weight_rows = self._quadrature_rows(self._unit_weight)
        self._stress_rows = self._quadrature_rows(self._stress)
        self._tangent_rows = self._quadrature_rows(self._tangent)
        strain = in_plane_strain(self._displacement)
        self._strain = fem.Expression(strain, points)
        self._force_form = fem.form(ufl.dot(self._stress, in_plane_strain(test)) * dx)
        self._stiffness_form = fem.form(
            ufl.dot(in_plane_strain(test), ufl.dot(self._tangent, in_plane_strain(trial))) * dx
        )
        self._weight_form = fem.form(self._unit_weight * test[1] * dx)
        self.matrix: PETSc.Mat = compat.make_matrix(self._stiffness_form)

    def _quadrature_rows(self, function: Any) -> np.ndarray:
        """Return the row in the values of ``function`` of each integration point (n_q,)."""
        blocks = compat.cell_blocks(function.function_space, len(self.original_cell))
        rows = np.empty_like(blocks)
        rows[self.original_cell] = blocks
        return rows.ravel()

    def strain(self, displacement: np.ndarray) -> np.ndarray:
        """Return the strain (n_q, 6), Mandel, of nodal displacements (node, 2) in m."""
        self._displacement.x.array[self.row_of_dof] = displacement.ravel()
        by_cell = compat.evaluate(self._strain, self.domain, len(self.original_cell))
        in_order = np.empty_like(by_cell)
        in_order[self.original_cell] = by_cell
        strain = np.zeros((len(self.integration_volumes), 6))
        strain[:, IN_PLANE] = in_order.reshape(-1, 3)
        return strain

    def internal_force(self, stress: np.ndarray) -> np.ndarray:
        """Return the nodal forces (node, 2) in N of the Mandel stress (n_q, 6) in Pa."""
        self._stress.x.array.reshape(-1, 3)[self._stress_rows] = stress[:, IN_PLANE]
        return self._assembled(self._force_form)

    def weight(self, unit_weight: np.ndarray) -> np.ndarray:
        """Return the nodal forces (node, 2) in N of gravity, ``unit_weight`` (n_q,) in N/m^3."""
        self._unit_weight.x.array[self._unit_weight_rows] = unit_weight
        return -self._assembled(self._weight_form)

    def stiffness(self, tangent: np.ndarray) -> PETSc.Mat:
        """Return the stiffness in N/m, rows ``row_of_dof``, of the tangent (n_q, 6, 6) in Pa.

        The same matrix is filled at each call.
        """
        values = tangent[:, IN_PLANE[:, None], IN_PLANE].reshape(-1, 9)
        self._tangent.x.array.reshape(-1, 9)[self._tangent_rows] = values
        compat.assemble_into_matrix(self.matrix, self._stiffness_form)
        return self.matrix

    def _assembled(self, form: Any) -> np.ndarray:
        return compat.assemble_into_array(form, self.n_dofs)[self.row_of_dof].reshape(-1, 2)
