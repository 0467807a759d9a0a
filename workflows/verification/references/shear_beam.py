"""PA2: cantilever under a transverse dead load at its tip, geometrically exact beam.

The beam stretches, shears and bends (Reissner 1972, Journal of Applied Mathematics and Physics 23,
795-804).  With the rotation theta of the section, the axial force N = P sin(theta) and the shear
force Q = P cos(theta), per metre of width,

    x' = e cos(theta) - g sin(theta),  w' = e sin(theta) + g cos(theta),
    theta' = kappa,  M' = -P x',  theta = x = w = 0 at the support, M = 0 at the tip,

where the shear strain is g = Q / (k G d) with k = 5/6, and the stretch e of the axis and the
curvature kappa follow from N and M.  The section is that of a Hencky solid in plane strain without
stress across the depth: a fibre of stretch L has the nominal stress E ln(L) / ((1 - nu^2) L), and
with m = nu / (1 - nu) the thickness around it changes by L^-m.  The fibre at the original distance
Y from the axis, now at y, has L = e + kappa y, hence L^(1 + m) = e^(1 + m) + (1 + m) kappa Y.

Neglected are the stress across the depth, of order (kappa d)^2, and the warping of sections.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from workflows.verification.references.elastica import elastica_tip

SHEAR_COEFFICIENT = 5.0 / 6.0
ABSCISSAE, WEIGHTS = np.polynomial.legendre.leggauss(10)
"""Over the depth, in [-1, 1]."""
INTERVALS = 40
"""Of the classical Runge-Kutta method over the length; twice as many change 2e-7 of the tip."""
SHOTS = 30
CONVERGED = 1e-10
"""Rotation of the support in rad."""
NEWTON_ITERATIONS = 30


class Section(NamedTuple):
    """Rectangular section of a Hencky solid in plane strain, 1 m wide."""

    depth: float
    """In m."""
    youngs_modulus: float
    """In Pa."""
    poissons_ratio: float

    @property
    def modulus(self) -> float:
        """E / (1 - nu^2) in Pa."""
        return self.youngs_modulus / (1.0 - self.poissons_ratio**2)

    @property
    def shear_stiffness(self) -> float:
        """Shear force over shear strain, k G d in N per metre."""
        shear_modulus = self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))
        return SHEAR_COEFFICIENT * shear_modulus * self.depth


def cantilever_tips(section: Section, length: float, loads: np.ndarray) -> np.ndarray:
    """Return shortening and deflection of the tip, (n_loads, 2) in m, under ``loads`` > 0.

    The beam is integrated from the tip, where the moment is known, and the complement delta of the
    rotation of the tip to a right angle is sought with which the support does not rotate: by the
    secant method in ln(delta), which falls linearly with the root of the load, from the elastica.

    Parameters
    ----------
    section
        Of the beam.
    length
        In m.
    loads
        In N per metre of width, (n_loads,).

    Raises
    ------
    ValueError
        If the section cannot carry one of the loads.
    """
    elastica = [
        elastica_tip(load * length**2 / (section.modulus * section.depth**3 / 12.0)).angle
        for load in loads
    ]
    with np.errstate(divide="ignore", invalid="ignore"):  # a section that fails gives NaN
        return _tips(section, length, loads, np.log(0.5 * np.pi - np.array(elastica)))


def _tips(section: Section, length: float, loads: np.ndarray, trial: np.ndarray) -> np.ndarray:
    """Return ``cantilever_tips`` by the secant method from ``trial`` (n_loads,), ln(delta)."""
    rotation, *tip = _shoot(section, length, loads, trial)
    change = np.full(len(loads), -0.01)
    for _ in range(SHOTS):
        before, trial = rotation, trial + change
        rotation, *tip = _shoot(section, length, loads, trial)
        if np.abs(rotation).max() < CONVERGED:
            return np.stack([length - tip[0], tip[1]], axis=1)
        is_moving = rotation != before
        change *= np.where(is_moving, rotation / np.where(is_moving, before - rotation, 1.0), 0.0)
    raise ValueError("the section of the cantilever cannot carry the load")


def _shoot(
    section: Section, length: float, loads: np.ndarray, log_complement: np.ndarray
) -> np.ndarray:
    """Return rotation of the support and place of the tip beside it, (3, n_loads)."""
    complement = np.exp(log_complement)
    state = np.stack([0.0 * complement, 0.0 * loads, 0.0 * loads, 0.0 * loads])
    step = length / INTERVALS
    for _ in range(INTERVALS):
        first = _derivative(section, loads, complement, state)
        second = _derivative(section, loads, complement, state + 0.5 * step * first)
        third = _derivative(section, loads, complement, state + 0.5 * step * second)
        fourth = _derivative(section, loads, complement, state + step * third)
        state = state + step / 6.0 * (first + 2.0 * (second + third) + fourth)
    return np.stack([0.5 * np.pi - complement - state[0], *state[2:]])


def _derivative(
    section: Section, load: np.ndarray, complement: np.ndarray, state: np.ndarray
) -> np.ndarray:
    """Return the derivative, by the distance from the tip, of the ``state`` (4, n_loads).

    The state is the rotation lost since the tip, the moment, and the way to the tip along x and w.
    """
    lost, moment = state[:2]
    cosine, sine = np.sin(complement + lost), np.cos(complement + lost)
    stretch, curvature = strains(section, load * sine, moment)
    shear = load * cosine / section.shear_stiffness
    forward = stretch * cosine - shear * sine
    downward = stretch * sine + shear * cosine
    return np.stack([curvature, load * forward, forward, downward])


def strains(
    section: Section, axial_force: np.ndarray, moment: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return stretch of the axis and curvature in 1/m under forces (n,) in N and N m per metre.

    NaN where the section cannot carry them.
    """
    stiffness = section.modulus * section.depth
    stretch = 1.0 + axial_force / stiffness
    bending = 12.0 * moment / (stiffness * section.depth)
    correction = np.full((2, *moment.shape), np.inf)
    for _ in range(NEWTON_ITERATIONS):
        if not np.nanmax(np.abs(correction), initial=0.0) > 1e-12:
            break
        bending = np.where(np.abs(bending) < 1e-13, 1e-13, bending)  # (L - e) / kappa is finite
        axial, turning = _forces(section, stretch, bending).real
        (aa, ta), (ab, tb) = (
            _forces(section, stretch + 1e-30j * one, bending + 1e-30j * other).imag / 1e-30
            for one, other in ((1.0, 0.0), (0.0, 1.0))
        )
        missing, missing_turning = axial_force - axial, moment / section.depth - turning
        correction = np.stack([tb * missing - ab * missing_turning,
                               aa * missing_turning - ta * missing])  # fmt: skip
        correction = np.clip(correction / (aa * tb - ab * ta), -0.25, 0.25)
        stretch, bending = stretch + correction[0], bending + correction[1]
    is_found = np.abs(correction).max(axis=0) <= 1e-12
    stretch, bending = (np.where(is_found, value, np.nan) for value in (stretch, bending))
    return stretch, bending / section.depth


def _forces(section: Section, stretch: np.ndarray, bending: np.ndarray) -> np.ndarray:
    """Return axial force and moment over depth, (2, n) in N per metre.

    ``bending`` is the curvature times the depth.  Arguments (n,) may be complex.
    """
    power = 1.0 + section.poissons_ratio / (1.0 - section.poissons_ratio)
    axis = stretch[:, None]
    slope = power * bending[:, None] * axis**-power
    log_ratio = np.log1p(0.5 * ABSCISSAE * slope) / power
    stress = section.modulus * (np.log(axis) + log_ratio) / (axis * np.exp(log_ratio))
    level = power / slope * np.expm1(log_ratio) * axis ** (1.0 - power)
    per_depth = 0.5 * WEIGHTS * section.depth
    return np.stack([stress @ per_depth, (stress * level) @ per_depth])
