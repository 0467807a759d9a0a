"""PA7, PA8 and PA9 in space: the annulus is a slab whose faces stay in their planes.

The same torsion as in ``annulus``, with tetrahedra; the mesh takes the rotation of the inner rim
and is wound back by whole sides of the outer one.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from install_mpm.constitutive.parameters import HenckyElastic, NeoHookean, SoilParameters
from install_mpm.conventions import Unit, rotation_matrix
from install_mpm.ground import Ground
from install_mpm.options import Numerics
from workflows.verification.body import Body, make_body
from workflows.verification.problem import Outcome, Problem, Series, relative
from workflows.verification.references import annulus_torsion as reference
from workflows.verification.references.annulus_energy import EnergyLaw, hencky, neo_hookean
from workflows.verification.solid_meshes import ring_mesh
from workflows.verification.turned_solid import ON_PLANE, Driven, Prism, screw_once

SIDES, RINGS = 48, 5
STEP = np.deg2rad(5.0)
SMALL_ROTATION = 1e-7
"""In rad: the problem is linear."""
COMPRESSIBLE = Numerics(volumetric_term=0.0)
SMALL = Numerics(volumetric_term=0.0, tolerance=1e-6)

Length = Annotated[float, Unit("m")]
Modulus = Annotated[float, Unit("Pa")]


def small_torsion(
    *, a: Length = 1.0, b: Length = 4.0, E: Modulus = 10e3, nu: float = 0.0
) -> Outcome:
    """Return the torsional stiffness at a small rotation (PA7)."""
    torque, residuals = _turn(np.array([SMALL_ROTATION]), HenckyElastic(E, nu), a, b, SMALL)
    stiffness = reference.small_strain_torque(
        1.0, inner_radius=a, outer_radius=b, youngs_modulus=E, poissons_ratio=nu
    )
    computed = torque[0] / SMALL_ROTATION
    return Outcome(
        (relative("torque over rotation in N m/rad per metre", computed, stiffness, 5e-3),),
        residual_histories=residuals,
    )


def hencky_torsion(
    *, a: Length = 1.0, b: Length = 4.0, E: Modulus = 10e3, nu: float = 0.0
) -> Outcome:
    """Return the torque of a Hencky annulus up to 20 degrees (PA8)."""
    return _compared(HenckyElastic(E, nu), (5.0, 10.0, 15.0, 20.0), hencky, 1e-2, a, b)


def neo_hookean_torsion(
    *, a: Length = 1.0, b: Length = 4.0, E: Modulus = 10e3, nu: float = 0.0
) -> Outcome:
    """Return the torque of a neo-Hookean annulus up to 90 degrees (PA9)."""
    return _compared(NeoHookean(E, nu), (45.0, 90.0), neo_hookean, 1.5e-2, a, b)


def _compared(
    soil: HenckyElastic | NeoHookean, degrees: tuple[float, ...], energy: EnergyLaw,
    tolerance: float, a: float, b: float,
) -> Outcome:  # fmt: skip
    """Return torques at ``degrees`` beside the reference, and the curve of all steps."""
    angles = STEP * np.arange(1, round(np.deg2rad(degrees[-1]) / STEP) + 1)
    torques, residuals = _turn(angles, soil, a, b, COMPRESSIBLE)
    exact = [
        reference.annulus_torsion(
            angle, energy=energy, inner_radius=a, outer_radius=b,
            youngs_modulus=soil.youngs_modulus, poissons_ratio=soil.poissons_ratio,
        ).torque
        for angle in angles
    ]  # fmt: skip
    at = [round(np.deg2rad(value) / STEP) - 1 for value in degrees]
    checks = tuple(
        relative(f"torque at {value:g} degrees in N m per metre", torques[k], exact[k], tolerance)
        for value, k in zip(degrees, at, strict=True)
    )
    curve = Series(
        "Torque on the inner rim", "rotation in degrees", "torque in N m per metre",
        tuple(np.degrees(angles)), tuple(torques), tuple(exact),
    )  # fmt: skip
    return Outcome(checks, (curve,), residual_histories=residuals)


def _turn(
    angles: np.ndarray, soil: SoilParameters, a: float, b: float, numerics: Numerics
) -> tuple[np.ndarray, tuple[tuple[float, ...], ...]]:
    """Return torques (n,) per metre and residual histories of the rotation to ``angles`` (n,)."""
    thickness = a * (2.0 * np.pi / SIDES)
    prism = Prism(a, b, SIDES, (0.0, thickness))
    mesh = ring_mesh(np.geomspace(a, b, RINGS + 1), SIDES, np.array(prism.levels))
    body = make_body(
        mesh, Ground(0.0, 1.0, soil), numerics=numerics,
        is_soil=np.ones(len(mesh.cell_nodes), dtype=bool),
    )  # fmt: skip
    body = body._replace(start=_first_trial(body, a, b, angles[0]))
    driven = Driven(nodes=np.flatnonzero(np.hypot(*mesh.nodes[:, :2].T) < a + ON_PLANE))
    torques, residuals = [], []
    for angle, step in zip(angles, np.diff(angles, prepend=0.0), strict=True):
        moved = screw_once(body, prism, driven, angle, step)
        body = moved.body
        torques.append(moved.torque / thickness)
        residuals.append(tuple(moved.result.equilibrium.newton.residuals))
    return np.array(torques), tuple(residuals)


def _first_trial(body: Body, a: float, b: float, step: float) -> np.ndarray:
    """Return the displacement (n_nodes, 3) of an annulus at small strain, turned by ``step``."""
    nodes = body.mesh.nodes
    radius = np.hypot(nodes[:, 0], nodes[:, 1])
    share = np.clip((1.0 / radius**2 - 1.0 / b**2) / (1.0 / a**2 - 1.0 / b**2), 0.0, 1.0)
    turns = np.stack([rotation_matrix(angle, 3) for angle in share * step])
    moved: np.ndarray = np.einsum("nij,nj->ni", turns, nodes) - nodes
    return moved


PROBLEMS = (
    Problem("PA7-3D", "Torsion of an annulus, small strain, in space", small_torsion,
            is_quick=True),
    Problem("PA8-3D", "Torsion of a Hencky annulus to 20 degrees, in space", hencky_torsion,
            is_quick=False),
    Problem("PA9-3D", "Torsion of a neo-Hookean annulus to 90 degrees, in space",
            neo_hookean_torsion, is_quick=False),
)  # fmt: skip
