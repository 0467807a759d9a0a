"""What the set-up promises: libraries that load together, OpenBLAS behind MUMPS, fixed threads."""

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def python(code: str) -> str:
    result = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stderr
    return result.stdout


@pytest.mark.dolfinx
@pytest.mark.gmsh
@pytest.mark.parametrize("order", ["dolfinx, h5py", "h5py, dolfinx", "service_fe, dolfinx, h5py"])
def test_libraries_load_together_in_any_order(order: str) -> None:
    python(f"import {order}; from petsc4py import PETSc; import numba, gmsh, scipy.spatial, meshio")


MUMPS = """
import numpy as np
from petsc4py import PETSc
from scipy.sparse import diags, eye, kron
n = 40
second_difference = diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(n, n))
a = (kron(eye(n), second_difference) + kron(second_difference, eye(n))).tocsr()
matrix = PETSc.Mat().createAIJ(a.shape, csr=(a.indptr, a.indices, a.data))
solver = PETSc.KSP().create()
solver.setOperators(matrix)
solver.setType("preonly")
solver.getPC().setType("lu")
solver.getPC().setFactorSolverType("mumps")
x, b = matrix.createVecs()
b.set(1.0)
solver.solve(b, x)
assert np.abs(a @ x.array - 1.0).max() < 1e-10
print(sorted({line.split()[-1] for line in open("/proc/self/maps") if "blas" in line}))
"""


@pytest.mark.dolfinx
def test_mumps_solves_with_openblas() -> None:
    libraries = python(MUMPS)
    assert "openblas" in libraries, libraries


FORM = """
import service_fe, dolfinx, ufl, numpy as np
from mpi4py import MPI
from dolfinx import fem, mesh
domain = mesh.create_unit_square(MPI.COMM_WORLD, 2, 2)
x = ufl.SpatialCoordinate(domain)
print(fem.assemble_scalar(fem.form(x[0] * ufl.dx)))
"""


@pytest.mark.dolfinx
def test_forms_are_compiled() -> None:
    assert float(python(FORM).split()[-1]) == pytest.approx(0.5)


def test_environment_sets_what_is_not_set_and_keeps_what_is() -> None:
    command = ". script/environment && echo $OMP_NUM_THREADS $NUMBA_NUM_THREADS $MPLBACKEND"
    plain = {"PATH": os.environ["PATH"]}
    for given, expected in (
        ({}, f"1 {min(2, len(os.sched_getaffinity(0)))} Agg"),
        ({"OMP_NUM_THREADS": "3", "NUMBA_NUM_THREADS": "5", "MPLBACKEND": "pdf"}, "3 5 pdf"),
    ):
        result = subprocess.run(
            ["bash", "-euc", command],
            cwd=ROOT,
            env={**plain, **given},
            capture_output=True,
            text=True,
            check=True,
        )
        assert result.stdout.strip() == expected


def test_every_package_is_installed() -> None:
    listed = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    packages = set(listed["tool"]["setuptools"]["packages"])
    found = {
        init.parent.relative_to(ROOT).as_posix().replace("/", ".")
        for top in ("install_mpm", "handoff", "service_fe", "workflows")
        for init in (ROOT / top).rglob("__init__.py")
    }
    assert packages == found
