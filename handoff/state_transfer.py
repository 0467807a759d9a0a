"""Transfer of the whole installed state to the points of a finite-element model."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from handoff.equilibration import EquilibriumProblem
from handoff.fe_state_file import FEState
from handoff.geostatic import VERTICAL, elastic_strain_of
from handoff.interface_transfer import transferred_traction
from handoff.transfer import Obstacle, TransferWeights, least_squares_weights, transferred
from install_mpm.conventions import Kinematics
from install_mpm.geostatic import reference_state
from install_mpm.ground import GroundProfile, material_at
from install_mpm.material_points import MaterialPoints, cauchy_stress, plane_area
from install_mpm.pile import Pile
from install_mpm.state_file import InstalledState

FALLBACK_FROM = 2.0
"""Distance to the nearest point, in point sizes, from which the geostatic state is blended in."""
FALLBACK_FULL = 4.0
"""Distance, in point sizes, at which nothing but the geostatic state is left."""


class StateMap(NamedTuple):
    """How the integration points take their state from the material points."""

    weights: TransferWeights
    relative_distance: np.ndarray
    """Distance (n_q,) to the nearest visible material point over its size sqrt(area)."""
    geostatic_share: np.ndarray
    """Share (n_q,) of the geostatic state: 0 but for targets far from every material point."""


def state_map(
    points: MaterialPoints,
    pile: Pile,
    tip_depth: float,
    targets: np.ndarray,
    neighbours: int,
    kinematics: Kinematics = Kinematics.PLANE_STRAIN,
) -> StateMap:
    """Return the map from material points to ``targets`` (n_q, 2).

    Points count with their area in the plane of the model.

    Raises
    ------
    ValueError
        If there are fewer material points than ``neighbours``.
    """
    obstacle = Obstacle(pile.half_width, -tip_depth)
    area = plane_area(points, kinematics)
    weights = least_squares_weights(points.position, area, targets, neighbours, obstacle)
    relative_distance = weights.distance / np.sqrt(area[weights.nearest])
    share = (relative_distance - FALLBACK_FROM) / (FALLBACK_FULL - FALLBACK_FROM)
    return StateMap(weights, relative_distance, np.clip(share, 0.0, 1.0))


def mapped(state_map: StateMap, difference: np.ndarray, geostatic: np.ndarray) -> np.ndarray:
    """Return ``geostatic`` values (n_q, ...) plus the ``difference`` (p, ...) of points to them.

    The difference fades to zero far from every material point.  Undisturbed ground comes out
    exactly, whatever its layers and however its state varies with the depth.
    """
    share = state_map.geostatic_share.reshape(-1, *[1] * (difference.ndim - 1))
    total: np.ndarray = geostatic + (1.0 - share) * transferred(state_map.weights, difference)
    return total


def transfer_state(
    installed: InstalledState,
    ground: GroundProfile,
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
    points, height = installed.material_points, problem.integration_positions[:, VERTICAL]
    is_beside_points = state_map.geostatic_share < 1.0
    nearest = points.material[state_map.weights.nearest]
    material = np.where(is_beside_points, nearest, material_at(ground, height))
    at_points = reference_state(ground, points.material, points.position[:, VERTICAL], VERTICAL)
    at_targets = reference_state(ground, material, height, VERTICAL)
    stress = mapped(state_map, cauchy_stress(points) - at_points[0], at_targets[0])
    variables = mapped(state_map, points.state_variables - at_points[1], at_targets[1])
    variables = _within_soil(variables, material, points, at_targets[1])
    return FEState(
        cauchy_stress=stress,
        elastic_strain=elastic_strain_of(ground, material, stress, variables),
        state_variables=variables,
        material=material,
        interface_traction=transferred_traction(
            ground,
            installed.interface,
            problem.interface_positions,
            problem.interface_areas,
            problem.interface_parts,
        ),
        pile_displacement=np.zeros(2),
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
