"""Model ids, packing of parameters, and evaluation of any soil law at one point or at all points.

Laws are chosen by an integer id in one ``if`` chain: compiled once, kept in numba's disk cache
(closures are not).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from install_mpm._jit import jit, parallel_jit, prange
from install_mpm.constitutive import (
    critical_state_sand,
    drucker_prager,
    elastic,
    modified_cam_clay,
    mohr_coulomb,
    neo_hookean,
    tresca,
    undrained,
    von_mises,
)
from install_mpm.constitutive.mandel import COLUMN, ROW, SCALE
from install_mpm.constitutive.models import MODEL_OF, MODULE_OF, Model
from install_mpm.constitutive.parameters import SoilParameters

__all__ = ["MODEL_OF", "MODULE_OF", "Materials", "Model"]


_VON_MISES, _NEO_HOOKEAN = int(Model.VON_MISES), int(Model.NEO_HOOKEAN)
_TRESCA = int(Model.TRESCA)
_MOHR_COULOMB, _DRUCKER_PRAGER = int(Model.MOHR_COULOMB), int(Model.DRUCKER_PRAGER)
_MODIFIED_CAM_CLAY = int(Model.MODIFIED_CAM_CLAY)
_CRITICAL_STATE_SAND = int(Model.CRITICAL_STATE_SAND)


class Materials(NamedTuple):
    """The soils of a run, one row each."""

    model: np.ndarray
    """Model id, (n_materials,) int64."""
    parameters: np.ndarray
    """Packed parameters, (n_materials, n_parameters); unused columns are zero.

    The last column is the bulk modulus of the pore fluid in Pa, zero in drained soil.
    """


def pack(soils: Sequence[SoilParameters]) -> Materials:
    """Return the table of materials that the kernels read."""
    models = [MODEL_OF[type(soil)] for soil in soils]
    rows = [MODULE_OF[model].pack(soil) for model, soil in zip(models, soils, strict=True)]
    parameters = np.zeros((len(rows), max(map(len, rows)) + 1))
    for row, values, soil in zip(parameters, rows, soils, strict=True):
        row[: len(values)] = values
        row[undrained.FLUID] = pore_fluid_bulk_modulus(soil)
    return Materials(np.array(models, dtype=np.int64), parameters)


def pore_fluid_bulk_modulus(soil: SoilParameters) -> float:
    """Return the bulk modulus in Pa of the pore fluid, zero for drained and total-stress laws."""
    return float(getattr(soil, "pore_fluid_bulk_modulus", 0.0))


def state_variable_names(soil: SoilParameters) -> tuple[str, ...]:
    """Return the names of a law's state variables, one per column of ``state_variables``."""
    names: tuple[str, ...] = MODULE_OF[MODEL_OF[type(soil)]].STATE_VARIABLES
    return undrained.STATE_VARIABLES + names if pore_fluid_bulk_modulus(soil) > 0.0 else names


def state_columns(materials: Materials, name: str) -> np.ndarray:
    """Return the column (n_materials,) of the state variable ``name``, -1 where there is none."""
    columns = np.full(len(materials.model), -1)
    for row, (model, parameters) in enumerate(zip(*materials, strict=True)):
        names = MODULE_OF[Model(model)].STATE_VARIABLES
        if name in names:
            before = undrained.N_STATE if parameters[undrained.FLUID] > 0.0 else 0
            columns[row] = before + names.index(name)
    return columns


def log_volume_columns(materials: Materials) -> np.ndarray:
    """Return the column (n_materials,) of ``plastic_log_volume``, -1 where there is none.

    Undrained soil has none: its volume is in the elastic strain.
    """
    is_drained = materials.parameters[:, undrained.FLUID] == 0.0
    return np.where(is_drained, state_columns(materials, "plastic_log_volume"), -1)


