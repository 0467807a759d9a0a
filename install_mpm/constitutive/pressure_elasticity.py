"""Elasticity of soil whose stiffness grows with the mean pressure p.

    K(p) = K_r (p / p_r)^m for p >= p_l ,  K(p_l) below ;   dev(tau) = 2 G dev(eps)

The pressure is a function of the volumetric elastic strain alone, p = 0 where that is zero; below
the lowest pressure p_l the function goes on as a straight line, also into tension, so that every
strain has a stress and every stress a strain.

The shear modulus is a state variable.  If it is constant the law has a stored energy and no closed
elastic cycle makes or takes work.  If Poisson's ratio is given instead, G = r K(p) of the last
accepted state: the rate law of the textbooks, exact in the limit of small steps, in which a closed
cycle of p and q may make work (Zytynski et al. 1978).  The deviatoric elastic
strain is then kept as dev(tau) / (2 G) of the current G.
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit
from install_mpm.constitutive.mandel import trace

REFERENCE_PRESSURE, REFERENCE_BULK, EXPONENT, LOWEST_PRESSURE, SHEAR_RATIO = 0, 1, 2, 3, 4
"""Columns of the packed parameters: p_r, K_r, p_l in Pa, m; G over K, zero if G is constant."""
N_COLUMNS = 5


def shear_ratio(poissons_ratio: float, shear_modulus: float) -> float:
    """Return G / K, or zero if ``shear_modulus`` in Pa is given: it is constant then."""
    if shear_modulus > 0.0:
        return 0.0
    return 1.5 * (1.0 - 2.0 * poissons_ratio) / (1.0 + poissons_ratio)


@jit
def bulk_modulus(pressure, parameters):
    """Return K in Pa at ``pressure`` in Pa."""
    ratio = max(pressure, parameters[LOWEST_PRESSURE]) / parameters[REFERENCE_PRESSURE]
    return parameters[REFERENCE_BULK] * ratio ** parameters[EXPONENT]


@jit
def mean_pressure(volumetric, parameters):
    """Return p in Pa of the volumetric elastic strain ``volumetric``, extension positive."""
    lowest, exponent = parameters[LOWEST_PRESSURE], parameters[EXPONENT]
    stiffness = bulk_modulus(lowest, parameters)
    beyond = -volumetric * stiffness / lowest - 1.0
    if beyond <= 0.0:
        return -volumetric * stiffness
    if exponent == 1.0:
        return lowest * np.exp(beyond)
    return lowest * (1.0 + (1.0 - exponent) * beyond) ** (1.0 / (1.0 - exponent))


@jit
def volumetric_strain(pressure, parameters):
    """Return the volumetric elastic strain, the inverse of ``mean_pressure``."""
    lowest, exponent = parameters[LOWEST_PRESSURE], parameters[EXPONENT]
    stiffness = bulk_modulus(lowest, parameters)
    if pressure <= lowest:
        return -pressure / stiffness
    if exponent == 1.0:
        beyond = np.log(pressure / lowest)
    else:
        beyond = ((pressure / lowest) ** (1.0 - exponent) - 1.0) / (1.0 - exponent)
    return -lowest / stiffness * (1.0 + beyond)


@jit
def updated_shear_modulus(pressure, parameters, shear):
    """Return the shear modulus in Pa that belongs to ``pressure``: ``shear`` if constant."""
    if parameters[SHEAR_RATIO] > 0.0:
        return parameters[SHEAR_RATIO] * bulk_modulus(pressure, parameters)
    return shear


@jit
def strain_from_stress(stress, parameters, shear, elastic_strain):
    """Fill ``elastic_strain`` (6,) of ``stress`` (6,) in Pa with the shear modulus ``shear``."""
    mean = trace(stress) / 3.0
    volumetric = volumetric_strain(-mean, parameters)
    for i in range(6):
        if i < 3:
            elastic_strain[i] = (stress[i] - mean) / (2.0 * shear) + volumetric / 3.0
        else:
            elastic_strain[i] = stress[i] / (2.0 * shear)


def initial_shear_modulus(
    pressure: np.ndarray, row: np.ndarray, shear_modulus: float
) -> np.ndarray:
    """Return the shear modulus (n,) in Pa at ``pressure`` (n,) for packed parameters ``row``."""
    if row[SHEAR_RATIO] == 0.0:
        return np.full(len(pressure), shear_modulus)
    return np.array([row[SHEAR_RATIO] * bulk_modulus(p, row) for p in pressure])
