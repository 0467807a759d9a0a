"""Admissibility: stresses are returned to the yield surface, tractions to the slip limit.

An average of admissible stresses is admissible where the yield surface is convex, but moving least
squares has negative weights, and the strength is averaged too.  The soil law itself, called with no
strain increment, brings back what lies outside and leaves all else untouched.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from handoff.fe_state_file import FEState
from handoff.geostatic import VERTICAL, elastic_strain_of
from handoff.tensor_arrays import six_vectors, tensors_of
from install_mpm.constitutive import coulomb_interface, dispatch
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.ground import Ground, undrained_shear_strength


class YieldCorrections(NamedTuple):
    """How many stresses were returned to the yield surface, and how far."""

    share: float
    """Corrected points over all points."""
    mean: float
    """Mean over the corrected points of |stress change| over |deviatoric stress| before."""
    largest: float
    """Largest of the same."""


def admissible_state(ground: Ground, state: FEState) -> tuple[FEState, YieldCorrections]:
    """Return the state with every stress on or inside its yield surface, and what that took.

    Raises
    ------
    ValueError
        If the soil law cannot return a stress, which names the first such integration point.
    """
    materials = dispatch.pack([ground.soil])
    transferred = six_vectors(state.cauchy_stress)
    overstress = yield_values(ground, state)
    outside = np.flatnonzero(overstress > 0.0)
    strain = six_vectors(elastic_strain_of(ground, state.material, state.cauchy_stress))
    stress, elastic, variables = transferred.copy(), strain.copy(), state.state_variables.copy()
    new_stress, new_elastic, new_variables = (
        array[outside] for array in (stress, elastic, variables)
    )
    status = np.zeros(len(outside), dtype=np.int64)
    dispatch.update_all(
        materials,
        state.material[outside],
        strain[outside],
        variables[outside],
        new_stress,
        new_elastic,
        new_variables,
        np.empty((len(outside), 6, 6)),
        status,
    )
    if status.any():
        point = outside[np.argmax(status != 0)]
        raise ValueError(
            f"the soil law could not return the transferred stress of integration point {point}"
            " to the yield surface; look at the installed stresses beside it"
        )
    stress[outside], elastic[outside], variables[outside] = new_stress, new_elastic, new_variables
    corrected = state._replace(
        cauchy_stress=tensors_of(stress),
        elastic_strain=tensors_of(elastic),
        state_variables=variables,
    )
    return corrected, _corrections(transferred, stress, outside)


def yield_values(ground: Ground, state: FEState) -> np.ndarray:
    """Return the yield function (n_q,) in Pa of the state; zero or negative is admissible."""
    values = np.empty(len(state.material))
    dispatch.yield_function_all(
        dispatch.pack([ground.soil]),
        state.material,
        six_vectors(state.cauchy_stress),
        np.ascontiguousarray(state.state_variables),
        values,
    )
    return values


def admissible_traction(
    ground: Ground, interface: CoulombInterface, positions: np.ndarray, traction: np.ndarray
) -> np.ndarray:
    """Return the tractions (n, 2) at ``positions`` (n, 2), reduced to the slip limit."""
    strength = undrained_shear_strength(ground, positions[:, VERTICAL])
    count = len(traction)
    returned = np.empty((count, 2))
    coulomb_interface.update_all(
        np.zeros((count, 2)),
        coulomb_interface.pack(interface, strength),
        np.ascontiguousarray(traction),
        returned,
        np.empty((count, 2, 2)),
        np.empty(count, dtype=np.int64),
    )
    return returned


def _corrections(before: np.ndarray, after: np.ndarray, outside: np.ndarray) -> YieldCorrections:
    """Return the statistics of the stress changes of six-vectors (n, 6) at points ``outside``."""
    if len(outside) == 0:
        return YieldCorrections(0.0, 0.0, 0.0)
    deviator = before[outside].copy()
    deviator[:, :3] -= deviator[:, :3].mean(axis=1, keepdims=True)
    change = np.linalg.norm(after[outside] - before[outside], axis=1)
    size = change / np.linalg.norm(deviator, axis=1)
    return YieldCorrections(len(outside) / len(before), float(size.mean()), float(size.max()))
