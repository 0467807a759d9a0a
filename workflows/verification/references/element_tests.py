"""PE1, PE2, PE3, PE6 and PE7: homogeneous tests of one point of soil, in closed form.

Mohr-Coulomb with cohesion c, friction angle phi, dilation angle psi; N = (1 + sin) / (1 - sin) of
either angle.  Stress differences, mean pressure and shortening are positive in compression.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq


def flow_number(angle: float) -> float:
    """Return N = (1 + sin(angle)) / (1 - sin(angle)); angle in rad."""
    return (1.0 + np.sin(angle)) / (1.0 - np.sin(angle))


def oedometer(
    *,
    friction_angle: float,
    dilation_angle: float,
    youngs_modulus: float,
    poissons_ratio: float,
) -> tuple[float, float]:
    """Return K (horizontal over vertical stress) and the modulus in Pa of first loading (PE1).

    Cohesionless Mohr-Coulomb soil, compressed from zero stress without sideways strain.  It stays
    elastic if nu / (1 - nu) >= 1 / N_phi.  Otherwise K = 1 / N_phi, and from
    e_z^p = -(e_x^p + e_y^p) / N_psi the modulus is
    E / [1 - 2 nu K + (2 / N_psi) (K (1 - nu) - nu)].

    Parameters
    ----------
    friction_angle, dilation_angle
        In rad.
    youngs_modulus
        In Pa.
    """
    nu = poissons_ratio
    active = 1.0 / flow_number(friction_angle)
    k = max(nu / (1.0 - nu), active)
    plastic = 2.0 / flow_number(dilation_angle) * (k * (1.0 - nu) - nu)
    return k, youngs_modulus / (1.0 - 2.0 * nu * k + plastic)


@dataclass(frozen=True)
class Triaxial:
    """Response of a triaxial sample, each of the shape of the axial shortening."""

    deviator_stress: np.ndarray
    """Axial minus radial compression in Pa."""
    volumetric_strain: np.ndarray
    """Extension positive, so negative where the sample contracts."""


def drained_triaxial(
    axial_shortening: ArrayLike,
    *,
    cell_pressure: float,
    cohesion: float,
    friction_angle: float,
    dilation_angle: float,
    youngs_modulus: float,
    poissons_ratio: float,
) -> Triaxial:
    """Return the drained compression of a Mohr-Coulomb sample (PE2).

    q = E e_a up to q_f = (N_phi - 1) p_0 + 2 c sqrt(N_phi); then de_v / de_a = N_psi - 1.

    Parameters
    ----------
    axial_shortening
        Axial strain, compression positive, any shape.
    cell_pressure, cohesion, youngs_modulus
        In Pa.
    friction_angle, dilation_angle
        In rad.
    """
    shortening = np.asarray(axial_shortening, dtype=float)
    n = flow_number(friction_angle)
    strength = (n - 1.0) * cell_pressure + 2.0 * cohesion * np.sqrt(n)
    elastic = np.minimum(shortening, strength / youngs_modulus)
    dilation = (flow_number(dilation_angle) - 1.0) * (shortening - elastic)
    return Triaxial(youngs_modulus * elastic, dilation - (1.0 - 2.0 * poissons_ratio) * elastic)


def undrained_strength(*, mean_pressure: float, cohesion: float, friction_angle: float) -> float:
    """Return q = M (p' + c cot(phi)), M = 6 sin(phi) / (3 - sin(phi)), in Pa (PE3).

    Triaxial compression of Mohr-Coulomb soil without dilation: no volume change, so p' stays.

    Parameters
    ----------
    mean_pressure, cohesion
        In Pa.
    friction_angle
        In rad.
    """
    sine, cosine = np.sin(friction_angle), np.cos(friction_angle)
    return 6.0 * (mean_pressure * sine + cohesion * cosine) / (3.0 - sine)


def simple_shear_ratio(*, friction_angle: float, dilation_angle: float) -> float:
    """Return tau / sigma_n at failure in simple shear, sin(phi) cos(psi) / (1 - sin(phi) sin(psi)).

    Davis (1968): the horizontal is a line of no extension (PE6).  Cohesionless, angles in rad.
    """
    sine = np.sin(friction_angle)
    return sine * np.cos(dilation_angle) / (1.0 - sine * np.sin(dilation_angle))


def hencky_simple_shear(shear: ArrayLike, *, shear_modulus: float) -> np.ndarray:
    """Return tau = 2 G asinh(g / 2) / sqrt(1 + g^2 / 4) in the unit of G (PE7).

    ``shear`` is the displacement over the height, g, any shape.
    """
    half = 0.5 * np.asarray(shear, dtype=float)
    return 2.0 * shear_modulus * np.arcsinh(half) / np.sqrt(1.0 + half**2)


def hencky_simple_shear_peak(*, shear_modulus: float) -> tuple[float, float]:
    """Return g and the largest shear stress of ``hencky_simple_shear``.

    With x = asinh(g / 2), tau = 2 G x / cosh(x) is largest at x tanh(x) = 1.
    """
    x = brentq(lambda x: x * np.tanh(x) - 1.0, 0.5, 2.0, xtol=1e-15)
    return 2.0 * np.sinh(x), 2.0 * shear_modulus * x / np.cosh(x)
