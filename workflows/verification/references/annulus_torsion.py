"""PA7, PA8 and PA9: elastic annulus with a fixed outer rim, its rigid inner rim turned.

The stored energy, the integral of psi 2 pi R dR (``annulus_energy``), is made a minimum over the
current radius r(R) and the rotation phi(R) by Newton's method, with functions of R that converge
exponentially (``annulus_basis``).  The solution is lost where shearing the inner rim further no
longer raises its stress: for Hencky at a finite angle, for neo-Hookean never.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workflows.verification.references.annulus_basis import Basis, make_basis
from workflows.verification.references.annulus_energy import EnergyLaw, energy_derivatives

LARGEST_STEP, SMALLEST_STEP = np.deg2rad([5.0, 0.005])
"""Rotation between two solutions; halved where there is none."""


@dataclass(frozen=True)
class AnnulusTorsion:
    """Annulus after the rotation; radii at the integration points from inner to outer rim."""

    torque: float
    """On the inner rim, in N m per metre."""
    radius: np.ndarray
    """Original radii R in m."""
    radial_displacement: np.ndarray
    """r - R in m; negative is inflow."""
    twist: np.ndarray
    """Rotation phi about the centre in rad."""
    radial_stress: np.ndarray
    """True radial stress in Pa, tension positive."""


def small_strain_torque(
    rotation: float,
    *,
    inner_radius: float,
    outer_radius: float,
    youngs_modulus: float,
    poissons_ratio: float,
) -> float:
    """Return T = 4 pi G theta a^2 b^2 / (b^2 - a^2) in N m per metre.

    Exact at any angle for the incompressible neo-Hookean material.  Radii in m, E in Pa, rotation
    in rad.
    """
    shear_modulus = youngs_modulus / (2.0 * (1.0 + poissons_ratio))
    a2, b2 = inner_radius**2, outer_radius**2
    return 4.0 * np.pi * shear_modulus * rotation * a2 * b2 / (b2 - a2)


def annulus_torsion(
    rotation: float,
    *,
    energy: EnergyLaw,
    inner_radius: float,
    outer_radius: float,
    youngs_modulus: float,
    poissons_ratio: float,
    degree: int = 24,
) -> AnnulusTorsion:
    """Return the annulus after the inner rim has been turned by ``rotation``.

    Parameters
    ----------
    rotation
        In rad.
    energy
        ``hencky`` or ``neo_hookean`` of ``annulus_energy``.
    inner_radius, outer_radius, youngs_modulus
        In m, m and Pa.
    degree
        Number of polynomials each for r and phi.

    Raises
    ------
    ArithmeticError
        If there is no stable solution at this angle.
    """
    moduli = _moduli(youngs_modulus, poissons_ratio)
    basis = make_basis(inner_radius, outer_radius, degree)
    unknown, reached = _follow(abs(rotation), basis, energy, moduli)
    if reached < abs(rotation):
        raise ArithmeticError(
            f"the annulus has no stable solution beyond {np.rad2deg(reached):.2f} degrees"
        )
    q, phi = basis.fields(unknown, reached)
    gradient, _ = energy_derivatives(q, basis.radius, energy, moduli)
    torque = np.sum(basis.weight * gradient[2] * basis.lift_slope)
    sense = np.sign(rotation)
    return AnnulusTorsion(
        sense * torque,
        basis.radius,
        q[1] - basis.radius,
        sense * phi,
        gradient[0] * basis.radius / q[1],
    )


def largest_rotation(
    *,
    energy: EnergyLaw,
    inner_radius: float,
    outer_radius: float,
    youngs_modulus: float,
    poissons_ratio: float,
    degree: int = 24,
    upper_bound: float = 2.0 * np.pi,
) -> float:
    """Return the rotation in rad beyond which there is no stable solution, or ``upper_bound``.

    Parameters as in ``annulus_torsion``.
    """
    moduli = _moduli(youngs_modulus, poissons_ratio)
    basis = make_basis(inner_radius, outer_radius, degree)
    return _follow(upper_bound, basis, energy, moduli)[1]


def _moduli(youngs_modulus: float, poissons_ratio: float) -> tuple[float, float]:
    """Return G and Lame's first parameter."""
    shear_modulus = youngs_modulus / (2.0 * (1.0 + poissons_ratio))
    return shear_modulus, 2.0 * shear_modulus * poissons_ratio / (1.0 - 2.0 * poissons_ratio)


def _follow(
    rotation: float, basis: Basis, energy: EnergyLaw, moduli: tuple[float, float]
) -> tuple[np.ndarray, float]:
    """Return the unknowns at ``rotation``, or at the largest angle before it, and that angle."""
    unknown, angle, step = np.zeros(2 * basis.value.shape[1]), 0.0, LARGEST_STEP
    while angle < rotation and step > SMALLEST_STEP:
        trial = min(angle + step, rotation)
        try:
            unknown, angle = _minimise(unknown, trial, basis, energy, moduli), trial
        except ArithmeticError:
            step *= 0.5
    return unknown, angle


def _minimise(
    unknown: np.ndarray,
    angle: float,
    basis: Basis,
    energy: EnergyLaw,
    moduli: tuple[float, float],
) -> np.ndarray:
    """Return the unknowns at the minimum of the energy near ``unknown``."""
    by_unknown = basis.by_unknown()
    for _ in range(30):
        q, _ = basis.fields(unknown, angle)
        if not np.min(q[:2]) > 0.0:
            break
        gradient, hessian = energy_derivatives(q, basis.radius, energy, moduli)
        force = np.einsum("in,ink->k", gradient * basis.weight, by_unknown)
        weighted = np.einsum("ijn,jnl->inl", hessian * basis.weight, by_unknown)
        stiffness = np.tensordot(by_unknown, weighted, axes=([0, 1], [0, 1]))
        change = np.linalg.lstsq(stiffness, force, rcond=None)[0]
        unknown = unknown - change
        if np.max(np.abs(change)) < 1e-11 * basis.radius[-1]:
            if _is_stable(hessian):
                return unknown
            break
    raise ArithmeticError(f"no stable solution near {np.rad2deg(angle):.2f} degrees")


def _is_stable(hessian: np.ndarray) -> bool:
    """Tell whether the energy is convex in (r', phi') at every point: Legendre's condition."""
    rr, rp, pp = hessian[0, 0], hessian[0, 2], hessian[2, 2]
    return bool(np.all(rr > 0.0) and np.all(rr * pp > rp**2))
