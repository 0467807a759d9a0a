"""Transfer of the whole installed state to the points of a finite-element model."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from handoff.equilibration import EquilibriumProblem
from handoff.fe_state_file import FEState
from handoff.geostatic import elastic_strain_of
from handoff.interface_transfer import FESurface
from handoff.options import HandoffOptions
from handoff.placed_pile import PlacedPile
from handoff.tensor_arrays import relative_norm
from handoff.transfer import TransferWeights, least_squares_weights, transferred
from install_mpm.conventions import vertical_axis
from install_mpm.geostatic import reference_state
from install_mpm.ground import GroundProfile, material_at
from install_mpm.material_points import MaterialPoints, cauchy_stress, plane_area
from install_mpm.state_file import InstalledState

FALLBACK_FROM = 2.0
"""Distance to the nearest point, in point sizes, from which the geostatic state is blended in."""
FALLBACK_FULL = 4.0
"""Distance, in point sizes, at which nothing but the geostatic state is left."""


class StateMap(NamedTuple):
    """How the integration points take their state from the material points."""

    weights: TransferWeights
    relative_distance: np.ndarray
    """Distance (n_q,) to the nearest visible material point over the size of the points around.

    That is the square root of their mean area, or the cube root of their mean volume: splitting
    leaves points of next to no volume, whose own size tells nothing.
    """
    geostatic_share: np.ndarray
    """Share (n_q,) of the geostatic state: 0 but for targets far from every material point."""


def state_map(
    points: MaterialPoints, placed: PlacedPile, targets: np.ndarray, options: HandoffOptions
) -> StateMap:
    """Return the map from material points to ``targets`` (n_q, dim).

    Points count with their area in the plane of the model, in space with their volume.

    Raises
    ------
    ValueError
        If there are fewer material points than ``options.neighbours``.
    """
    measure = plane_area(points, placed.kinematics)
    weights = least_squares_weights(
        points.position, measure, targets, options.neighbours, placed.obstacle()
    )
    size = measure[weights.neighbours].mean(axis=1) ** (1.0 / targets.shape[1])
    relative_distance = weights.distance / size
    if options.transfer == "nearest":
        weights = nearest_weights(weights)
    share = (relative_distance - FALLBACK_FROM) / (FALLBACK_FULL - FALLBACK_FROM)
    return StateMap(weights, relative_distance, np.clip(share, 0.0, 1.0))


def nearest_weights(weights: TransferWeights) -> TransferWeights:
    """Return weights that take the state of the nearest visible point of ``weights`` as it is."""
    return weights._replace(
        neighbours=weights.nearest[:, None], weights=np.ones((len(weights.nearest), 1))
    )


def state_map_onto(
    problem: EquilibriumProblem,
    points: MaterialPoints,
    placed: PlacedPile,
    options: HandoffOptions,
) -> StateMap:
    """Return the map from material points to all integration points of ``problem``.

    Each rank of MPI finds the weights of its own.

    Raises
    ------
    ValueError
        If there are fewer material points than ``options.neighbours``.
    """
    targets = problem.integration_positions[problem.own_points]
    own = state_map(points, placed, targets, options)
    return StateMap(
        TransferWeights(*map(problem.whole, own.weights)),
        problem.whole(own.relative_distance),
        problem.whole(own.geostatic_share),
    )


def mapped(state_map: StateMap, difference: np.ndarray, geostatic: np.ndarray) -> np.ndarray:
    """Return ``geostatic`` values (n_q, ...) plus the ``difference`` (p, ...) of points to them.

    The difference fades to zero far from every material point.  Undisturbed ground comes out
    exactly, whatever its layers and however its state varies with the depth.
    """
    share = state_map.geostatic_share.reshape(-1, *[1] * (difference.ndim - 1))
    total: np.ndarray = geostatic + (1.0 - share) * transferred(state_map.weights, difference)
    return total


def map_errors(
    at_points: np.ndarray,
    reference: np.ndarray,
    state_map: StateMap,
    volumes: np.ndarray,
    is_near: np.ndarray,
) -> tuple[float, float]:
    """Return the relative L2 errors of the mapped synthetic field, everywhere and near the pile.

    ``at_points`` (p, 3, 3) and ``reference`` (n_q, 3, 3) are the self-equilibrated part of the
    field at material points and integration points.  Both errors are over its norm alone, because
    the geostatic part, though far larger, is mapped exactly.  ``is_near`` (n_q,) tells what is
    near.
    """
    error = mapped(state_map, at_points, np.zeros_like(reference)) - reference
    return (
        relative_norm(error, reference, volumes),
        relative_norm(error[is_near], reference[is_near], volumes[is_near]),
    )


def transfer_state(
    installed: InstalledState,
    ground: GroundProfile,
    placed: PlacedPile,
    problem: EquilibriumProblem,
    state_map: StateMap,
) -> FEState:
    """Return the installed state at the points of ``problem``, neither admissible nor balanced yet.

    Each target takes the soil of the nearest material point.  Its state variables stay between the
    least and the greatest of that soil: the fit may overshoot.

    Raises
    ------
    ValueError
        If no soil touches a part of the pile.
    """
    points, height = installed.material_points, problem.integration_positions[:, -1]
    vertical = vertical_axis(placed.kinematics)
    is_beside_points = state_map.geostatic_share < 1.0
    nearest = points.material[state_map.weights.nearest]
    material = np.where(is_beside_points, nearest, material_at(ground, height))
    at_points = reference_state(ground, points.material, points.position[:, -1], vertical)
    at_targets = reference_state(ground, material, height, vertical)
    stress = mapped(state_map, cauchy_stress(points) - at_points[0], at_targets[0])
    variables = mapped(state_map, points.state_variables - at_points[1], at_targets[1])
    variables = _within_soil(variables, material, points, at_targets[1])
    return FEState(
        cauchy_stress=stress,
        elastic_strain=elastic_strain_of(ground, material, stress, variables),
        state_variables=variables,
        material=material,
        interface_traction=placed.traction(ground, installed, surface_of(problem)),
        pile_displacement=np.zeros(problem.interface_positions.shape[1]),
    )


def surface_of(problem: EquilibriumProblem) -> FESurface:
    """Return the interface points of a finite-element model."""
    return FESurface(
        problem.interface_positions,
        problem.interface_normals,
        problem.interface_facet_normals,
        problem.interface_areas,
        problem.interface_parts,
    )


def _within_soil(
    variables: np.ndarray, material: np.ndarray, points: MaterialPoints, geostatic: np.ndarray
) -> np.ndarray:
    """Return the state variables (n_q, n_state) within what points and undisturbed ground have."""
    bounded = variables.copy()
    for row in np.unique(material):
        here = material == row
        known = np.vstack([points.state_variables[points.material == row], geostatic[here]])
        bounded[here] = np.clip(bounded[here], known.min(axis=0), known.max(axis=0))
    return bounded
