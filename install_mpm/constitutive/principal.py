"""Isotropic laws in principal axes: from a six-vector to sorted principal values and back.

A consistent tangent given in principal axes, d(stress_a)/d(strain_b), becomes a 6 x 6 matrix with
the help of the turning of the axes: where axes a and b turn into each other the stress changes by
(stress_a - stress_b) / (strain_a - strain_b) times the shear strain between them.
"""

from __future__ import annotations

import numpy as np

from install_mpm._jit import jit
from install_mpm.constitutive.eigen import symmetric_eigen
from install_mpm.constitutive.mandel import SQRT2, from_mandel

FIRST = np.array([0, 0, 1])
SECOND = np.array([1, 2, 2])
"""Pairs of principal axes that turn into each other."""


@jit
def principal_axes(vector, values, dyads):
    """Fill the principal ``values`` (3,), largest first, and ``dyads`` (6, 6) of a six-vector.

    Rows of ``dyads`` are orthonormal six-vectors: n_a n_a of the three axes, then sqrt(2) times the
    symmetric n_a n_b of the pairs ``FIRST``, ``SECOND``.
    """
    tensor, axes = np.empty((3, 3)), np.empty((3, 3))
    from_mandel(vector, tensor)
    symmetric_eigen(tensor, values, axes)
    for a, b in ((0, 1), (0, 2), (1, 2)):
        if values[a] < values[b]:
            values[a], values[b] = values[b], values[a]
            for i in range(3):
                axes[i, a], axes[i, b] = axes[i, b], axes[i, a]
    for a in range(3):
        x, y, z = axes[0, a], axes[1, a], axes[2, a]
        dyads[a, 0], dyads[a, 1], dyads[a, 2] = x * x, y * y, z * z
        dyads[a, 3], dyads[a, 4], dyads[a, 5] = SQRT2 * x * y, SQRT2 * x * z, SQRT2 * y * z
        b, c = FIRST[a], SECOND[a]
        for i in range(3):
            dyads[3 + a, i] = SQRT2 * axes[i, b] * axes[i, c]
        dyads[3 + a, 3] = axes[0, b] * axes[1, c] + axes[1, b] * axes[0, c]
        dyads[3 + a, 4] = axes[0, b] * axes[2, c] + axes[2, b] * axes[0, c]
        dyads[3 + a, 5] = axes[1, b] * axes[2, c] + axes[2, b] * axes[1, c]


@jit
def from_principal(values, dyads, vector):
    """Fill the six-vector with the principal ``values`` (3,)."""
    for i in range(6):
        vector[i] = values[0] * dyads[0, i] + values[1] * dyads[1, i] + values[2] * dyads[2, i]


@jit
def tangent_from_principal(strain, stress, dyads, principal_tangent, largest, tangent):
    """Fill ``tangent`` (6, 6) from the one in principal axes (3, 3).

    Parameters
    ----------
    strain, stress : (3,)
        Principal trial strains and returned stresses in Pa, in the order of ``dyads`` (6, 6).
    largest : float
        Bound in Pa on the stiffness of turning, 2 G: it only matters for round-off where two
        strains are nearly equal.  Equal strains have equal stresses in a law with edges.
    """
    rows = np.empty((6, 3))
    for i in range(6):
        for b in range(3):
            rows[i, b] = (
                dyads[0, i] * principal_tangent[0, b]
                + dyads[1, i] * principal_tangent[1, b]
                + dyads[2, i] * principal_tangent[2, b]
            )
    for i in range(6):
        for j in range(6):
            tangent[i, j] = (
                rows[i, 0] * dyads[0, j] + rows[i, 1] * dyads[1, j] + rows[i, 2] * dyads[2, j]
            )
    for pair in range(3):
        a, b = FIRST[pair], SECOND[pair]
        if stress[a] == stress[b] or strain[a] == strain[b]:
            continue
        turning = min((stress[a] - stress[b]) / (strain[a] - strain[b]), largest)
        for i in range(6):
            scaled = turning * dyads[3 + pair, i]
            for j in range(6):
                tangent[i, j] += scaled * dyads[3 + pair, j]
