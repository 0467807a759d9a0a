"""The undisturbed state of a finite-element model: the start of the wished-in-place pile."""

from __future__ import annotations

import numpy as np

from handoff.fe_state_file import FEState
from handoff.tensor_arrays import six_vectors, tensors_of
from install_mpm.constitutive import dispatch
from install_mpm.geostatic import undisturbed_state
from install_mpm.ground import GroundProfile, geostatic_stress, soils_of
from install_mpm.interface_axes import axes_of


def geostatic_state(
    ground: GroundProfile,
    integration_positions: np.ndarray,
    interface_positions: np.ndarray,
    interface_normals: np.ndarray,
    facet_normals: np.ndarray | None = None,
) -> FEState:
    """Return the undisturbed state at integration and interface points, positions (n, dim).

    Each integration point has the soil of the layer in which it lies.  The interface carries the
    traction that the geostatic stress exerts on its facets; their normals are by default the exact
    ones.
    """
    dim = integration_positions.shape[1]
    state = undisturbed_state(ground, integration_positions[:, -1], dim - 1)
    return FEState(
        cauchy_stress=state.stress,
        elastic_strain=state.elastic_strain,
        state_variables=state.state_variables,
        material=state.material,
        interface_traction=geostatic_traction(
            ground, interface_positions, interface_normals, facet_normals
        ),
        pile_displacement=np.zeros(dim),
    )


def geostatic_traction(
    ground: GroundProfile,
    positions: np.ndarray,
    normals: np.ndarray,
    facet_normals: np.ndarray | None = None,
) -> np.ndarray:
    """Return the traction (n, dim) on the soil, (tangential ..., normal), of the geostatic stress.

    It acts on the planes of the ``facet_normals``, by default the exact ``normals``, and is given
    in the local axes of the latter.
    """
    dim = positions.shape[1]
    stress = geostatic_stress(ground, positions[:, -1], dim - 1)[:, :dim, :dim]
    traction = np.einsum("nij,nj->ni", stress, normals if facet_normals is None else facet_normals)
    local: np.ndarray = np.einsum("nij,nj->ni", axes_of(normals, positions), traction)
    return local


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
