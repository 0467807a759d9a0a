"""Transfer of fields from material points: volume-weighted linear moving least squares.

With weights w_p = V_p (1 - (d_p / R)^2)^2 of the k nearest points, their mean position x_m and
their second moment C = sum w (x_p - x_m)(x_p - x_m)^T / sum w, the value at x is

    f(x) = sum_p phi_p f_p ,   phi_p = w_p / sum w (1 + (x - x_m) . C^-1 (x_p - x_m)) .

Constant and linear fields come out exactly, others with second order.  All fields share the
weights.  Only where the neighbours lie nearly on a line, in space on a plane, is C given a ridge,
which keeps constants exact.  Points that the pile hides from the target do not contribute.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from handoff.line_of_sight import NO_OBSTACLE, Obstacle, hides
from install_mpm._jit import jit, parallel_jit, prange

CANDIDATES = 2
"""Nearest points looked at per neighbour wanted: enough are left where the pile hides some."""
FEWEST = 6
"""With fewer visible neighbours than this the value is that of the nearest."""
FLAT = 1e-3
"""Ratio of the second moments below which neighbours count as lying on a line or a plane."""


class TransferWeights(NamedTuple):
    """How each target is made of material points."""

    neighbours: np.ndarray
    """Material points (target, k) of each target, int64."""
    weights: np.ndarray
    """Their weights phi (target, k); zero where fewer than k are used."""
    nearest: np.ndarray
    """Nearest visible material point (target,) int64."""
    distance: np.ndarray
    """Distance (target,) in m to it; infinite if the pile hides all candidates."""


def least_squares_weights(
    positions: np.ndarray,
    volumes: np.ndarray,
    targets: np.ndarray,
    neighbours: int,
    obstacle: Obstacle | np.ndarray = NO_OBSTACLE,
) -> TransferWeights:
    """Return the weights that carry fields from points (p, dim) to ``targets`` (n, dim).

    ``volumes`` (p,) in m^3 are those of the points; ``obstacle`` is one of ``line_of_sight``.

    Raises
    ------
    ValueError
        If there are fewer points than ``neighbours``.
    """
    if len(positions) < neighbours:
        raise ValueError(
            f"{len(positions)} material points are fewer than handoff.neighbours = {neighbours};"
            " use more points or fewer neighbours"
        )
    n_candidates = min(CANDIDATES * neighbours, len(positions))
    candidates = _nearest_points(positions, targets, n_candidates)
    result = TransferWeights(
        np.zeros((len(targets), neighbours), dtype=np.int64),
        np.zeros((len(targets), neighbours)),
        np.zeros(len(targets), dtype=np.int64),
        np.zeros(len(targets)),
    )
    _fit_all(
        np.ascontiguousarray(positions),
        np.ascontiguousarray(volumes),
        np.ascontiguousarray(targets),
        candidates,
        np.array(obstacle),
        *result,
    )
    return result


def transferred(weights: TransferWeights, values: np.ndarray) -> np.ndarray:
    """Return ``values`` (point, ...) at the targets, (target, ...)."""
    columns = values.reshape(len(values), -1)
    sums = np.einsum("tk,tkc->tc", weights.weights, columns[weights.neighbours])
    return sums.reshape(len(sums), *values.shape[1:])


def transfer_least_squares(
    positions: np.ndarray,
    volumes: np.ndarray,
    values: np.ndarray,
    targets: np.ndarray,
    neighbours: int,
    obstacle: Obstacle | np.ndarray = NO_OBSTACLE,
) -> np.ndarray:
    """Return ``values`` (point, ...) at ``targets`` (n, dim) by linear moving least squares."""
    return transferred(
        least_squares_weights(positions, volumes, targets, neighbours, obstacle), values
    )


def transfer_nearest(
    positions: np.ndarray,
    values: np.ndarray,
    targets: np.ndarray,
    obstacle: Obstacle | np.ndarray = NO_OBSTACLE,
) -> np.ndarray:
    """Return ``values`` (point, ...) of the nearest visible point at ``targets`` (n, dim)."""
    count = min(2 * FEWEST, len(positions))
    weights = least_squares_weights(positions, np.ones(len(positions)), targets, count, obstacle)
    nearest: np.ndarray = values[weights.nearest]
    return nearest


def _nearest_points(positions: np.ndarray, targets: np.ndarray, count: int) -> np.ndarray:
    """Return the ``count`` nearest points (target, count) int64, nearest first."""
    _, indices = cKDTree(positions).query(targets, k=count)
    return np.ascontiguousarray(np.asarray(indices).reshape(len(targets), count), dtype=np.int64)


@parallel_jit
def _fit_all(
    positions: np.ndarray,
    volumes: np.ndarray,
    targets: np.ndarray,
    candidates: np.ndarray,
    obstacle: np.ndarray,
    neighbours: np.ndarray,
    weights: np.ndarray,
    nearest: np.ndarray,
    distance: np.ndarray,
) -> None:
    """Fill the fields of ``TransferWeights`` (last four arguments) for all targets."""
    for t in prange(targets.shape[0]):
        target = targets[t]
        count = _visible_neighbours(positions, target, candidates[t], obstacle, neighbours[t])
        if count == 0:
            nearest[t] = candidates[t, 0]
            distance[t] = np.inf
            weights[t, 0] = 1.0
            neighbours[t, 0] = nearest[t]
            continue
        nearest[t] = neighbours[t, 0]
        distance[t] = np.sqrt(((positions[nearest[t]] - target) ** 2).sum())
        if count < FEWEST:
            weights[t, 0] = 1.0
        else:
            _fit(positions, volumes, target, neighbours[t, :count], weights[t, :count])


@jit
def _visible_neighbours(
    positions: np.ndarray,
    target: np.ndarray,
    candidates: np.ndarray,
    obstacle: np.ndarray,
    neighbours: np.ndarray,
) -> int:
    """Fill ``neighbours`` with the first candidates in sight; return their number."""
    count = 0
    for p in candidates:
        if count < neighbours.shape[0] and not hides(obstacle, target, positions[p]):
            neighbours[count] = p
            count += 1
    return count


@jit
def _fit(
    positions: np.ndarray,
    volumes: np.ndarray,
    target: np.ndarray,
    neighbours: np.ndarray,
    weights: np.ndarray,
) -> None:
    """Fill ``weights`` with the phi of the module's docstring; distances are taken over R."""
    count, dim = neighbours.shape[0], target.shape[0]
    offset = np.empty((count, dim))
    for a in range(count):
        offset[a] = positions[neighbours[a]] - target
    radius = 1.05 * np.sqrt((offset[count - 1] ** 2).sum())
    total, mean = 0.0, np.zeros(dim)
    for a in range(count):
        offset[a] /= radius
        weights[a] = volumes[neighbours[a]] * (1.0 - (offset[a] ** 2).sum()) ** 2
        total += weights[a]
        mean += weights[a] * offset[a]
    mean /= total

    moments = np.zeros((dim, dim))
    for a in range(count):
        offset[a] -= mean
        for i in range(dim):
            for j in range(dim):
                moments[i, j] += weights[a] / total * offset[a, i] * offset[a, j]
    principal = np.linalg.eigvalsh(moments)
    if principal[0] < FLAT * principal[dim - 1]:
        ridge = FLAT * np.trace(moments)
        for i in range(dim):
            moments[i, i] += ridge
    slope = np.linalg.solve(moments, -mean)
    for a in range(count):
        weights[a] *= (1.0 + (slope * offset[a]).sum()) / total
