"""Isotropic Hencky elasticity: Kirchhoff stress linear in the elastic logarithmic strain.

    tau = K tr(eps) 1 + 2 G dev(eps)

In small strain the same law is Hooke's law.
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit
from install_mpm.constitutive.mandel import trace
from install_mpm.constitutive.parameters import HookeanSoil, SoilParameters

BULK, SHEAR = 0, 1
"""Columns of the packed parameters; the first two of every law that is elastic in this way."""

STATE_VARIABLES: tuple[str, ...] = ()


def pack(parameters: HookeanSoil) -> np.ndarray:
    """Return the packed parameters: bulk and shear modulus in Pa, shape (2,)."""
    youngs_modulus, poissons_ratio = parameters.youngs_modulus, parameters.poissons_ratio
    bulk = youngs_modulus / (3.0 * (1.0 - 2.0 * poissons_ratio))
    shear = youngs_modulus / (2.0 * (1.0 + poissons_ratio))
    return np.array([bulk, shear])


def initial_state(parameters: SoilParameters, depth: np.ndarray, stress: np.ndarray) -> np.ndarray:
    """Return the state variables, (n, 0): an elastic material has none."""
    return np.zeros((len(depth), 0))


@jit
def elastic_stress(strain, parameters, stress):
    """Fill ``stress`` (6,) in Pa from the elastic ``strain`` (6,)."""
    bulk, shear = parameters[BULK], parameters[SHEAR]
    volumetric = (bulk - 2.0 / 3.0 * shear) * trace(strain)
    for i in range(6):
        stress[i] = 2.0 * shear * strain[i]
    for i in range(3):
        stress[i] += volumetric


@jit
def elastic_tangent(parameters, tangent):
    """Fill ``tangent`` (6, 6) in Pa with d(stress)/d(strain)."""
    bulk, shear = parameters[BULK], parameters[SHEAR]
    tangent[:, :] = 0.0
    for i in range(6):
        tangent[i, i] = 2.0 * shear
    for i in range(3):
        for j in range(3):
            tangent[i, j] += bulk - 2.0 / 3.0 * shear


@jit
def elastic_strain_from_stress(stress, parameters, state, elastic_strain):
    """Fill ``elastic_strain`` (6,), the inverse of ``elastic_stress``."""
    bulk, shear = parameters[BULK], parameters[SHEAR]
    mean_stress = trace(stress) / 3.0
    for i in range(6):
        elastic_strain[i] = stress[i] / (2.0 * shear)
    for i in range(3):
        elastic_strain[i] += mean_stress * (1.0 / (3.0 * bulk) - 1.0 / (2.0 * shear))


@jit
def update_stress(trial_strain, parameters, state_old, stress, elastic_strain, state, tangent):
    """Evaluate the law at one point; see ``dispatch.update_stress`` for arguments and status."""
    elastic_stress(trial_strain, parameters, stress)
    elastic_tangent(parameters, tangent)
    elastic_strain[:] = trial_strain
    state[:] = state_old
    return 0


@jit
def yield_function(stress, parameters, state):
    """Return -1: an elastic material never yields."""
    return -1.0
