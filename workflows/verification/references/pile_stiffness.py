"""PD3: vertical stiffness of the head of an elastic pile, by finite elements of another kind.

Nine-node rectangles on a graded grid, integrated with nine points, against the six-node triangles
of the service stage.  The ground is a cylinder, fixed at its side and bottom; the pile sticks to
it, and its head moves as a rigid section.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

FIRST, GROWTH = 0.25, 1.25
"""Side of the cells at the surface of the pile over its radius, and its growth per cell."""


def randolph_wroth(
    *, length: float, radius: float, pile_modulus: float, shear_modulus: float,
    poissons_ratio: float,
) -> float:  # fmt: skip
    """Return the stiffness in N/m of the head of a compressible pile in uniform ground.

    Source: Randolph & Wroth (1978), J. Geotech. Eng. Div. ASCE 104(GT12), 1465-1488.

    Parameters
    ----------
    length, radius
        In m.
    pile_modulus, shear_modulus
        Young's modulus of the pile and shear modulus of the ground in Pa.
    """
    nu, slenderness = poissons_ratio, length / radius
    stiffness_ratio = pile_modulus / shear_modulus
    zeta = np.log(2.5 * slenderness * (1.0 - nu))
    mu = np.sqrt(2.0 / (zeta * stiffness_ratio)) * slenderness
    decay = np.tanh(mu) / mu * slenderness
    base = 4.0 / (1.0 - nu)
    shaft = 2.0 * np.pi / zeta * decay
    reduction = 1.0 + base * decay / (np.pi * stiffness_ratio)
    return float(shear_modulus * radius * (base + shaft) / reduction)


def head_stiffness(
    *, length: float, radius: float, pile_modulus: float, shear_modulus: float,
    poissons_ratio: float, extent: float, depth: float, first: float = FIRST,
) -> float:  # fmt: skip
    """Return the stiffness in N/m in a cylinder of radius ``extent`` and ``depth`` in m.

    ``first`` is the side of the cells at the surface of the pile over its radius; Poisson's ratio
    is that of pile and ground.
    """
    away = _graded(first * radius, extent - radius)
    r = np.concatenate([radius * (1.0 - _graded(first, 1.0)[::-1]), radius + away[1:]])
    half = _graded(first * radius, 0.5 * length)
    shaft = np.concatenate([half, length - half[-2::-1]])
    z = np.concatenate([shaft, length + _graded(first * radius, depth - length)[1:]])
    r, z = _with_middles(r), _with_middles(z)
    is_pile = np.outer(r[1::2] < radius, z[1::2] < length)
    modulus = np.where(is_pile, pile_modulus, 2.0 * (1.0 + poissons_ratio) * shear_modulus)
    stiffness = _assembled(r, z, modulus, poissons_ratio)
    index = np.arange(len(r) * len(z)).reshape(len(r), len(z))
    slack = 1e-9 * radius
    head = index[r < radius + slack, 0]
    motion = np.zeros(2 * index.size)
    is_given = np.zeros(2 * index.size, dtype=bool)
    is_given[2 * index[0]] = True
    for held in (index[-1], index[:, -1]):
        is_given[2 * held] = is_given[2 * held + 1] = True
    motion[2 * head + 1], is_given[2 * head + 1] = 1.0, True
    free = np.flatnonzero(~is_given)
    rows = stiffness[free]
    motion[free] = spsolve(rows[:, free].tocsc(), -(rows @ motion))
    return float((stiffness[2 * head + 1] @ motion).sum())


def _graded(first: float, length: float) -> np.ndarray:
    """Return places from 0 to ``length``; the first cell is about ``first`` long, others grow."""
    count = max(2, round(np.log1p(length / first * (GROWTH - 1.0)) / np.log(GROWTH)))
    places = (GROWTH ** np.arange(count + 1) - 1.0) / (GROWTH**count - 1.0)
    return np.asarray(length * places)


def _with_middles(lines: np.ndarray) -> np.ndarray:
    both = np.empty(2 * len(lines) - 1)
    both[::2], both[1::2] = lines, 0.5 * (lines[1:] + lines[:-1])
    return both


def _assembled(r: np.ndarray, z: np.ndarray, modulus: np.ndarray, nu: float) -> coo_matrix:
    """Return the stiffness, 2 * node + axis, of the nine-node cells of a grid (r outward, z down).

    ``modulus`` (cell, cell) is Young's in Pa.
    """
    index = np.arange(len(r) * len(z)).reshape(len(r), len(z))
    points, weights = np.polynomial.legendre.leggauss(3)
    shape = np.stack([points * (points - 1.0) / 2.0, 1.0 - points**2, points * (points + 1.0) / 2])
    slope = np.stack([points - 0.5, -2.0 * points, points + 0.5])
    elastic = np.full((4, 4), nu)
    elastic[3] = elastic[:, 3] = 0.0
    np.fill_diagonal(elastic, [1.0 - nu] * 3 + [0.5 - nu])
    elastic /= (1.0 + nu) * (1.0 - 2.0 * nu)
    half_r, half_z = 0.5 * (r[2::2] - r[:-2:2]), 0.5 * (z[2::2] - z[:-2:2])
    sizes = (len(half_r), len(half_z))
    blocks = np.zeros((*sizes, 18, 18))
    for i, j in np.ndindex(3, 3):
        radius = r[1::2] + points[i] * half_r
        d_r = np.outer(slope[:, i], shape[:, j]).ravel()[None, :] / half_r[:, None]
        d_z = np.outer(shape[:, i], slope[:, j]).ravel()[None, :] / half_z[:, None]
        value = np.outer(shape[:, i], shape[:, j]).ravel()[None, :] / radius[:, None]
        strain = np.zeros((*sizes, 4, 9, 2))
        strain[:, :, 0, :, 0] = strain[:, :, 3, :, 1] = d_r[:, None]
        strain[:, :, 1, :, 1] = strain[:, :, 3, :, 0] = d_z[None]
        strain[:, :, 2, :, 0] = value[:, None]
        b = strain.reshape(*sizes, 4, 18)
        ring = 2.0 * np.pi * weights[i] * weights[j] * np.outer(radius * half_r, half_z) * modulus
        blocks += ring[:, :, None, None] * np.einsum("rzka,kl,rzlb->rzab", b, elastic, b,
                                                     optimize=True)  # fmt: skip
    nodes = np.stack(
        [index[a : len(r) - 2 + a : 2, b : len(z) - 2 + b : 2] for a in range(3) for b in range(3)],
        axis=-1,
    )
    dofs = (2 * nodes[..., None] + np.arange(2)).reshape(-1, 18)
    rows, columns = np.repeat(dofs, 18, axis=1), np.tile(dofs, (1, 18))
    size = 2 * index.size
    triplets = (blocks.ravel(), (rows.ravel(), columns.ravel()))
    return coo_matrix(triplets, shape=(size, size)).tocsr()
