"""Model ids, packing of parameters, and evaluation of any soil law at one point or at all points.

Laws are chosen by an integer id in one ``if`` chain: compiled once, kept in numba's disk cache
(closures are not).
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from install_mpm._jit import jit, parallel_jit, prange
from install_mpm.constitutive import (
    drucker_prager,
    elastic,
    mohr_coulomb,
    neo_hookean,
    tresca,
    von_mises,
)
from install_mpm.constitutive.parameters import (
    DruckerPrager,
    HenckyElastic,
    MohrCoulomb,
    NeoHookean,
    SoilParameters,
    Tresca,
    VonMises,
)


class Model(IntEnum):
    """Soil laws; the number is what kernels and files carry."""

    HENCKY_ELASTIC = 0
    VON_MISES = 1
    NEO_HOOKEAN = 2
    TRESCA = 3
    MOHR_COULOMB = 4
    DRUCKER_PRAGER = 5


MODEL_OF = {
    HenckyElastic: Model.HENCKY_ELASTIC,
    VonMises: Model.VON_MISES,
    NeoHookean: Model.NEO_HOOKEAN,
    Tresca: Model.TRESCA,
    MohrCoulomb: Model.MOHR_COULOMB,
    DruckerPrager: Model.DRUCKER_PRAGER,
}
MODULE_OF = {
    Model.HENCKY_ELASTIC: elastic,
    Model.VON_MISES: von_mises,
    Model.NEO_HOOKEAN: neo_hookean,
    Model.TRESCA: tresca,
    Model.MOHR_COULOMB: mohr_coulomb,
    Model.DRUCKER_PRAGER: drucker_prager,
}
_VON_MISES, _NEO_HOOKEAN = int(Model.VON_MISES), int(Model.NEO_HOOKEAN)
_TRESCA = int(Model.TRESCA)
_MOHR_COULOMB, _DRUCKER_PRAGER = int(Model.MOHR_COULOMB), int(Model.DRUCKER_PRAGER)


class Materials(NamedTuple):
    """The soils of a run, one row each."""

    model: np.ndarray
    """Model id, (n_materials,) int64."""
    parameters: np.ndarray
    """Packed parameters, (n_materials, n_parameters); unused columns are zero."""


def pack(soils: Sequence[SoilParameters]) -> Materials:
    """Return the table of materials that the kernels read."""
    models = [MODEL_OF[type(soil)] for soil in soils]
    rows = [MODULE_OF[model].pack(soil) for model, soil in zip(models, soils, strict=True)]
    parameters = np.zeros((len(rows), max(map(len, rows))))
    for row, values in zip(parameters, rows, strict=True):
        row[: len(values)] = values
    return Materials(np.array(models, dtype=np.int64), parameters)


def state_variable_names(soil: SoilParameters) -> tuple[str, ...]:
    """Return the names of a law's state variables, one per column of ``state_variables``."""
    names: tuple[str, ...] = MODULE_OF[MODEL_OF[type(soil)]].STATE_VARIABLES
    return names


def is_linear_elastic(soil: SoilParameters) -> bool:
    """Return whether stress is linear in the elastic strain, so that geostatic strain is too."""
    module = MODULE_OF[MODEL_OF[type(soil)]]
    return module.elastic_strain_from_stress is elastic.elastic_strain_from_stress


def initial_state(soil: SoilParameters, depth: np.ndarray, stress: np.ndarray) -> np.ndarray:
    """Return the state variables (n, n_state) of undisturbed soil.

    Parameters
    ----------
    depth
        Depth (n,) in m below the surface.
    stress
        Initial Cauchy stress (n, 3, 3) in Pa, effective if there is pore water.
    """
    state: np.ndarray = MODULE_OF[MODEL_OF[type(soil)]].initial_state(soil, depth, stress)
    return state


