"""The undisturbed state of a finite-element model: the start of the wished-in-place pile."""

from __future__ import annotations

import numpy as np

from handoff.fe_state_file import FEState
from handoff.tensor_arrays import six_vectors, tensors_of
from install_mpm.constitutive import dispatch
from install_mpm.conventions import Kinematics, vertical_axis
from install_mpm.geostatic import undisturbed_state
from install_mpm.ground import GroundProfile, geostatic_stress, soils_of
from install_mpm.pile import tangent_of

VERTICAL = vertical_axis(Kinematics.PLANE_STRAIN)


def geostatic_state(
    ground: GroundProfile,
    integration_positions: np.ndarray,
    interface_positions: np.ndarray,
    interface_normals: np.ndarray,
) -> FEState:
    """Return the undisturbed state at integration points (n_q, 2) and interface points (n_i, 2).

    Each integration point has the soil of the layer in which it lies.  The interface carries the
    traction that the geostatic stress exerts on its plane.
    """
    state = undisturbed_state(ground, integration_positions[:, VERTICAL], VERTICAL)
    return FEState(
        cauchy_stress=state.stress,
        elastic_strain=state.elastic_strain,
        state_variables=state.state_variables,
        material=state.material,
        interface_traction=geostatic_traction(ground, interface_positions, interface_normals),
        pile_displacement=np.zeros(2),
    )


def geostatic_traction(
    ground: GroundProfile, positions: np.ndarray, normals: np.ndarray
) -> np.ndarray:
    """Return the traction (n, 2) on the soil, (tangential, normal), of the geostatic stress."""
    stress = geostatic_stress(ground, positions[:, VERTICAL], VERTICAL)[:, :2, :2]
    traction = np.einsum("nij,nj->ni", stress, normals)
    tangents = tangent_of(normals)
    return np.column_stack([np.einsum("ni,ni->n", traction, axis) for axis in (tangents, normals)])


def elastic_strain_of(
    ground: GroundProfile, material: np.ndarray, stress: np.ndarray, state: np.ndarray
) -> np.ndarray:
    """Return the small elastic strain (n, 3, 3) that carries the Cauchy ``stress`` (n, 3, 3).

    ``state`` (n, n_state) holds the state variables.
    """
    strain = np.empty((len(stress), 6))
    dispatch.elastic_strain_from_stress_all(
        dispatch.pack(soils_of(ground)),
        material,
        six_vectors(stress),
        np.ascontiguousarray(state),
        strain,
    )
    return tensors_of(strain)
