"""PA18: expansion of a cavity in Mohr-Coulomb soil with friction and dilation.

Hypotheses of Yu & Houlsby (1991), Geotechnique 41, 173-183: small strain in the elastic zone,
logarithmic strain in the plastic zone, perfect plasticity, infinite soil, and in the cylinder an
axial stress between the two others.  k = 1 for the cylinder and 2 for the sphere,
alpha = (1 + sin phi) / (1 - sin phi), beta the same of psi, Y = 2 c cos phi / (1 - sin phi).
Compression is positive in this module.

In the plastic zone, x = r / b inside the radius b, equilibrium with sigma_r = alpha sigma_theta + Y
gives (alpha - 1) sigma_r + Y as a power -k (alpha - 1) / alpha of x.  The flow rule
beta e_r^p + k e_theta^p = 0 says that r^(k/beta) exp(h / beta) dr = r_0^(k/beta) dr_0, with the
elastic part h = beta e_r^e + k e_theta^e.  Its integral from the cavity to b, done here by
quadrature (the paper has a series), links a / b and a_0 / b.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import boxcox


@dataclass(frozen=True)
class MohrCoulombSoil:
    """Soil around the cavity; pressures in Pa, angles in rad."""

    initial_pressure: float
    cohesion: float
    friction_angle: float
    dilation_angle: float
    youngs_modulus: float
    poissons_ratio: float

    @property
    def alpha(self) -> float:
        """Return (1 + sin phi) / (1 - sin phi)."""
        return (1.0 + np.sin(self.friction_angle)) / (1.0 - np.sin(self.friction_angle))

    @property
    def beta(self) -> float:
        """Return (1 + sin psi) / (1 - sin psi)."""
        return (1.0 + np.sin(self.dilation_angle)) / (1.0 - np.sin(self.dilation_angle))

    @property
    def y(self) -> float:
        """Return Y = 2 c cos phi / (1 - sin phi) in Pa."""
        sine, cosine = np.sin(self.friction_angle), np.cos(self.friction_angle)
        return 2.0 * self.cohesion * cosine / (1.0 - sine)


def cavity_pressure(expansion: float, soil: MohrCoulombSoil, *, is_sphere: bool) -> float:
    """Return the pressure in Pa of a cavity whose radius is ``expansion`` times the original.

    Infinite expansion gives the limit pressure.

    Raises
    ------
    ValueError
        If the cavity has become smaller.
    """
    if expansion < 1.0:
        raise ValueError(f"cavity expansion {expansion} must be at least 1")
    k = 2 if is_sphere else 1
    strength = soil.y + (soil.alpha - 1.0) * soil.initial_pressure
    excess = k * strength / (k + soil.alpha)  # of sigma_r over p_0 at the radius b
    two_g = soil.youngs_modulus / (1.0 + soil.poissons_ratio)
    yield_strain = excess / (k * two_g)  # u / r at the radius b
    shortening = 1.0 - 1.0 / expansion
    if shortening <= yield_strain:
        return soil.initial_pressure + k * two_g * shortening
    power = 1.0 + k / soil.beta

    def mismatch(log_a: float) -> float:
        outside = (1.0 - yield_strain) ** power - np.exp(power * log_a) / expansion**power
        integral, _ = quad(_integrand, log_a, 0.0, args=(soil, k, excess), epsrel=1e-11)
        return integral - outside / power

    log_a = _root_below_zero(mismatch)
    return float(_radial_stress(log_a, soil, k, excess))


def _root_below_zero(function: Callable[[float], float]) -> float:
    """Return the root of a function that is negative at zero and positive far below."""
    lower = -1.0
    while function(lower) < 0.0:
        lower *= 2.0
    return brentq(function, lower, 0.0, xtol=1e-13)


def _radial_stress(log_x: float, soil: MohrCoulombSoil, k: int, excess: float) -> float:
    """Return sigma_r at r = b exp(log_x); the power tends to a logarithm for phi -> 0."""
    alpha = soil.alpha
    at_b = soil.initial_pressure + excess
    factor = k * (soil.y + (alpha - 1.0) * at_b) / alpha
    return at_b - factor * boxcox(np.exp(log_x), -k * (alpha - 1.0) / alpha)


def _integrand(log_x: float, soil: MohrCoulombSoil, k: int, excess: float) -> float:
    """Return x^(1 + k/beta) exp(h / beta), with h from Hooke's law."""
    nu, p0 = soil.poissons_ratio, soil.initial_pressure
    radial = _radial_stress(log_x, soil, k, excess)
    hoop = (radial - soil.y) / soil.alpha - p0
    radial -= p0
    if k == 1:
        strain_r = (1.0 + nu) * ((1.0 - nu) * radial - nu * hoop)
        strain_hoop = (1.0 + nu) * ((1.0 - nu) * hoop - nu * radial)
    else:
        strain_r = radial - 2.0 * nu * hoop
        strain_hoop = (1.0 - nu) * hoop - nu * radial
    h = (soil.beta * strain_r + k * strain_hoop) / soil.youngs_modulus
    return np.exp((1.0 + k / soil.beta) * log_x + h / soil.beta)
