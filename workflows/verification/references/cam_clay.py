"""PE4: undrained triaxial compression of modified Cam clay, in closed form.

Constant volume, specific volume v = 1 + e_0 kept in the moduli K = v p / kappa and
G = 3 K (1 - 2 nu) / (2 (1 + nu)).  While it yields, the stress ratio eta = q / p takes the sample
along p / p_0 = [(M^2 + eta_0^2) / (M^2 + eta^2)]^Lambda, Lambda = 1 - kappa / lambda, and the
shear strain is the sum of two integrals:

plastic: Lambda kappa / (v M) [ln |(M + eta) / (M - eta)| - 2 arctan(eta / M)],
elastic: p / (3 G) [eta - 2 Lambda (eta - M arctan(eta / M))],  p / G being constant.

Source: Roscoe & Burland (1968); integrals here from d(e_s^p) / d(e_v^p) = 2 eta / (M^2 - eta^2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq


@dataclass(frozen=True)
class CamClay:
    """Parameters of modified Cam clay; stress ratio M in triaxial compression."""

    critical_stress_ratio: float
    compression_index: float
    """lambda: slope of the normal compression line in (ln p, e)."""
    swelling_index: float
    """kappa: slope of the swelling line in (ln p, e)."""
    void_ratio: float
    poissons_ratio: float

    @property
    def plastic_share(self) -> float:
        """Lambda = 1 - kappa / lambda."""
        return 1.0 - self.swelling_index / self.compression_index

    @property
    def pressure_over_shear_modulus(self) -> float:
        """Return p / G, which does not depend on p."""
        ratio = 2.0 * (1.0 + self.poissons_ratio) / (3.0 * (1.0 - 2.0 * self.poissons_ratio))
        return ratio * self.swelling_index / (1.0 + self.void_ratio)


def undrained_shear_strength(
    clay: CamClay, *, mean_pressure: float, overconsolidation_ratio: float = 1.0
) -> float:
    """Return s_u = M / 2 p_cs in Pa, with p_cs = p_0 (OCR / 2)^Lambda of ``critical_pressure``."""
    pressure = critical_pressure(
        clay, mean_pressure=mean_pressure, overconsolidation_ratio=overconsolidation_ratio
    )
    return 0.5 * clay.critical_stress_ratio * pressure


def critical_pressure(
    clay: CamClay, *, mean_pressure: float, overconsolidation_ratio: float = 1.0
) -> float:
    """Return p_cs = p_0 (OCR / 2)^Lambda, the effective mean pressure in the critical state, in Pa.

    ``mean_pressure`` p_0 is the isotropic pressure at the start, OCR the preconsolidation pressure
    over p_0.
    """
    return mean_pressure * (0.5 * overconsolidation_ratio) ** clay.plastic_share


def undrained_triaxial(
    axial_shortening: float,
    clay: CamClay,
    *,
    mean_pressure: float,
    overconsolidation_ratio: float = 1.0,
) -> tuple[float, float]:
    """Return deviator stress q and effective mean pressure p in Pa.

    The sample is elastic, at constant p, until it reaches the yield surface
    q^2 = M^2 p (p_c - p); on the dry side (OCR > 2) it softens afterwards.

    Parameters
    ----------
    axial_shortening
        Axial strain, compression positive, equal to the shear strain.
    mean_pressure
        p_0 in Pa.
    """
    m, p0 = clay.critical_stress_ratio, mean_pressure
    yield_ratio = m * np.sqrt(overconsolidation_ratio - 1.0)
    elastic = yield_ratio / 3.0 * clay.pressure_over_shear_modulus
    if axial_shortening <= elastic:
        return 3.0 * axial_shortening * p0 / clay.pressure_over_shear_modulus, p0
    ratio = _stress_ratio(axial_shortening - elastic, yield_ratio, clay)
    pressure = p0 * ((m**2 + yield_ratio**2) / (m**2 + ratio**2)) ** clay.plastic_share
    return ratio * pressure, pressure


def _stress_ratio(strain: float, yield_ratio: float, clay: CamClay) -> float:
    """Return eta after the shear strain since first yield."""
    below = clay.critical_stress_ratio - yield_ratio  # M - eta, below zero on the dry side
    if below == 0.0:
        return yield_ratio
    start = _shear_strain(below, clay)
    log_share = brentq(
        lambda x: _shear_strain(below * np.exp(x), clay) - start - strain, -650.0, 0.0, xtol=1e-13
    )
    return clay.critical_stress_ratio - below * np.exp(log_share)


def _shear_strain(below: float, clay: CamClay) -> float:
    """Return elastic plus plastic shear strain as a function of M - eta, up to a constant."""
    m, share = clay.critical_stress_ratio, clay.plastic_share
    ratio = m - below
    angle = np.arctan(ratio / m)
    plastic = np.log((2.0 * m - below) / abs(below)) - 2.0 * angle
    elastic = ratio - 2.0 * share * (ratio - m * angle)
    compliance = share * clay.swelling_index / ((1.0 + clay.void_ratio) * m)
    return compliance * plastic + clay.pressure_over_shear_modulus / 3.0 * elastic