def is_linear_elastic(soil: SoilParameters) -> bool:
    """Return whether geostatic strain and state are linear: Hooke's law without pore fluid."""
    module = MODULE_OF[MODEL_OF[type(soil)]]
    if pore_fluid_bulk_modulus(soil) > 0.0:
        return False
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
    if pore_fluid_bulk_modulus(soil) == 0.0:
        return state
    strain = np.empty((len(depth), 6))
    six_vectors = np.ascontiguousarray(stress[:, ROW, COLUMN] * SCALE)
    materials = pack([soil])
    materials.parameters[:, undrained.FLUID] = 0.0  # the strain of the skeleton alone
    material = np.zeros(len(depth), dtype=np.int64)
    elastic_strain_from_stress_all(materials, material, six_vectors, state, strain)
    return undrained.initial_state(state, strain)


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
    fluid = parameters[undrained.FLUID]
    if fluid == 0.0:
        return _update_skeleton(
            model, trial_strain, parameters, state_old, stress, elastic_strain, state, tangent
        )
    skeleton_strain = np.empty(6)
    undrained.skeleton_strain(trial_strain, state_old, skeleton_strain)
    status = _update_skeleton(
        model, skeleton_strain, parameters, state_old[undrained.N_STATE :], stress, elastic_strain,
        state[undrained.N_STATE :], tangent,
    )  # fmt: skip
    undrained.add_pore_fluid(trial_strain, fluid, stress, elastic_strain, state, tangent)
    return status


@jit
def _update_skeleton(
    model, trial_strain, parameters, state_old, stress, elastic_strain, state, tangent
):
    """Evaluate the law of the soil skeleton: effective stress, or total stress without water."""
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
    if model == _MODIFIED_CAM_CLAY:
        return modified_cam_clay.update_stress(
            trial_strain, parameters, state_old, stress, elastic_strain, state, tangent
        )
    if model == _CRITICAL_STATE_SAND:
        return critical_state_sand.update_stress(
            trial_strain, parameters, state_old, stress, elastic_strain, state, tangent
        )
    return elastic.update_stress(
        trial_strain, parameters, state_old, stress, elastic_strain, state, tangent
    )


@jit
def elastic_strain_from_stress(model, stress, parameters, state, elastic_strain):
    """Fill the elastic strain (6,) of ``stress`` (6,) in Pa in soil of ``state`` (n_state,).

    In undrained soil the pore pressure follows from both: the share of the mean stress that the
    skeleton does not carry at the volume that ``state`` gives it.
    """
    fluid = parameters[undrained.FLUID]
    if fluid == 0.0:
        _skeleton_strain_from_stress(model, stress, parameters, state, elastic_strain)
        return
    skeleton, search = state[undrained.N_STATE :], np.empty(undrained.N_SEARCH)
    effective = np.empty(6)
    undrained.start_search(state, search)
    for _ in range(undrained.MAX_ITERATIONS):
        undrained.effective_stress(stress, search[0], effective)
        _skeleton_strain_from_stress(model, effective, parameters, skeleton, elastic_strain)
        if undrained.is_found(elastic_strain, state, fluid, search):
            break
    undrained.add_volume(state, elastic_strain)


@jit
def _skeleton_strain_from_stress(model, stress, parameters, state, elastic_strain):
    """Fill the elastic strain (6,) of the soil skeleton."""
    if model == _NEO_HOOKEAN:
        neo_hookean.elastic_strain_from_stress(stress, parameters, state, elastic_strain)
    elif model == _MODIFIED_CAM_CLAY:
        modified_cam_clay.elastic_strain_from_stress(stress, parameters, state, elastic_strain)
    elif model == _CRITICAL_STATE_SAND:
        critical_state_sand.elastic_strain_from_stress(stress, parameters, state, elastic_strain)
    else:
        elastic.elastic_strain_from_stress(stress, parameters, state, elastic_strain)


@jit
def yield_function(model, stress, parameters, state):
    """Return the yield function in Pa at one point; zero or negative is admissible."""
    if parameters[undrained.FLUID] == 0.0:
        return _skeleton_yield_function(model, stress, parameters, state)
    effective = np.empty(6)
    undrained.effective_stress(stress, state[undrained.PORE_PRESSURE], effective)
    return _skeleton_yield_function(model, effective, parameters, state[undrained.N_STATE :])


@jit
def _skeleton_yield_function(model, stress, parameters, state):
    """Return the yield function in Pa of the soil skeleton."""
    if model == _VON_MISES:
        return von_mises.yield_function(stress, parameters, state)
    if model == _TRESCA:
        return tresca.yield_function(stress, parameters, state)
    if model == _MOHR_COULOMB:
        return mohr_coulomb.yield_function(stress, parameters, state)
    if model == _DRUCKER_PRAGER:
        return drucker_prager.yield_function(stress, parameters, state)
    if model == _MODIFIED_CAM_CLAY:
        return modified_cam_clay.yield_function(stress, parameters, state)
    if model == _CRITICAL_STATE_SAND:
        return critical_state_sand.yield_function(stress, parameters, state)
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
