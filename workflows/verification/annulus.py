"""PA7, PA8 and PA9: the rigid inner rim of an elastic annulus turns, its outer rim is fixed.

At small strain the torque is 4 pi G theta a^2 b^2 / (b^2 - a^2); at large rotation it comes from
the least energy over radius and rotation of every circle (``references.annulus_torsion``).  The
soil is compressible, so the volumetric term, which is made for incompressible soil, is left out.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from install_mpm.constitutive.parameters import HenckyElastic, NeoHookean, SoilParameters
from install_mpm.conventions import Unit
from install_mpm.options import Numerics
from workflows.verification.disc_meshes import circle
from workflows.verification.problem import Outcome, Problem, Series, relative
from workflows.verification.references import annulus_torsion as reference
from workflows.verification.references.annulus_energy import EnergyLaw, hencky, neo_hookean
from workflows.verification.turned_disc import STEP, Disc, MeshLaw, Turned, turn

SIDES = 72
"""Of both rims: the outer one maps onto itself in a step of 5 degrees."""
SMALL_ROTATION = 1e-7
"""In rad: the problem is linear, and one Newton correction solves it."""
COMPRESSIBLE = Numerics(volumetric_term=0.0)
SMALL = Numerics(volumetric_term=0.0, tolerance=1e-6)

Length = Annotated[float, Unit("m")]
Modulus = Annotated[float, Unit("Pa")]


def small_torsion(
    *, a: Length = 1.0, b: Length = 4.0, E: Modulus = 10e3, nu: float = 0.0
) -> Outcome:
    """Return the torsional stiffness at a small rotation (PA7)."""
    disc = Disc(circle(b, SIDES), circle(a, SIDES), MeshLaw.WHOLE)
    turned = turn(disc, HenckyElastic(E, nu), SMALL_ROTATION, numerics=SMALL)
    stiffness = reference.small_strain_torque(
        1.0, inner_radius=a, outer_radius=b, youngs_modulus=E, poissons_ratio=nu
    )
    computed = turned.torque[0] / SMALL_ROTATION
    return Outcome(
        (relative("torque over rotation in N m/rad per metre", computed, stiffness, 5e-3),),
        residual_histories=turned.residuals,
    )


def hencky_torsion(
    *, a: Length = 1.0, b: Length = 4.0, E: Modulus = 10e3, nu: float = 0.0
) -> Outcome:
    """Return the torque of a Hencky annulus up to 20 degrees (PA8)."""
    turned = _turn_by(20.0, HenckyElastic(E, nu), a, b)
    return _compared(turned, (5.0, 10.0, 15.0, 20.0), hencky, 1e-2, (a, b, E, nu))


def neo_hookean_torsion(
    *, a: Length = 1.0, b: Length = 4.0, E: Modulus = 10e3, nu: float = 0.0
) -> Outcome:
    """Return the torque of a neo-Hookean annulus up to 90 degrees (PA9)."""
    turned = _turn_by(90.0, NeoHookean(E, nu), a, b)
    return _compared(turned, (45.0, 90.0), neo_hookean, 1.5e-2, (a, b, E, nu))


def _turn_by(degrees: float, soil: SoilParameters, a: float, b: float) -> Turned:
    disc = Disc(circle(b, SIDES), circle(a, SIDES), MeshLaw.WHOLE)
    return turn(disc, soil, np.deg2rad(degrees), numerics=COMPRESSIBLE)


def _compared(
    turned: Turned,
    degrees: tuple[float, ...],
    energy: EnergyLaw,
    tolerance: float,
    annulus: tuple[float, float, float, float],
) -> Outcome:
    """Return torques at ``degrees`` beside the reference, and the curve of all steps."""
    a, b, youngs_modulus, poissons_ratio = annulus
    exact = [
        reference.annulus_torsion(
            angle,
            energy=energy,
            inner_radius=a,
            outer_radius=b,
            youngs_modulus=youngs_modulus,
            poissons_ratio=poissons_ratio,
        ).torque
        for angle in turned.angle
    ]
    steps = [round(np.deg2rad(value) / STEP) - 1 for value in degrees]
    checks = tuple(
        relative(f"torque at {value:g} degrees in N m per metre", turned.torque[k], exact[k],
                 tolerance)
        for value, k in zip(degrees, steps, strict=True)
    )  # fmt: skip
    curve = Series(
        "Torque on the inner rim",
        "rotation in degrees",
        "torque in N m per metre",
        tuple(np.rad2deg(turned.angle)),
        tuple(turned.torque),
        tuple(exact),
    )
    return Outcome(checks, (curve,), residual_histories=turned.residuals)


PROBLEMS = (
    Problem("PA7", "Torsion of an annulus, small strain", small_torsion, is_quick=True),
    Problem("PA8", "Torsion of a Hencky annulus to 20 degrees", hencky_torsion, is_quick=False),
    Problem(
        "PA9",
        "Torsion of a neo-Hookean annulus to 90 degrees",
        neo_hookean_torsion,
        is_quick=False,
    ),
)
