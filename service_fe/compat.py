"""Every difference between the supported dolfinx releases, 0.5.2 and 0.9.0, and nowhere else.

h5py is imported before dolfinx by the package's ``__init__``.  No dolfinx solver, boundary
condition, lifting or mesh reader is used anywhere: those are what changes most between releases.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import basix
import dolfinx
import dolfinx.fem.petsc
import numpy as np
import ufl
from dolfinx import fem
from dolfinx.mesh import create_mesh
from mpi4py import MPI
from petsc4py import PETSc

for _name in ("FFCx", "UFL"):
    logging.getLogger(_name).setLevel(logging.WARNING)

VERSION = tuple(int(part) for part in dolfinx.__version__.split(".")[:2])
HAS_BASIX_UFL = VERSION >= (0, 6)
"""Elements come from ``basix.ufl`` instead of classic UFL, spaces from ``fem.functionspace``."""

if HAS_BASIX_UFL:
    import basix.ufl

CELLS = {2: "triangle", 3: "tetrahedron"}
"""Reference cell by dimension."""

SCHEME = "default"


@contextmanager
def quiet_compiler() -> Iterator[None]:
    """Keep the C compiler's command lines out of the log while forms are compiled.

    With dolfinx 0.5 distutils lowers the threshold of the root logger and writes them there.
    """
    root = logging.getLogger()
    level, disabled = root.level, root.manager.disable
    logging.disable(logging.INFO)
    try:
        yield
    finally:
        logging.disable(disabled)
        root.setLevel(level)


def quadrature_rule(degree: int, dim: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """Return the rule of forms of ``degree`` on a simplex: points (n, dim) and weights (n,)."""
    points, weights = basix.make_quadrature(getattr(basix.CellType, CELLS[dim]), degree)
    return np.asarray(points).reshape(-1, dim), np.asarray(weights)


def make_simplex_mesh(vertices: np.ndarray, cells: np.ndarray) -> Any:
    """Return a dolfinx mesh of straight simplices (n, dim + 1) on ``vertices`` (m, dim) in m.

    The first rank's are divided among all; those given by other ranks are left out.
    """
    comm, dim = MPI.COMM_WORLD, vertices.shape[1]
    if comm.rank > 0:
        vertices, cells = vertices[:0], cells[:0]
    rows = np.ascontiguousarray(cells, dtype=np.int64)
    if HAS_BASIX_UFL:
        element = basix.ufl.element("Lagrange", CELLS[dim], 1, shape=(dim,))
        return create_mesh(comm, rows, vertices, ufl.Mesh(element))
    return create_mesh(comm, rows, vertices, ufl.Mesh(ufl.VectorElement("Lagrange", CELLS[dim], 1)))


def make_displacement_space(mesh: Any) -> Any:
    """Return the space of continuous, piecewise quadratic displacements."""
    dim = mesh.topology.dim
    if HAS_BASIX_UFL:
        return fem.functionspace(mesh, basix.ufl.element("Lagrange", CELLS[dim], 2, shape=(dim,)))
    return fem.FunctionSpace(mesh, ufl.VectorElement("Lagrange", CELLS[dim], 2))


def make_quadrature_space(mesh: Any, shape: tuple[int, ...], degree: int) -> Any:
    """Return the space of values of ``shape`` at the integration points of ``degree``."""
    cell = CELLS[mesh.topology.dim]
    if HAS_BASIX_UFL:
        element = basix.ufl.quadrature_element(
            cell, value_shape=shape, degree=degree, scheme=SCHEME
        )
        return fem.functionspace(mesh, element)
    if len(shape) == 0:
        element = ufl.FiniteElement("Quadrature", cell, degree, quad_scheme=SCHEME)
    elif len(shape) == 1:
        element = ufl.VectorElement("Quadrature", cell, degree, shape[0], quad_scheme=SCHEME)
    else:
        element = ufl.TensorElement("Quadrature", cell, degree, shape, quad_scheme=SCHEME)
    return fem.FunctionSpace(mesh, element)


def make_measure(mesh: Any, degree: int) -> Any:
    """Return the volume measure with the integration points of ``degree``."""
    return ufl.Measure("dx", domain=mesh, metadata={"quadrature_degree": degree})


def evaluate(expression: Any, mesh: Any, n_cells: int) -> np.ndarray:
    """Return the values (cell, point * component) of a compiled expression in the first cells."""
    cells = np.arange(n_cells, dtype=np.int32)
    values = expression.eval(mesh, cells) if HAS_BASIX_UFL else expression.eval(cells)
    return np.asarray(values).reshape(n_cells, -1)


def cell_blocks(space: Any, n_cells: int) -> np.ndarray:
    """Return the blocks of unknowns (cell, n) of ``space`` in the order of its reference cell."""
    dofs = space.dofmap.list
    array = dofs.array if hasattr(dofs, "array") else dofs
    return (
        np.asarray(array).reshape(-1, space.dofmap.dof_layout.num_dofs)[:n_cells].astype(np.int64)
    )


def n_own_cells(mesh: Any) -> int:
    """Return the number of cells of this rank; they come before those it shares."""
    return int(mesh.topology.index_map(mesh.topology.dim).size_local)


def n_blocks(space: Any) -> int:
    """Return the number of blocks of unknowns on this rank, shared ones among them."""
    index_map = space.dofmap.index_map
    return int(index_map.size_local + index_map.num_ghosts)


def global_blocks(space: Any, blocks: np.ndarray) -> np.ndarray:
    """Return the numbers over all ranks of ``blocks`` of this one."""
    flat = space.dofmap.index_map.local_to_global(blocks.ravel().astype(np.int32))
    return np.asarray(flat, dtype=np.int64).reshape(blocks.shape)


def assemble_into_array(form: Any, size: int) -> np.ndarray:
    """Return the assembled linear form as an array (size,)."""
    vector = np.zeros(size)
    fem.assemble_vector(vector, form)
    return vector


def make_matrix(form: Any) -> PETSc.Mat:
    """Return an empty PETSc matrix with the sparsity pattern of ``form``."""
    return fem.petsc.create_matrix(form)


def assemble_into_matrix(matrix: PETSc.Mat, form: Any) -> None:
    """Fill ``matrix`` with the assembled bilinear form, without boundary conditions."""
    matrix.zeroEntries()
    fem.petsc.assemble_matrix(matrix, form)
    matrix.assemble()
