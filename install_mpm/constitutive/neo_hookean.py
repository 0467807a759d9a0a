"""Compressible neo-Hookean solid: elliptic at large stretch, where Hencky elasticity is not.

    psi = G/2 (I_1 - 3 - 2 ln J) + lambda/2 (ln J)^2 ,   tau_A = G (exp(2 eps_A) - 1) + lambda
    tr(eps)

written in the principal logarithmic strains eps_A: it goes through the same interface.
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit
from install_mpm.constitutive.eigen import symmetric_eigen
from install_mpm.constitutive.elastic import BULK, SHEAR, initial_state, pack, yield_function
from install_mpm.constitutive.mandel import COLUMN, ROW, SCALE, from_mandel

STATE_VARIABLES: tuple[str, ...] = ()
REPEATED = 1e-7
"""Difference of principal strains below which the divided difference takes its limit."""
MAX_ITERATIONS = 50

__all__ = ["elastic_strain_from_stress", "initial_state", "pack", "update_stress", "yield_function"]


@jit
def update_stress(trial_strain, parameters, state_old, stress, elastic_strain, state, tangent):
    """Evaluate the law at one point; see ``dispatch.update_stress`` for arguments and status."""
    shear = parameters[SHEAR]
    first_lame = parameters[BULK] - 2.0 / 3.0 * shear
    tensor, values, vectors = np.empty((3, 3)), np.empty(3), np.empty((3, 3))
    from_mandel(trial_strain, tensor)
    symmetric_eigen(tensor, values, vectors)
    volumetric = first_lame * (values[0] + values[1] + values[2])
    dyad = np.empty((3, 3, 6))
    for a in range(3):
        for b in range(3):
            for component in range(6):
                i, j = ROW[component], COLUMN[component]
                dyad[a, b, component] = (
                    0.5
                    * SCALE[component]
                    * (vectors[i, a] * vectors[j, b] + vectors[j, a] * vectors[i, b])
                )
    stress[:] = 0.0
    tangent[:, :] = 0.0
    for i in range(6):
        for a in range(3):
            stress[i] += (shear * np.expm1(2.0 * values[a]) + volumetric) * dyad[a, a, i]
        for j in range(6):
            for a in range(3):
                for b in range(3):
                    tangent[i, j] += (
                        shear * _slope(values[a], values[b]) * dyad[a, b, i] * dyad[a, b, j]
                        + first_lame * dyad[a, a, i] * dyad[b, b, j]
                    )
    elastic_strain[:] = trial_strain
    state[:] = state_old
    return 0


@jit
def _slope(first, second):
    """Return the divided difference of exp(2 eps), or its derivative where the two are equal."""
    if abs(first - second) < REPEATED:
        return 2.0 * np.exp(first + second)
    return (np.exp(2.0 * first) - np.exp(2.0 * second)) / (first - second)


@jit
def elastic_strain_from_stress(stress, parameters, state, elastic_strain):
    """Fill ``elastic_strain`` (6,), the inverse of the law, by Newton's method on the trace.

    NaN where ``stress`` lies beyond what the solid can carry in compression.
    """
    shear = parameters[SHEAR]
    first_lame = parameters[BULK] - 2.0 / 3.0 * shear
    tensor, values, vectors = np.empty((3, 3)), np.empty(3), np.empty((3, 3))
    from_mandel(stress, tensor)
    symmetric_eigen(tensor, values, vectors)
    total = (values[0] + values[1] + values[2]) / (3.0 * parameters[BULK])
    # exp(2 eps_A) = 1 + (tau_A - lambda tr) / G has to stay positive
    largest = (shear + min(values[0], values[1], values[2])) / first_lame if first_lame else 1e300
    for _ in range(MAX_ITERATIONS):
        if total >= largest:
            total = largest - 0.1 * abs(largest)
        excess, slope = -total, -1.0
        for a in range(3):
            squared = 1.0 + (values[a] - first_lame * total) / shear
            excess += 0.5 * np.log(squared)
            slope -= 0.5 * first_lame / (shear * squared)
        previous = total
        total -= excess / slope
        if total >= largest:
            total = 0.5 * (previous + largest)
        elif abs(excess) < 1e-15:
            break
    for component in range(6):
        i, j = ROW[component], COLUMN[component]
        strain = 0.0
        for a in range(3):
            squared = 1.0 + (values[a] - first_lame * total) / shear
            strain += 0.5 * np.log(squared) * vectors[i, a] * vectors[j, a]
        elastic_strain[component] = SCALE[component] * strain
