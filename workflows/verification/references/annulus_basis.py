"""Functions of the radius for the annulus of PA8 and PA9, and the points where they are integrated.

With ln(R / a) = y^2 ln(b / a), current radius and rotation are the small-strain solution plus
y^2 (1 - y) times polynomials in y, 0 <= y <= 1.  They vanish at both rims, and they hold the
(R - a)^(3/2) that appears at the inner rim when the solution is about to be lost.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre


@dataclass(frozen=True)
class Basis:
    """Functions at the integration points, which include both rims."""

    radius: np.ndarray
    """Original radii R, (n,) in m."""
    weight: np.ndarray
    """Of the integral of 2 pi R dR, (n,) in m^2."""
    value: np.ndarray
    """Of the functions, (n, degree)."""
    slope: np.ndarray
    """Of the functions by R, (n, degree) in 1/m."""
    lift: np.ndarray
    """Small-strain rotation over the rotation of the inner rim, (n,)."""
    lift_slope: np.ndarray
    """Its derivative by R, (n,) in 1/m."""

    def fields(self, unknown: np.ndarray, angle: float) -> tuple[np.ndarray, np.ndarray]:
        """Return q = (r', r, phi'), (3, n), and phi, (n,)."""
        of_r, of_phi = np.split(unknown, 2)
        r_slope = 1.0 + self.slope @ of_r
        phi_slope = angle * self.lift_slope + self.slope @ of_phi
        q = np.array([r_slope, self.radius + self.value @ of_r, phi_slope])
        return q, angle * self.lift + self.value @ of_phi

    def by_unknown(self) -> np.ndarray:
        """Return the derivatives of q by the unknowns, (3, n, 2 degree)."""
        zero = np.zeros_like(self.value)
        rows = [(self.slope, zero), (self.value, zero), (zero, self.slope)]
        return np.array([np.hstack(row) for row in rows])


def make_basis(inner_radius: float, outer_radius: float, degree: int) -> Basis:
    """Return ``degree`` functions, and 2 ``degree`` + 4 integration points; radii in m."""
    a, b = inner_radius, outer_radius
    log_ratio = np.log(b / a)
    x, weight = _lobatto(2 * degree + 4)
    y = 0.5 * (1.0 + x)
    radius = a * np.exp(log_ratio * y**2)
    coefficients = np.diag(np.sqrt(2.0 * np.arange(degree) + 1.0))
    p = legendre.legvander(x, degree - 1) @ coefficients
    p_by_y = 2.0 * legendre.legvander(x, degree - 2) @ legendre.legder(coefficients)
    slope = ((2.0 - 3.0 * y) * p.T + y * (1.0 - y) * p_by_y.T) / (2.0 * log_ratio * radius)
    scale = a**2 * b**2 / (b**2 - a**2)
    return Basis(
        radius,
        2.0 * np.pi * radius**2 * log_ratio * y * weight,
        (y**2 * (1.0 - y) * p.T).T,
        slope.T,
        scale * (1.0 / radius**2 - 1.0 / b**2),
        -2.0 * scale / radius**3,
    )


def _lobatto(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return points, including both ends, and weights of Gauss-Lobatto quadrature on (-1, 1)."""
    last = legendre.Legendre.basis(n - 1)
    x = np.hstack([-1.0, np.sort(last.deriv().roots().real), 1.0])
    return x, 2.0 / (n * (n - 1) * last(x) ** 2)
