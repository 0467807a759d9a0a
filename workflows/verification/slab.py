"""Plane strain in space: a slab between two smooth planes does what its plane section does.

A block is sheared and pressed in steps by given motions of its sides: uniformly, where both must
agree to round-off, and with a fixed base and a sheared top, where tetrahedra and triangles
converge to one result.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.constitutive.parameters import (
    HenckyElastic,
    MohrCoulomb,
    SoilParameters,
    VonMises,
)
from install_mpm.conventions import Unit
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import Ground
from install_mpm.material_points import cauchy_stress
from install_mpm.options import Numerics
from workflows.verification.body import Body, advance, make_body
from workflows.verification.problem import Check, Outcome, Problem, at_least, at_most
from workflows.verification.rectangle import rectangle_mesh
from workflows.verification.solid_meshes import box_mesh
from workflows.verification.uniform_stress import with_stress

STEPS = 8
UNIFORM = Numerics(tolerance=1e-12)
NUMERICS = Numerics(tolerance=1e-10, volumetric_term=0.0)
SAME = 1e-9
FINEST_2D = 32
CELLS = (2, 4, 8)

Stress = Annotated[float, Unit("Pa")]


def uniform_slab(
    *, E: Stress = 1e6, nu: float = 0.3, su: Stress = 10e3, p0: Stress = 20e3,
    phi: Annotated[float, Unit("rad")] = float(np.radians(30.0)),
    stretch: float = 0.2, shear: float = 0.3,
) -> Outcome:  # fmt: skip
    """Return how far the stress in a slab is from plane strain, in three soils.

    The block is stretched by ``stretch`` to one side, pressed together to the other, sheared by
    ``shear`` and turned; at the start it is under the pressure p0.
    """
    soils: dict[str, SoilParameters] = {
        "elastic": HenckyElastic(E, nu),
        "von Mises": VonMises(E, nu, su),
        "Mohr-Coulomb": MohrCoulomb(E, nu, 0.0, phi),
    }
    checks: list[Check] = []
    residuals: list[tuple[float, ...]] = []
    for name, soil in soils.items():
        plane, space = (
            _deformed(_mesh(dim, 2), soil, p0, _uniform(stretch, shear)) for dim in (2, 3)
        )
        scale = np.abs(plane[0]).max()
        checks += [
            at_most(f"{name}: scatter of stress over its largest component",
                    np.ptp(space[0], axis=0).max() / scale, SAME),
            at_most(f"{name}: distance of stress from plane strain over its largest component",
                    np.abs(space[0][0] - plane[0][0]).max() / scale, SAME),
            at_most(f"{name}: distance of the support force from plane strain over the larger",
                    np.abs(space[1] / plane[1] - 1.0).max(), SAME),
        ]  # fmt: skip
        residuals += plane[2] + space[2]
    return Outcome(tuple(checks), residual_histories=tuple(residuals))


def sheared_slab(*, E: Stress = 1e6, nu: float = 0.3, shear: float = 0.1) -> Outcome:
    """Return the force on the top of a sheared block with free sides, on three meshes."""
    soil = HenckyElastic(E, nu)
    finest, history = _sheared_force(_mesh(2, FINEST_2D), soil, shear)
    errors, residuals = {}, [history]
    for dim in (2, 3):
        for n in CELLS:
            force, history = _sheared_force(_mesh(dim, n), soil, shear)
            errors[dim, n] = force / finest - 1.0
            residuals.append(history)
    plane, space = ([errors[dim, n] for n in CELLS] for dim in (2, 3))
    return Outcome(
        (
            at_most("8 cells: force over that of the finest plane mesh, less 1", space[-1], 5e-3),
            at_least("fall of the error from 2 to 8 cells", abs(space[0] / space[-1]), 2.0),
        ),
        remarks=(
            f"errors with 2, 4 and 8 cells: {_in_words(plane)} of triangles,"
            f" {_in_words(space)} of tetrahedra",
        ),
        residual_histories=tuple(residuals),
    )


def _in_words(errors: list[float]) -> str:
    return ", ".join(f"{error:.2%}" for error in errors)


def _mesh(dim: int, cells: int) -> BackgroundMesh:
    """Return the unit square, or the slab of thickness 1 / ``cells`` over it."""
    lines = np.linspace(0.0, 1.0, cells + 1)
    return rectangle_mesh(lines, lines) if dim == 2 else box_mesh(lines, lines, lines[:2])


def _uniform(stretch: float, shear: float) -> list[np.ndarray]:
    """Return the deformation gradients (2, 2) at the ends of the steps."""
    gradients = []
    for share in np.arange(1, STEPS + 1) / STEPS:
        angle, sideways = share * 0.5, 1.0 + share * stretch
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        gradients.append(turn @ np.array([[sideways, share * shear], [0.0, 0.98 / sideways]]))
    return gradients


def _deformed(
    mesh: BackgroundMesh, soil: SoilParameters, pressure: float, gradients: list[np.ndarray]
) -> tuple[np.ndarray, np.ndarray, list[tuple[float, ...]]]:
    """Return the stresses (n_points, 3, 3) in Pa, and the force (2,) in N/m on the left side.

    And the residuals of each step.
    """
    body = with_stress(_block(mesh, soil, UNIFORM), soil, -pressure * np.eye(3))
    dim = mesh.nodes.shape[1]
    is_prescribed = np.zeros(mesh.nodes.shape, dtype=bool)
    x, y = mesh.nodes[:, :2].T
    is_prescribed[np.isclose(x, 0) | np.isclose(x, 1) | np.isclose(y, 0) | np.isclose(y, 1)] = True
    is_prescribed[:, 2:] = True
    residuals = []
    for gradient in gradients:
        full = np.eye(dim)
        full[:2, :2] = gradient
        nodes = mesh.nodes @ full.T
        motion = nodes - body.mesh.nodes
        body, result = advance(
            body._replace(start=motion),
            Prescribed(is_prescribed, np.where(is_prescribed, motion, 0.0)),
            move_mesh=lambda moved, nodes=nodes: moved._replace(nodes=nodes),  # type: ignore[misc]
            name="uniform deformation",
        )
        residuals.append(tuple(result.equilibrium.newton.residuals))
    force = result.equilibrium.reaction[np.isclose(x, 0.0), :2].sum(axis=0)
    return cauchy_stress(body.points), force / _thickness(mesh), residuals


def _sheared_force(
    mesh: BackgroundMesh, soil: SoilParameters, shear: float
) -> tuple[float, tuple[float, ...]]:
    """Return the horizontal force in N/m that moves the top of a block by ``shear``.

    And the residuals of the step.
    """
    body = _block(mesh, soil, NUMERICS)
    y = mesh.nodes[:, 1]
    is_prescribed = np.zeros(mesh.nodes.shape, dtype=bool)
    is_prescribed[np.isclose(y, 0.0) | np.isclose(y, 1.0)] = True
    is_prescribed[:, 2:] = True
    motion = np.zeros_like(mesh.nodes)
    motion[:, 0] = shear * y
    _, result = advance(
        body._replace(start=motion),
        Prescribed(is_prescribed, np.where(is_prescribed, motion, 0.0)),
        name="sheared block",
    )
    force = result.equilibrium.reaction[np.isclose(y, 1.0), 0].sum()
    return float(force) / _thickness(mesh), tuple(result.equilibrium.newton.residuals)


def _block(mesh: BackgroundMesh, soil: SoilParameters, numerics: Numerics) -> Body:
    return make_body(
        mesh, Ground(0.0, 1.0, soil), numerics=numerics,
        is_soil=np.ones(len(mesh.cell_nodes), dtype=bool),
    )  # fmt: skip


def _thickness(mesh: BackgroundMesh) -> float:
    """Return the extent in m across the plane; that of a plane mesh is one metre."""
    return 1.0 if mesh.nodes.shape[1] == 2 else float(np.ptp(mesh.nodes[:, 2]))


PROBLEMS = (
    Problem("SLAB", "Uniform deformation of a slab in space and in plane strain", uniform_slab,
            is_quick=True),
    Problem("SLAB-SHEAR", "Sheared slab in space and in plane strain", sheared_slab,
            is_quick=True),
)  # fmt: skip
