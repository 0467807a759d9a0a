"""Transfer of fields from material points: volume-weighted linear moving least squares.

With weights w_p = V_p (1 - (d_p / R)^2)^2 of the k nearest points, their mean position x_m and
their second moment C = sum w (x_p - x_m)(x_p - x_m)^T / sum w, the value at x is

    f(x) = sum_p phi_p f_p ,   phi_p = w_p / sum w (1 + (x - x_m) . C^-1 (x_p - x_m)) .

Constant and linear fields come out exactly, others with second order.  All fields share the
weights.  Only where the neighbours lie nearly on a line is C given a ridge, which keeps constants
exact.  Points that the pile hides from the target do not contribute.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from install_mpm._jit import jit, parallel_jit, prange

CANDIDATES = 2
"""Nearest points looked at per neighbour wanted: enough are left where the pile hides some."""
FEWEST = 6
"""With fewer visible neighbours than this the value is that of the nearest."""
FLAT = 1e-3
"""Ratio of the second moments below which neighbours count as lying on a line."""
SLACK = 0.02
"""Depth, over the half-width, to which the pile's edges are taken to be transparent."""


class Obstacle(NamedTuple):
    """The pile, x < half_width and z > tip_height, which hides points from each other."""

    half_width: float
    tip_height: float


NO_OBSTACLE = Obstacle(-1e9, 1e9)


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
    obstacle: Obstacle = NO_OBSTACLE,
) -> TransferWeights:
    """Return the weights that carry fields from points (p, 2) to ``targets`` (n, 2).

    ``volumes`` (p,) in m^3 are those of the points.

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
    obstacle: Obstacle = NO_OBSTACLE,
) -> np.ndarray:
    """Return ``values`` (point, ...) at ``targets`` (n, 2) by linear moving least squares."""
    return transferred(
        least_squares_weights(positions, volumes, targets, neighbours, obstacle), values
    )


def transfer_nearest(
    positions: np.ndarray, values: np.ndarray, targets: np.ndarray, obstacle: Obstacle = NO_OBSTACLE
) -> np.ndarray:
    """Return ``values`` (point, ...) of the nearest visible point at ``targets`` (n, 2)."""
    count = min(2 * FEWEST, len(positions))
    weights = least_squares_weights(positions, np.ones(len(positions)), targets, count, obstacle)
    nearest: np.ndarray = values[weights.nearest]
    return nearest


def _nearest_points(positions: np.ndarray, targets: np.ndarray, count: int) -> np.ndarray:
    """Return the ``count`` nearest points (target, count) int64, nearest first."""
    _, indices = cKDTree(positions).query(targets, k=count)
    return np.ascontiguousarray(np.asarray(indices).reshape(len(targets), count), dtype=np.int64)


@jit
def is_hidden(start: np.ndarray, end: np.ndarray, corner: np.ndarray) -> bool:
    """Return whether the straight line between two places passes through the pile.

    ``corner`` holds half-width and tip height of the pile, x < half_width, z > tip_height; its
    edges are transparent to a depth of ``SLACK`` half-widths.  Line x(t) = start + t (end - start).
    """
    slack = SLACK * corner[0]
    enter, leave = 0.0, 1.0
    for axis in range(2):
        # inside the half-plane: distance_start + t (distance_end - distance_start) > 0
        sign = -1.0 if axis == 0 else 1.0
        distance_start = sign * (start[axis] - corner[axis]) - slack
        distance_end = sign * (end[axis] - corner[axis]) - slack
        if distance_start <= 0.0 and distance_end <= 0.0:
            return False
        if distance_start <= 0.0:
            enter = max(enter, distance_start / (distance_start - distance_end))
        elif distance_end <= 0.0:
            leave = min(leave, distance_start / (distance_start - distance_end))
    return enter < leave


@parallel_jit
def _fit_all(
    positions: np.ndarray,
    volumes: np.ndarray,
    targets: np.ndarray,
    candidates: np.ndarray,
    corner: np.ndarray,
    neighbours: np.ndarray,
    weights: np.ndarray,
    nearest: np.ndarray,
    distance: np.ndarray,
) -> None:
    """Fill the fields of ``TransferWeights`` (last four arguments) for all targets."""
    for t in prange(targets.shape[0]):
        target = targets[t]
        count = _visible_neighbours(positions, target, candidates[t], corner, neighbours[t])
        if count == 0:
            nearest[t] = candidates[t, 0]
            distance[t] = np.inf
            weights[t, 0] = 1.0
            neighbours[t, 0] = nearest[t]
            continue
        nearest[t] = neighbours[t, 0]
        distance[t] = np.hypot(
            positions[nearest[t], 0] - target[0], positions[nearest[t], 1] - target[1]
        )
        if count < FEWEST:
            weights[t, 0] = 1.0
        else:
            _fit(positions, volumes, target, neighbours[t, :count], weights[t, :count])


@jit
def _visible_neighbours(
    positions: np.ndarray,
    target: np.ndarray,
    candidates: np.ndarray,
    corner: np.ndarray,
    neighbours: np.ndarray,
) -> int:
    """Fill ``neighbours`` with the first candidates in sight; return their number."""
    count = 0
    for p in candidates:
        if count < neighbours.shape[0] and not is_hidden(target, positions[p], corner):
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
    count = neighbours.shape[0]
    last = positions[neighbours[count - 1]]
    radius = 1.05 * np.hypot(last[0] - target[0], last[1] - target[1])
    total, mean_x, mean_z = 0.0, 0.0, 0.0
    for a in range(count):
        x = (positions[neighbours[a], 0] - target[0]) / radius
        z = (positions[neighbours[a], 1] - target[1]) / radius
        weights[a] = volumes[neighbours[a]] * (1.0 - x * x - z * z) ** 2
        total += weights[a]
        mean_x += weights[a] * x
        mean_z += weights[a] * z
    mean_x /= total
    mean_z /= total

    xx, xz, zz = 0.0, 0.0, 0.0
    for a in range(count):
        x = (positions[neighbours[a], 0] - target[0]) / radius - mean_x
        z = (positions[neighbours[a], 1] - target[1]) / radius - mean_z
        xx += weights[a] / total * x * x
        xz += weights[a] / total * x * z
        zz += weights[a] / total * z * z

    half_trace = 0.5 * (xx + zz)
    spread = np.hypot(0.5 * (xx - zz), xz)
    if half_trace - spread < FLAT * (half_trace + spread):
        xx += FLAT * 2.0 * half_trace
        zz += FLAT * 2.0 * half_trace
    determinant = xx * zz - xz * xz
    slope_x = -(zz * mean_x - xz * mean_z) / determinant
    slope_z = -(xx * mean_z - xz * mean_x) / determinant
    for a in range(count):
        x = (positions[neighbours[a], 0] - target[0]) / radius - mean_x
        z = (positions[neighbours[a], 1] - target[1]) / radius - mean_z
        weights[a] *= (1.0 + slope_x * x + slope_z * z) / total
