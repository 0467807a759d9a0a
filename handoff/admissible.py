"""Admissibility: stresses are returned to the yield surface, tractions to the slip limit.

An average of admissible stresses is admissible where the yield surface is convex, but moving least
squares has negative weights, and the strength is averaged too.  The soil law itself, called with no
strain increment, brings back what lies outside and leaves all else untouched.  An average of open
soil, which carries no pressure until the opening has closed, with soil under pressure is closed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from handoff.fe_state_file import FEState
from handoff.geostatic import elastic_strain_of
from handoff.tensor_arrays import six_vectors, tensors_of
from install_mpm.constitutive import coulomb_interface, dispatch
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.ground import GroundProfile, soils_of, undrained_shear_strength
from install_mpm.interface import with_strength_share

AT_REST = 1e-9
"""Relative change of the stress that counts as none."""


class YieldCorrections(NamedTuple):
    """How many stresses were returned to the yield surface, and how far."""

    share: float
    """Corrected points over all points."""
    mean: float
    """Mean over the corrected points of |stress change| over |deviatoric stress| before."""
    largest: float
    """Largest of the same."""


def admissible_state(
    ground: GroundProfile,
    interface: CoulombInterface,
    interface_positions: np.ndarray,
    strength_share: np.ndarray,
    state: FEState,
) -> tuple[FEState, YieldCorrections]:
    """Return the state with every stress inside its yield surface and every traction its limit.

    ``interface_positions`` (n_i, dim) in m are those of the tractions, ``strength_share`` (n_i,)
    multiplies the shear strength there.  The second value tells how many stresses were corrected,
    and by how much.

    Raises
    ------
    ValueError
        If the soil law cannot return a stress, which names the first such integration point.
    """
    state = _with_openings_closed(ground, state)
    outside = np.flatnonzero(yield_values(ground, state) > 0.0)
    stress, strain, variables = _returned(ground, state, outside)
    corrected = state._replace(
        cauchy_stress=_with_rows(state.cauchy_stress, outside, tensors_of(stress)),
        elastic_strain=_with_rows(state.elastic_strain, outside, tensors_of(strain)),
        state_variables=_with_rows(state.state_variables, outside, variables),
        interface_traction=admissible_traction(
            ground, interface, interface_positions, strength_share, state.interface_traction
        ),
    )
    before = six_vectors(state.cauchy_stress[outside])
    return corrected, _corrections(before, stress, len(state.material))


def _with_openings_closed(ground: GroundProfile, state: FEState) -> FEState:
    """Return the state without openings, but where the soil carries nothing in any case.

    What was open is taken out of the specific volume, as in the installation.
    """
    opening = np.zeros_like(state.state_variables, dtype=bool)
    materials = dispatch.pack(soils_of(ground))
    columns = dispatch.state_columns(materials, "opening")[state.material]
    has_one = np.flatnonzero(columns >= 0)
    opening[has_one, columns[has_one]] = True
    opening &= state.state_variables > 0.0
    places = np.flatnonzero(opening.any(axis=1))
    closed = state._replace(state_variables=np.where(opening, 0.0, state.state_variables))
    with_it, without = (_returned(ground, each, places)[0] for each in (state, closed))
    change = np.abs(with_it - without).max(axis=1)
    opening[places[change <= AT_REST * np.abs(without).max(axis=1)]] = False
    variables = np.where(opening, 0.0, state.state_variables)
    log_volumes = dispatch.log_volume_columns(materials)[state.material]
    has_volume = np.flatnonzero(log_volumes >= 0)
    closed = (state.state_variables - variables)[has_volume].sum(axis=1)
    variables[has_volume, log_volumes[has_volume]] -= closed
    return state._replace(state_variables=variables)


def _returned(
    ground: GroundProfile, state: FEState, outside: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return stress (n, 6), elastic strain (n, 6) and state variables on the yield surface."""
    material = state.material[outside]
    variables = state.state_variables[outside]
    trial = six_vectors(
        elastic_strain_of(ground, material, state.cauchy_stress[outside], variables)
    )
    count, status = len(outside), np.zeros(len(outside), dtype=np.int64)
    stress, strain, new_variables = np.empty((count, 6)), np.empty((count, 6)), variables.copy()
    tangent = np.empty((count, 6, 6))
    dispatch.update_all(
        dispatch.pack(soils_of(ground)),
        material,
        trial,
        variables,
        stress,
        strain,
        new_variables,
        tangent,
        status,
    )
    if status.any():
        raise ValueError(
            "the soil law could not return the transferred stress of integration point"
            f" {outside[np.argmax(status != 0)]} to the yield surface;"
            " look at the installed stresses beside it"
        )
    return stress, strain, new_variables


def _with_rows(array: np.ndarray, rows: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return a copy of ``array`` with some rows replaced."""
    copy = array.copy()
    copy[rows] = values
    return copy


def yield_values(ground: GroundProfile, state: FEState) -> np.ndarray:
    """Return the yield function (n_q,) in Pa of the state; zero or negative is admissible."""
    values = np.empty(len(state.material))
    dispatch.yield_function_all(
        dispatch.pack(soils_of(ground)),
        state.material,
        six_vectors(state.cauchy_stress),
        np.ascontiguousarray(state.state_variables),
        values,
    )
    return values


def admissible_traction(
    ground: GroundProfile,
    interface: CoulombInterface,
    positions: np.ndarray,
    strength_share: np.ndarray,
    traction: np.ndarray,
) -> np.ndarray:
    """Return the tractions (n, dim) at ``positions`` (n, dim), reduced to the slip limit.

    The shear strength counts with its ``strength_share`` (n,).
    """
    strength = undrained_shear_strength(ground, positions[:, -1])
    count, dim = traction.shape
    returned = np.empty((count, dim))
    coulomb_interface.update_all(
        np.zeros((count, dim)),
        with_strength_share(coulomb_interface.pack(interface, strength), strength_share),
        np.ascontiguousarray(traction),
        returned,
        np.empty((count, dim, dim)),
        np.empty(count, dtype=np.int64),
    )
    return returned


def _corrections(before: np.ndarray, after: np.ndarray, n_points: int) -> YieldCorrections:
    """Return the statistics of the changes of the six-vectors (n, 6) that were corrected."""
    if len(before) == 0:
        return YieldCorrections(0.0, 0.0, 0.0)
    deviator = before.copy()
    deviator[:, :3] -= before[:, :3].mean(axis=1, keepdims=True)
    size = np.linalg.norm(after - before, axis=1) / np.linalg.norm(deviator, axis=1)
    return YieldCorrections(len(before) / n_points, float(size.mean()), float(size.max()))
