"""The state of undisturbed ground, and how it changes from one height to another."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from install_mpm.constitutive import dispatch
from install_mpm.constitutive.mandel import COLUMN, ROW, SCALE
from install_mpm.constitutive.parameters import SoilParameters
from install_mpm.discretisation import GeostaticGradient
from install_mpm.ground import GroundProfile, Layer, geostatic_stress, material_at, soils_of, strata
from install_mpm.material_points import MaterialPoints

YIELD_SLACK = 1e-9
"""Yield function over stress that still counts as admissible: round-off of the initial state."""


class GeostaticState(NamedTuple):
    """What undisturbed ground carries, n places."""

    stress: np.ndarray
    """Cauchy stress, (n, 3, 3) in Pa."""
    elastic_strain: np.ndarray
    """Elastic strain, (n, 3, 3)."""
    state_variables: np.ndarray
    """State variables, (n, n_state); a soil with fewer has zeros behind its own."""
    material: np.ndarray
    """Row of the soil table, (n,) int64."""


def undisturbed_state(
    ground: GroundProfile, height: np.ndarray, vertical: int, material: np.ndarray | None = None
) -> GeostaticState:
    """Return the state of undisturbed ground at ``height`` (n,) in m.

    ``material`` (n,) is the row of the soil table, by default that of the soil that lies there.
    """
    rows = material_at(ground, height) if material is None else material
    stress = geostatic_stress(ground, height, vertical, rows)
    depth = np.maximum(-height, 0.0)
    strain = np.zeros_like(stress)
    state = np.zeros((len(height), n_state_variables(ground)))
    for row in np.unique(rows):
        here, soil = rows == row, strata(ground)[row].layer.soil
        own = dispatch.initial_state(soil, depth[here], stress[here])
        state[np.ix_(here, np.arange(own.shape[1]))] = own
        strain[here] = elastic_strain_of(soil, stress[here], own)
    return GeostaticState(stress, strain, state, rows.astype(np.int64))


def n_state_variables(ground: GroundProfile) -> int:
    """Return how many state variables the soil of the ground that has most of them has."""
    return max(len(dispatch.state_variable_names(row.layer.soil)) for row in strata(ground))


def elastic_strain_of(soil: SoilParameters, stress: np.ndarray, state: np.ndarray) -> np.ndarray:
    """Return the elastic strain (n, 3, 3) of ``soil`` of ``state`` (n, n_state) under ``stress``.

    ``stress`` is (n, 3, 3) in Pa.
    """
    material = np.zeros(len(stress), dtype=np.int64)
    strain = np.empty((len(stress), 6))
    six_vectors = np.ascontiguousarray(stress[:, ROW, COLUMN] * SCALE)
    dispatch.elastic_strain_from_stress_all(
        dispatch.pack([soil]), material, six_vectors, np.ascontiguousarray(state), strain
    )
    tensor = np.empty_like(stress)
    tensor[:, ROW, COLUMN] = tensor[:, COLUMN, ROW] = strain / SCALE
    return tensor


def geostatic_gradient(ground: GroundProfile, vertical: int) -> GeostaticGradient:
    """Return how geostatic stress and strain change with height, by row of the soil table."""
    rows = strata(ground)
    stress, strain = np.zeros((len(rows), 3, 3)), np.zeros((len(rows), 3, 3))
    curved = []
    for number, row in enumerate(rows):
        for axis in range(3):
            stress[number, axis, axis] = row.unit_weight * (1.0 if axis == vertical else row.k0)
        if dispatch.is_linear_elastic(row.layer.soil):
            per_metre = stress[number : number + 1]
            state = dispatch.initial_state(row.layer.soil, np.ones(1), -per_metre)
            strain[number] = elastic_strain_of(row.layer.soil, per_metre, state)[0]
        else:
            curved.append(number)
    return GeostaticGradient(strain, stress, tuple(curved), ground)


class Change(NamedTuple):
    """How the state of undisturbed ground differs between two heights, n pairs."""

    strain: np.ndarray
    """Elastic strain, (n, 3, 3)."""
    stress: np.ndarray
    """Cauchy stress, (n, 3, 3) in Pa."""
    state_variables: np.ndarray
    """(n, n_state); zero for a soil of linear elasticity, whose state stays with the material."""


def change_with_height(
    gradient: GeostaticGradient,
    material: np.ndarray,
    start: np.ndarray,
    end: np.ndarray,
    vertical: int,
    n_state: int,
) -> Change:
    """Return what changes from the height ``start`` to ``end`` (n,) in m in soil ``material``.

    Outside its own stratum the state of a soil of curved profile is taken not to change.
    """
    rise = (end - start)[:, None, None]
    strain, stress = gradient.strain[material] * rise, gradient.stress[material] * rise
    state = np.zeros((len(material), n_state))
    for row in gradient.curved:
        here = material == row
        below = _in_stratum(gradient, row, start[here], vertical)
        above = _in_stratum(gradient, row, end[here], vertical)
        strain[here] = above.elastic_strain - below.elastic_strain
        stress[here] = above.stress - below.stress
        state[here] = above.state_variables - below.state_variables
    return Change(strain, stress, state)


def geostatic_trace(
    gradient: GeostaticGradient, points: MaterialPoints
) -> tuple[np.ndarray, np.ndarray]:
    """Return the geostatic volumetric strain of each point, (n_points,), and its gradient in 1/m.

    Up to a constant of each soil.
    """
    height, vertical = points.position[:, -1], points.position.shape[1] - 1
    slope = np.trace(gradient.strain, axis1=1, axis2=2)[points.material]
    trace = slope * height
    for row in gradient.curved:
        here = points.material == row
        state = _in_stratum(gradient, row, height[here], vertical)
        trace[here] = np.trace(state.elastic_strain, axis1=1, axis2=2)
    return trace, slope


def _in_stratum(
    gradient: GeostaticGradient, row: int, height: np.ndarray, vertical: int
) -> GeostaticState:
    """Return the undisturbed state of the soil ``row`` at ``height``, or at its nearest end."""
    assert gradient.ground is not None
    stratum = strata(gradient.ground)[row]
    inside = np.clip(height, -stratum.bottom, -stratum.top)
    material = np.full(len(height), row, dtype=np.int64)
    return undisturbed_state(gradient.ground, inside, vertical, material)


def reference_state(
    ground: GroundProfile, material: np.ndarray, height: np.ndarray, vertical: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return stress (n, 3, 3) in Pa and state variables (n, n_state) that soil is compared with.

    The stress is geostatic at ``height`` with the K0 of ``material``, and goes on in a straight
    line above the surface.  The state is that of undisturbed soil of its stratum there, or at the
    nearest end of the stratum.
    """
    rows = strata(ground)
    tops, bottoms = (np.array([getattr(row, end) for row in rows]) for end in ("top", "bottom"))
    inside = np.clip(height, -bottoms[material], -tops[material])
    state = undisturbed_state(ground, inside, vertical, material).state_variables
    stress = geostatic_stress(ground, height, vertical, material)
    gradient = geostatic_gradient(ground, vertical).stress
    stress += np.maximum(height, 0.0)[:, None, None] * gradient[material]
    return stress, state


