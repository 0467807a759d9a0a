"""Isotropic laws in principal axes: from a six-vector to sorted principal values and back.

A consistent tangent given in principal axes, d(stress_a)/d(strain_b), becomes a 6 x 6 matrix with
the help of the turning of the axes: where axes a and b turn into each other the stress changes by
(stress_a - stress_b) / (strain_a - strain_b) times the shear strain between them.
"""

from __future__ import annotations

from install_mpm._jit import jit
from install_mpm.constitutive.eigen import eigen_pairs
from install_mpm.constitutive.mandel import SQRT2


@jit
def principal_axes(vector, values, dyads):
    """Fill the principal ``values`` (3,), largest first, and ``dyads`` (6, 6) of a six-vector.

    Rows of ``dyads`` are orthonormal six-vectors: n_a n_a of the three axes, then sqrt(2) times the
    symmetric n_a n_b of the pairs 01, 02 and 12.
    """
    xx, yy, zz, x, y, z = eigen_pairs(
        vector[0], vector[1], vector[2],
        vector[3] / SQRT2, vector[4] / SQRT2, vector[5] / SQRT2,
    )  # fmt: skip
    if xx < yy:
        xx, yy, x, y = yy, xx, y, x
    if xx < zz:
        xx, zz, x, z = zz, xx, z, x
    if yy < zz:
        yy, zz, y, z = zz, yy, z, y
    values[0], values[1], values[2] = xx, yy, zz
    _fill_dyad(x, x, 1.0, dyads[0])
    _fill_dyad(y, y, 1.0, dyads[1])
    _fill_dyad(z, z, 1.0, dyads[2])
    _fill_dyad(x, y, SQRT2, dyads[3])
    _fill_dyad(x, z, SQRT2, dyads[4])
    _fill_dyad(y, z, SQRT2, dyads[5])


@jit
def _fill_dyad(x, y, factor, dyad):
    """Fill the six-vector ``dyad`` with ``factor`` times the symmetric product of x and y (3,)."""
    half = 0.5 * SQRT2 * factor
    dyad[0], dyad[1], dyad[2] = factor * x[0] * y[0], factor * x[1] * y[1], factor * x[2] * y[2]
    dyad[3] = half * (x[0] * y[1] + x[1] * y[0])
    dyad[4] = half * (x[0] * y[2] + x[2] * y[0])
    dyad[5] = half * (x[1] * y[2] + x[2] * y[1])


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
    turning = (
        _turning(strain, stress, 0, 1, largest),
        _turning(strain, stress, 0, 2, largest),
        _turning(strain, stress, 1, 2, largest),
    )
    for i in range(6):
        row = dyads[:, i]
        first = _times_column(row, principal_tangent, 0)
        second = _times_column(row, principal_tangent, 1)
        third = _times_column(row, principal_tangent, 2)
        for j in range(6):
            tangent[i, j] = (
                first * dyads[0, j]
                + second * dyads[1, j]
                + third * dyads[2, j]
                + turning[0] * row[3] * dyads[3, j]
                + turning[1] * row[4] * dyads[4, j]
                + turning[2] * row[5] * dyads[5, j]
            )


@jit
def _times_column(row, matrix, b):
    """Return the product of the first three of ``row`` with column b of ``matrix`` (3, 3)."""
    return row[0] * matrix[0, b] + row[1] * matrix[1, b] + row[2] * matrix[2, b]


@jit
def _turning(strain, stress, a, b, largest):
    """Return the stiffness in Pa against the turning of the principal axes a and b."""
    if stress[a] == stress[b] or strain[a] == strain[b]:
        return 0.0
    return min((stress[a] - stress[b]) / (strain[a] - strain[b]), largest)