@jit
def update_stress(
    model, trial_strain, parameters, state_old, stress, elastic_strain, state, tangent
):
    """Evaluate one soil law at one point, in small strain or (through ``hencky``) in finite strain.

    Parameters
    ----------
    model : int
        ``Model`` id.
    trial_strain : (6,)
        Elastic strain if the whole increment were elastic (Mandel).
    parameters : (n_parameters,)
        Packed parameters of the material.
    state_old : (n_state,)
        State variables at the start of the step.
    stress, elastic_strain, state, tangent
        Filled: stress (6,) in Pa, elastic strain (6,), state variables (n_state,), consistent
        tangent d(stress)/d(trial_strain) (6, 6) in Pa.

    Returns
    -------
    int
        0, or a positive number if the return to the yield surface failed; the step is then made
        shorter.
    """
    if model == _VON_MISES:
        return von_mises.update_stress(
            trial_strain, parameters, state_old, stress, elastic_strain, state, tangent
        )
    if model == _NEO_HOOKEAN:
        return neo_hookean.update_stress(
            trial_strain, parameters, state_old, stress, elastic_strain, state, tangent
        )
    if model == _TRESCA:
        return tresca.update_stress(
            trial_strain, parameters, state_old, stress, elastic_strain, state, tangent
        )
    if model == _MOHR_COULOMB:
        return mohr_coulomb.update_stress(
            trial_strain, parameters, state_old, stress, elastic_strain, state, tangent
        )
    if model == _DRUCKER_PRAGER:
        return drucker_prager.update_stress(
            trial_strain, parameters, state_old, stress, elastic_strain, state, tangent
        )
    return elastic.update_stress(
        trial_strain, parameters, state_old, stress, elastic_strain, state, tangent
    )


@jit
def elastic_strain_from_stress(model, stress, parameters, state, elastic_strain):
    """Fill the elastic strain (6,) of ``stress`` (6,) in Pa in soil of ``state`` (n_state,)."""
    if model == _NEO_HOOKEAN:
        neo_hookean.elastic_strain_from_stress(stress, parameters, state, elastic_strain)
        return
    elastic.elastic_strain_from_stress(stress, parameters, state, elastic_strain)


@jit
def yield_function(model, stress, parameters, state):
    """Return the yield function in Pa at one point; zero or negative is admissible."""
    if model == _VON_MISES:
        return von_mises.yield_function(stress, parameters, state)
    if model == _TRESCA:
        return tresca.yield_function(stress, parameters, state)
    if model == _MOHR_COULOMB:
        return mohr_coulomb.yield_function(stress, parameters, state)
    if model == _DRUCKER_PRAGER:
        return drucker_prager.yield_function(stress, parameters, state)
    return elastic.yield_function(stress, parameters, state)


@parallel_jit
def update_all(
    materials, material, trial_strain, state_old, stress, elastic_strain, state, tangent, status
):
    """Evaluate the laws at all points: arrays of ``update_stress`` with the point axis first.

    ``material`` (n,) is the row of ``materials``; the last five arrays are filled, ``status`` (n,)
    int64.
    """
    for p in prange(material.shape[0]):
        row = material[p]
        status[p] = update_stress(
            materials.model[row],
            trial_strain[p],
            materials.parameters[row],
            state_old[p],
            stress[p],
            elastic_strain[p],
            state[p],
            tangent[p],
        )


@parallel_jit
def elastic_strain_from_stress_all(materials, material, stress, state, elastic_strain):
    """Fill ``elastic_strain`` (n, 6) from ``stress`` (n, 6) in Pa and ``state`` at all points."""
    for p in prange(material.shape[0]):
        row = material[p]
        elastic_strain_from_stress(
            materials.model[row],
            stress[p],
            materials.parameters[row],
            state[p],
            elastic_strain[p],
        )


@parallel_jit
def yield_function_all(materials, material, stress, state, value):
    """Fill ``value`` (n,) in Pa with the yield function at all points."""
    for p in prange(material.shape[0]):
        row = material[p]
        value[p] = yield_function(
            materials.model[row], stress[p], materials.parameters[row], state[p]
        )
