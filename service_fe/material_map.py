"""Soil at the integration points: calls the laws of ``install_mpm.constitutive`` in small strain.

The constitutive models are shared with the installation stage and live in
``install_mpm/constitutive``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from handoff.fe_state_file import FEState
from handoff.tensor_arrays import six_vectors
from install_mpm.constitutive import dispatch
from install_mpm.constitutive.dispatch import Materials


class SoilResponse(NamedTuple):
    """Soil at all integration points after an increment of strain; six-vectors in Mandel order."""

    stress: np.ndarray
    """Cauchy stress (n_q, 6) in Pa."""
    elastic_strain: np.ndarray
    """Elastic strain (n_q, 6)."""
    state_variables: np.ndarray
    """State variables (n_q, n_state)."""
    tangent: np.ndarray
    """Consistent tangent (n_q, 6, 6) in Pa."""
    n_failed: int
    """Points whose return to the yield surface failed."""


def soil_response(
    materials: Materials, state: FEState, strain_increment: np.ndarray
) -> SoilResponse:
    """Return the soil's response to ``strain_increment`` (n_q, 6) from the accepted ``state``.

    ``state`` is read, never written.
    """
    n_points = len(state.material)
    stress, elastic_strain = np.empty((n_points, 6)), np.empty((n_points, 6))
    state_variables = np.empty_like(state.state_variables)
    tangent = np.empty((n_points, 6, 6))
    status = np.zeros(n_points, dtype=np.int64)
    trial_strain = six_vectors(state.elastic_strain) + strain_increment
    dispatch.update_all(
        materials, state.material, trial_strain, state.state_variables,
        stress, elastic_strain, state_variables, tangent, status,
    )  # fmt: skip
    return SoilResponse(
        stress, elastic_strain, state_variables, tangent, int(np.count_nonzero(status))
    )
