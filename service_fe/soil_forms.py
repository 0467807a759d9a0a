"""The soil as quadratic triangles or tetrahedra in dolfinx: strain, nodal forces and stiffness.

Everything outside this module is in the order of the ``FEMesh``: nodal arrays are (node, dim),
integration points run over its cells and, within a cell, over the points of the rule.  dolfinx
renumbers both and divides the cells among the ranks of MPI; the maps are made here once.  Nodal
arrays are whole on every rank, those of integration points hold the rank's own
(``partition``).  In plane strain only the three in-plane components xx,
yy, xy of the six-vectors enter the forms, because the out-of-plane strain is zero.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc

from handoff.fe_mesh import FEMesh
from install_mpm.constitutive.mandel import COLUMN, ROW, SCALE
from service_fe import compat
from service_fe.partition import Partition, gathered
from service_fe.rigid_pile import rigid_motion

DEGREE = 2
"""Exact for quadratic polynomials: three points in a triangle, four in a tetrahedron."""

COMPONENTS = {2: np.array([0, 1, 3]), 3: np.arange(6)}
"""Components of a Mandel six-vector (xx, yy, zz, xy, xz, yz) by dimension; in 2D yy is vertical."""

IDENTITY = {2: [1.0, 1.0, 0.0], 3: [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]}
"""The unit tensor in these components."""

BASIX_ORDER = {
    2: np.array([0, 1, 2, 4, 5, 3]),
    3: np.array([0, 1, 2, 3, 8, 9, 5, 7, 6, 4]),
}
"""Nodes of an ``FEMesh`` cell as basix orders them: the mid-side of the last edge comes first."""


def strain_vector(displacement: Any) -> Any:
    """Return the UFL vector of the ``COMPONENTS`` of the small strain, Mandel scaling."""
    strain = ufl.sym(ufl.grad(displacement))
    dim = strain.ufl_shape[0]
    return ufl.as_vector([SCALE[k] * strain[int(ROW[k]), int(COLUMN[k])] for k in COMPONENTS[dim]])


class SoilForms:
    """Discrete soil on a mesh of six-node triangles or ten-node tetrahedra.

    With ``mean_dilatation`` all points of a cell have its mean change of volume, beside their own
    shear, as in the installation.  The nodal forces stay those of the stress at each point, so
    that a stress which varies linearly in a cell keeps its balance.

    Raises
    ------
    ValueError
        If the mid-side nodes are not in the middle of straight edges, or a node belongs to no cell.
    """

    def __init__(self, mesh: FEMesh, *, mean_dilatation: bool = False) -> None:
        self.mesh, self.mean_dilatation = mesh, mean_dilatation
        self.dim = mesh.nodes.shape[1]
        self.n_dofs = mesh.nodes.size
        self._components = COMPONENTS[self.dim]
        vertices, cell_vertices = np.unique(mesh.cell_nodes[:, : self.dim + 1], return_inverse=True)
        with compat.quiet_compiler():
            self.domain = compat.make_simplex_mesh(
                mesh.nodes[vertices], cell_vertices.reshape(-1, self.dim + 1)
            )
            cells = np.asarray(self.domain.topology.original_cell_index, dtype=np.int64)
            self._cells = cells[: compat.n_own_cells(self.domain)]
            self._own_cells = np.sort(self._cells)
            self._place = np.searchsorted(self._own_cells, self._cells)
            self.space = compat.make_displacement_space(self.domain)
            self._blocks = compat.cell_blocks(self.space, len(self._cells))
            self._nodes = mesh.cell_nodes[self._cells][:, BASIX_ORDER[self.dim]]
            self.row_of_dof = self._row_of_dof()
            self._make_forms()

    def _row_of_dof(self) -> np.ndarray:
        """Return the matrix row (n_dofs,) of each displacement dim * node + axis."""
        comm, blocks = MPI.COMM_WORLD, compat.global_blocks(self.space, self._blocks)
        node_block = np.full(len(self.mesh.nodes), -1)
        node_block[gathered(comm, self._nodes)] = gathered(comm, blocks)
        if (node_block < 0).any():
            raise ValueError("the mesh has nodes that belong to no cell; remove them")
        place = self.space.tabulate_dof_coordinates()[self._blocks][..., : self.dim]
        off = np.abs(place - self.mesh.nodes[self._nodes]).max(initial=0.0, keepdims=True).ravel()
        if gathered(comm, off).max() > 1e-9 * np.ptp(self.mesh.nodes):
            raise ValueError("a mid-side node is not in the middle of a straight edge of the mesh")
        return (self.dim * node_block[:, None] + np.arange(self.dim)).ravel()

    def _make_forms(self) -> None:
        points, weights = compat.quadrature_rule(DEGREE, self.dim)
        corners = self.mesh.nodes[self.mesh.cell_nodes[:, : self.dim + 1]]
        edges = corners[:, 1:] - corners[:, :1]
        self.integration_positions = (
            corners[:, None, 0] + np.einsum("qr,cri->cqi", points, edges)
        ).reshape(-1, self.dim)
        self.integration_volumes = np.outer(np.abs(np.linalg.det(edges)), weights).ravel()
        own_points = self._own_cells[:, None] * len(weights) + np.arange(len(weights))
        self.partition = Partition(MPI.COMM_WORLD, own_points.ravel())
        self._node_of_block = np.full(compat.n_blocks(self.space), -1)
        self._node_of_block[self._blocks] = self._nodes
        self._is_used = self._node_of_block >= 0
        self._used_nodes = self._node_of_block[self._is_used]

        n_components = len(self._components)
        dx = compat.make_measure(self.domain, DEGREE)
        test, trial = ufl.TestFunction(self.space), ufl.TrialFunction(self.space)
        self._displacement = fem.Function(self.space)
        self._stress = fem.Function(
            compat.make_quadrature_space(self.domain, (n_components,), DEGREE)
        )
        self._tangent = fem.Function(
            compat.make_quadrature_space(self.domain, (n_components, n_components), DEGREE)
        )
        self._unit_weight = fem.Function(compat.make_quadrature_space(self.domain, (), DEGREE))
        self._unit_weight_rows = self._quadrature_rows(self._unit_weight)
        self._stress_rows = self._quadrature_rows(self._stress)
        self._tangent_rows = self._quadrature_rows(self._tangent)
        self._strain = fem.Expression(self._deformation(self._displacement), points)
        self._force_form = fem.form(ufl.dot(self._stress, strain_vector(test)) * dx)
        self._stiffness_form = fem.form(
            ufl.dot(strain_vector(test), ufl.dot(self._tangent, self._deformation(trial))) * dx
        )
        self._weight_form = fem.form(self._unit_weight * test[self.dim - 1] * dx)
        self.matrix: PETSc.Mat = compat.make_matrix(self._stiffness_form)

    def _deformation(self, displacement: Any) -> Any:
        """Return the UFL vector of the strain, its volumetric part that of the cell if so wished.

        In a straight cell the dilatation is linear, so its mean is that of the middle, to which it
        is continued from each point.
        """
        strain = strain_vector(displacement)
        if not self.mean_dilatation:
            return strain
        growth = ufl.dot(self._to_middle(), ufl.grad(ufl.div(displacement)))
        return strain + growth / self.dim * ufl.as_vector(IDENTITY[self.dim])

    def _to_middle(self) -> Any:
        """Return the vectors in m from the integration points to the middle of their cells."""
        space = compat.make_quadrature_space(self.domain, (self.dim,), DEGREE)
        way = fem.Function(space)
        middle = self.mesh.nodes[self.mesh.cell_nodes[:, : self.dim + 1]].mean(axis=1)
        per_cell = len(self.integration_positions) // len(middle)
        off = np.repeat(middle, per_cell, axis=0) - self.integration_positions
        rows = self._quadrature_rows(way)
        way.x.array.reshape(-1, self.dim)[rows] = off[self.partition.own_points]
        return way

    def _quadrature_rows(self, function: Any) -> np.ndarray:
        """Return the row in the values of ``function`` of each own integration point (n,)."""
        blocks = compat.cell_blocks(function.function_space, len(self._cells))
        rows = np.empty_like(blocks)
        rows[self._place] = blocks
        return rows.ravel()

    def strain(self, displacement: np.ndarray) -> np.ndarray:
        """Return the strain (n, 6), Mandel, of nodal displacements (node, dim) in m."""
        values = self._displacement.x.array.reshape(-1, self.dim)
        values[self._is_used] = displacement[self._used_nodes]
        by_cell = compat.evaluate(self._strain, self.domain, len(self._cells))
        in_order = np.empty_like(by_cell)
        in_order[self._place] = by_cell
        strain = np.zeros((len(self.partition.own_points), 6))
        strain[:, self._components] = in_order.reshape(len(strain), -1)
        return strain

    def internal_force(self, stress: np.ndarray) -> np.ndarray:
        """Return the nodal forces (node, dim) in N of the Mandel stress (n, 6) in Pa."""
        values = stress[:, self._components]
        self._stress.x.array.reshape(-1, values.shape[1])[self._stress_rows] = values
        return self._assembled(self._force_form)

    def weight(self, unit_weight: np.ndarray) -> np.ndarray:
        """Return the nodal forces (node, dim) in N of gravity, ``unit_weight`` (n,) in N/m^3."""
        self._unit_weight.x.array[self._unit_weight_rows] = unit_weight
        return -self._assembled(self._weight_form)

    def stiffness(self, tangent: np.ndarray) -> PETSc.Mat:
        """Return the stiffness in N/m, rows ``row_of_dof``, of the tangent (n, 6, 6) in Pa.

        The same matrix is filled at each call.
        """
        values = tangent[:, self._components[:, None], self._components].reshape(len(tangent), -1)
        self._tangent.x.array.reshape(-1, values.shape[1])[self._tangent_rows] = values
        compat.assemble_into_matrix(self.matrix, self._stiffness_form)
        return self.matrix

    def rigid_modes(self) -> np.ndarray:
        """Return the nodal displacements (n_dofs, n_motions) of rigid motions."""
        return rigid_motion(self.mesh.nodes).reshape(self.n_dofs, -1)

    def _assembled(self, form: Any) -> np.ndarray:
        """Return the nodal values (node, dim) of a form, of all ranks together."""
        own = compat.assemble_into_array(form, self.dim * len(self._is_used))
        total = np.zeros((len(self.mesh.nodes), self.dim))
        total[self._used_nodes] = own.reshape(-1, self.dim)[self._is_used]
        return self.partition.sum_of(total)
