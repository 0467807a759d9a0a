"""Limit of PA8 for nu -> 0.5: the annulus of incompressible Hencky material, in closed form.

Circles keep their radius, and each is sheared by g = R phi' under tau = T / (2 pi R^2), with
tau / G = 2 asinh(g / 2) / sqrt(1 + g^2 / 4).  Because R is proportional to tau^(-1/2), the
rotation is the integral of g / R dR = 1/2 g d(ln tau).  tau has a maximum (PE7): when the inner
rim reaches it, the solution is lost.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from workflows.verification.references.element_tests import (
    hencky_simple_shear,
    hencky_simple_shear_peak,
)


def incompressible_hencky_torsion(
    inner_shear: float, *, inner_radius: float, outer_radius: float, shear_modulus: float
) -> tuple[float, float]:
    """Return rotation in rad and torque in N m per metre when the inner rim is sheared by g.

    Parameters
    ----------
    inner_shear
        g at the inner rim, above zero and not above that of ``hencky_simple_shear_peak``.
    inner_radius, outer_radius
        In m.
    shear_modulus
        In Pa.
    """
    stress = hencky_simple_shear(inner_shear, shear_modulus=shear_modulus)
    stress_outside = stress * (inner_radius / outer_radius) ** 2
    outer_shear = brentq(
        lambda g: hencky_simple_shear(g, shear_modulus=shear_modulus) - stress_outside,
        0.0,
        inner_shear,
        xtol=1e-14,
    )
    rotation = 0.5 * quad(_shear_by_log_stress, outer_shear, inner_shear, epsrel=1e-12)[0]
    return rotation, 2.0 * np.pi * inner_radius**2 * stress


def largest_incompressible_rotation(*, inner_radius: float, outer_radius: float) -> float:
    """Return the rotation in rad at which the solution is lost; radii in m."""
    peak_shear, _ = hencky_simple_shear_peak(shear_modulus=1.0)
    rotation, _ = incompressible_hencky_torsion(
        peak_shear, inner_radius=inner_radius, outer_radius=outer_radius, shear_modulus=1.0
    )
    return rotation


def _shear_by_log_stress(g: float) -> float:
    """Return g d(ln tau) / dg; with x = asinh(g / 2) it is tanh(x) (1 / x - tanh(x))."""
    x = np.arcsinh(0.5 * g)
    return np.tanh(x) * (1.0 / x - np.tanh(x))