def first_beyond_strength(ground: GroundProfile, depth: float) -> tuple[Layer, float] | None:
    """Return the first layer down to ``depth`` in m, and where in it, K0 stress violates yield."""
    heights = -np.unique(np.concatenate([_ends(ground, depth), np.linspace(0.0, depth, 101)]))
    for row, stratum in enumerate(strata(ground)):
        inside = (heights <= -stratum.top) & (heights >= -stratum.bottom)
        places = heights[inside]
        if len(places) == 0:
            continue
        material = np.full(len(places), row, dtype=np.int64)
        state = undisturbed_state(ground, places, 1, material)
        value, six_vectors = np.empty(len(places)), state.stress[:, ROW, COLUMN] * SCALE
        dispatch.yield_function_all(
            dispatch.pack(soils_of(ground)), material, np.ascontiguousarray(six_vectors),
            state.state_variables, value,
        )  # fmt: skip
        beyond = value > YIELD_SLACK * np.abs(state.stress).max(axis=(1, 2))
        if beyond.any():
            return stratum.layer, float(-places[np.argmax(beyond)])
    return None


def _ends(ground: GroundProfile, depth: float) -> np.ndarray:
    """Return the depths (n,) in m down to ``depth`` at which strata begin or end."""
    ends = np.array([end for row in strata(ground) for end in (row.top, row.bottom)])
    return ends[ends <= depth]


def named_state(
    ground: GroundProfile, material: np.ndarray, state: np.ndarray, name: str
) -> np.ndarray | None:
    """Return the state variable ``name`` (n,) of points of soil ``material`` (n,).

    ``state`` is (n, n_state).  None if a soil of the ground has no variable of that name.
    """
    columns = []
    for stratum in strata(ground):
        names = dispatch.state_variable_names(stratum.layer.soil)
        if name not in names:
            return None
        columns.append(names.index(name))
    values: np.ndarray = state[np.arange(len(state)), np.array(columns)[material]]
    return values
