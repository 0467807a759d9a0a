"""PB2: bearing capacity of a circular footing on weightless Tresca soil, by characteristics.

In units of s_u: p is the mean stress in the (r, z) plane, compression positive, z downward, theta
the angle of the major principal stress from the r axis, and the hoop stress equals the minor
principal stress (Haar and von Karman).  Equilibrium becomes

alpha lines, direction theta + pi/4:  dp + 2 d(theta) = -(dr + dz) / r,
beta lines,  direction theta - pi/4:  dp - 2 d(theta) = -(dr - dz) / r.

Beta lines leave the free surface (theta = 0, p = 1) at distances up to ``extent`` from the edge
and run inwards through a fan at the edge.  Under the smooth footing they rise to its base, where
theta = pi/2; the last must meet the axis.  Under the rough footing they end on the last alpha line
of the fan, above which a cone of soil sticks to the footing; that line must meet the axis with
theta = pi/2.  The factors are extrapolated from two nets with error O(1/n^2).

Source: Cox, Eason & Hopkins (1961), Phil. Trans. R. Soc. A 254, 1-45 (smooth); Eason & Shield
(1960), ZAMP 11, 33-43 (rough).
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq, root


def circular_footing_pressure(
    *, undrained_shear_strength: float, is_rough: bool, n: int = 20
) -> float:
    """Return the mean pressure at collapse, 5.689 s_u or 6.048 s_u, in Pa.

    Parameters
    ----------
    undrained_shear_strength
        In Pa.
    n
        Number of beta lines and of fan lines of the coarse net; the fine one has twice as many.

    Raises
    ------
    ArithmeticError
        If the net of the rough footing is not found.
    """
    factor = _rough_factor if is_rough else _smooth_factor
    return undrained_shear_strength * (4.0 * factor(2 * n) - factor(n)) / 3.0


def _smooth_factor(n: int) -> float:
    """Return the mean pressure under the smooth footing over s_u."""
    extent = brentq(lambda x: _base(x, n)[0, -1], 0.55, 0.585, xtol=1e-12)
    r, _, p, _ = _base(extent, n)
    force = 2.0 * (p + 1.0) * r
    return -np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(r))


def _rough_factor(n: int) -> float:
    """Return the mean pressure under the rough footing over s_u: the force on the cone."""

    def mismatch(unknown: np.ndarray) -> list[float]:
        end = _cone(unknown[0], unknown[1], n)[:, -1]
        return [end[0], end[3] - 0.5 * np.pi]

    solution = root(mismatch, [0.882, np.deg2rad(116.1)], tol=1e-9)
    if not solution.success:
        raise ArithmeticError(f"no net of {n} lines meets the axis: {solution.message}")
    r, z, p, theta = _cone(solution.x[0], solution.x[1], n)
    vertical, shear = p - np.cos(2.0 * theta), np.sin(2.0 * theta)
    mean = [0.5 * (field[1:] + field[:-1]) for field in (r, vertical, shear)]
    return np.sum(2.0 * mean[0] * (mean[2] * np.diff(z) - mean[1] * np.diff(r)))


def _base(extent: float, n: int) -> np.ndarray:
    """Return (r, z, p, theta) on the base of the smooth footing from the edge, (4, n + 1)."""
    net = _start(extent, 0.5 * np.pi, n, 3 * n + 1)
    line, last = np.arange(n + 1), n + 2 * np.arange(n + 1)
    for k in range(1, 3 * n + 1):
        i = line[(line > 0) & (last > k)]
        net[:, i, k] = _crossing(net[:, i - 1, k - 1], net[:, i, k - 1])
        i = line[(line > 0) & (last == k)]
        net[:, i, k] = _rise_to_base(net[:, i, k - 1])
    return net[:, line, last]


def _cone(extent: float, fan: float, n: int) -> np.ndarray:
    """Return (r, z, p, theta) on the last alpha line of the fan from the edge, (4, n + 1)."""
    net = _start(extent, fan, n, 2 * n + 1)
    line, last = np.arange(n + 1), n + np.arange(n + 1)
    for k in range(1, 2 * n + 1):
        i = line[(line > 0) & (last >= k)]
        net[:, i, k] = _crossing(net[:, i - 1, k - 1], net[:, i, k - 1])
    return net[:, line, last]


def _start(extent: float, fan: float, n: int, n_points: int) -> np.ndarray:
    """Return the net (4, beta line, point): fan at the edge r = 1, and free surface."""
    net = np.full((4, n + 1, n_points), np.nan)
    theta = np.linspace(0.0, fan, n + 1)
    net[:, 0, : n + 1] = [np.ones(n + 1), np.zeros(n + 1), 1.0 + 2.0 * theta, theta]
    net[:, 1:, 0] = 0.0
    net[0, :, 0] = 1.0 + extent * np.arange(n + 1) / n
    net[2, :, 0] = 1.0
    return net


def _crossing(on_alpha: np.ndarray, on_beta: np.ndarray) -> np.ndarray:
    """Return the state where the alpha line from one point meets the beta line of another."""
    (ra, za, pa, ta), (rb, zb, pb, tb) = on_alpha, on_beta
    theta, r = 0.5 * (ta + tb), 0.5 * (ra + rb)
    for _ in range(100):
        alpha, beta = 0.5 * (theta + ta) + 0.25 * np.pi, 0.5 * (theta + tb) - 0.25 * np.pi
        length = ((rb - ra) * np.sin(beta) - (zb - za) * np.cos(beta)) / np.sin(beta - alpha)
        new_r, z = ra + length * np.cos(alpha), za + length * np.sin(alpha)
        from_alpha = pa + 2.0 * ta - 2.0 * (new_r - ra + z - za) / (new_r + ra)
        from_beta = pb - 2.0 * tb - 2.0 * (new_r - rb - z + zb) / (new_r + rb)
        new_theta = 0.25 * (from_alpha - from_beta)
        change = np.max(np.abs([new_theta - theta, new_r - r]), initial=0.0)
        theta, r = new_theta, new_r
        if change < 1e-13:
            break
    return np.array([r, z, 0.5 * (from_alpha + from_beta), theta])


def _rise_to_base(on_beta: np.ndarray) -> np.ndarray:
    """Return the state where a beta line meets the smooth base."""
    r, z, p, theta = on_beta
    at_base = np.full_like(r, 0.5 * np.pi)
    new_r = r - z / np.tan(0.5 * (at_base + theta) - 0.25 * np.pi)
    pressure = p + 2.0 * (at_base - theta) - 2.0 * (new_r - r + z) / (new_r + r)
    return np.array([new_r, np.zeros_like(r), pressure, at_base])
