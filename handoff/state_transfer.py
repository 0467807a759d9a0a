"""Transfer of the whole installed state to the points of a finite-element model."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from handoff.equilibration import EquilibriumProblem
from handoff.fe_state_file import FEState
from handoff.geostatic import elastic_strain_of, geostatic_state
from handoff.interface_transfer import transferred_traction
from handoff.transfer import Obstacle, TransferWeights, least_squares_weights, transferred
from install_mpm.ground import Ground
from install_mpm.material_points import MaterialPoints, cauchy_stress
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
    """Distance (n_q,) to the nearest visible material point over its size sqrt(volume)."""
    geostatic_share: np.ndarray
    """Share (n_q,) of the geostatic state: 0 but for targets far from every material point."""


def state_map(
    points: MaterialPoints, pile: Pile, tip_depth: float, targets: np.ndarray, neighbours: int
) -> StateMap:
    """Return the map from material points to ``targets`` (n_q, 2).

    Raises
    ------
    ValueError
        If there are fewer material points than ``neighbours``.
    """
    obstacle = Obstacle(pile.half_width, -tip_depth)
    weights = least_squares_weights(points.position, points.volume, targets, neighbours, obstacle)
    relative_distance = weights.distance / np.sqrt(points.volume[weights.nearest])
    share = (relative_distance - FALLBACK_FROM) / (FALLBACK_FULL - FALLBACK_FROM)
    return StateMap(weights, relative_distance, np.clip(share, 0.0, 1.0))


def mapped(state_map: StateMap, values: np.ndarray, geostatic: np.ndarray) -> np.ndarray:
    """Return point ``values`` (p, ...) at the targets, blended with ``geostatic`` (n_q, ...)."""
    share = state_map.geostatic_share.reshape(-1, *[1] * (values.ndim - 1))
    blended: np.ndarray = (1.0 - share) * transferred(state_map.weights, values) + share * geostatic
    return blended


def transfer_state(
    installed: InstalledState, ground: Ground, problem: EquilibriumProblem, state_map: StateMap
) -> FEState:
    """Return the installed state at the points of ``problem``, neither admissible nor balanced yet.

    State variables that no material point has negative stay so: the fit may overshoot.

    Raises
    ------
    ValueError
        If no soil touches a part of the pile.
    """
    points = installed.material_points
    geostatic = geostatic_state(
        ground,
        problem.integration_positions,
        problem.interface_positions,
        problem.interface_normals,
    )
    stress = mapped(state_map, cauchy_stress(points), geostatic.cauchy_stress)
    variables = mapped(state_map, points.state_variables, geostatic.state_variables)
    floor = np.where((points.state_variables >= 0.0).all(axis=0), 0.0, -np.inf)
    variables = np.maximum(variables, floor)
    material = points.material[state_map.weights.nearest]
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
