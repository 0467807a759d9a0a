"""One homogeneous element of soil, driven through stresses and strains: what a laboratory test is.

Each component of the deformation gradient F is driven, or left free while the stress component of
the same place is driven.  In undrained loading the volume stays, the driven stresses are total
ones, and the pore pressure is the reaction of the constraint: total stress = effective - u 1.
Every step is solved by Newton's method with the consistent tangent of the law, in small strain
(strain = sym(F - 1)) or finite strain (through ``hencky``); a step that fails is halved.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from install_mpm._jit import jit
from install_mpm.constitutive import dispatch, hencky
from install_mpm.constitutive.mandel import COLUMN, ROW, SCALE, from_mandel
from install_mpm.constitutive.parameters import SoilParameters

MAX_ITERATIONS = 25
MOST_HALVINGS = 12
"""A step that does not converge is cut into at most two to this power."""
TOLERANCE = 1e-10
"""Relative to the largest stress, or to what a strain of 1e-6 makes of the stiffness."""
SMALLEST_STRAIN = 1e-6
RANK = 1e-9
"""Singular values of the equations below this share of the largest count as zero."""


class ElementTestError(RuntimeError):
    """The element cannot be brought to where it is driven; the message says why."""


class Element(NamedTuple):
    """State of the element."""

    gradient: np.ndarray
    """Deformation gradient F (3, 3) since the start; symmetric sums count in small strain."""
    stress: np.ndarray
    """Cauchy stress (3, 3) in Pa, effective in undrained loading."""
    pore_pressure: float
    """Excess over the start, in Pa."""
    elastic_strain: np.ndarray
    """Elastic strain (3, 3), logarithmic in finite strain."""
    state_variables: np.ndarray
    """State variables of the law (n_state,)."""
    residuals: tuple[float, ...] = ()
    """Relative residuals of the Newton iterations that led here."""


class Loading(NamedTuple):
    """A part of a test: where it leads, in equal steps."""

    is_stress: np.ndarray
    """Components (3, 3) bool, symmetric, whose stress is driven.  A shear stress drives F_ij with i
    < j; F_ji stays at its target."""
    gradient: np.ndarray
    """Target (3, 3) of F - 1; entries with driven stress are not read."""
    stress: np.ndarray
    """Target (3, 3) in Pa, total stress in undrained loading; other entries are not read."""
    steps: int
    is_undrained: bool = False


def element(soil: SoilParameters, stress: np.ndarray, *, depth: float = 0.0) -> Element:
    """Return an undeformed element of ``soil`` under the initial ``stress`` (3, 3) in Pa."""
    state = dispatch.initial_state(soil, np.array([depth]), stress[None])
    material = np.zeros(1, dtype=np.int64)
    vector, strain = np.ascontiguousarray(stress[None, ROW, COLUMN] * SCALE), np.empty((1, 6))
    dispatch.elastic_strain_from_stress_all(dispatch.pack([soil]), material, vector, state, strain)
    tensor = np.empty((3, 3))
    tensor[ROW, COLUMN] = tensor[COLUMN, ROW] = strain[0] / SCALE
    return Element(np.eye(3), np.array(stress, dtype=float), 0.0, tensor, state[0])


def drive(
    soil: SoilParameters,
    start: Element,
    loadings: Iterable[Loading],
    *,
    is_finite_strain: bool = False,
) -> list[Element]:
    """Return the states after every step of all ``loadings``, ``start`` first.

    Raises
    ------
    ElementTestError
        If a step cannot be solved in parts either: stresses are driven beyond the strength.
    """
    test = _Test(dispatch.pack([soil]), is_finite_strain)
    path = [start]
    for loading in loadings:
        _check(loading)
        origin = path[-1]
        for number in range(loading.steps):
            shares = number / loading.steps, (number + 1) / loading.steps
            path.append(_advance(test, path[-1], origin, loading, shares))
    return path


def _check(loading: Loading) -> None:
    if (loading.is_stress != loading.is_stress.T).any():
        raise ValueError("is_stress has to be symmetric")
    if loading.is_undrained and not loading.is_stress.diagonal().any():
        raise ValueError("undrained loading needs a driven normal stress to find the pore pressure")


class _Test(NamedTuple):
    """What does not change during a test."""

    materials: dispatch.Materials
    is_finite_strain: bool


class _Targets(NamedTuple):
    """What a step has to reach; entries of what is not driven are not read."""

    is_free: np.ndarray
    """Components (3, 3) bool of F that follow from a driven stress."""
    gradient: np.ndarray
    total_stress: np.ndarray
    volume: float | None
    """Determinant of F in undrained loading (in small strain 1 + the trace of F - 1)."""


def _advance(
    test: _Test, now: Element, origin: Element, loading: Loading, shares: tuple[float, float],
    halvings: int = 0,
) -> Element:  # fmt: skip
    """Return the element at the second of two ``shares`` of the loading from ``origin``."""
    total = _total_stress(origin)
    targets = _Targets(
        np.triu(loading.is_stress),
        origin.gradient + shares[1] * (np.eye(3) + loading.gradient - origin.gradient),
        total + shares[1] * (loading.stress - total),
        _volume(test, origin.gradient)[0] if loading.is_undrained else None,
    )
    moved = _solve(test, now, targets)
    if moved is not None:
        return moved
    if halvings == MOST_HALVINGS:
        raise ElementTestError(
            f"no equilibrium at {shares[1]:.4f} of a loading; a driven stress is beyond the"
            " strength, so drive a strain instead"
        )
    middle = 0.5 * (shares[0] + shares[1])
    for part in ((shares[0], middle), (middle, shares[1])):
        now = _advance(test, now, origin, loading, part, halvings + 1)
    return now


def _solve(test: _Test, now: Element, targets: _Targets) -> Element | None:
    """Return the element at the targets, None if Newton's method does not get there."""
    trial = now._replace(
        gradient=np.where(targets.is_free, now.gradient, targets.gradient), residuals=()
    )
    for _ in range(MAX_ITERATIONS + 1):
        answer = _respond(test, now, trial)
        if answer is None:
            return None
        trial, tangent = answer
        lack = np.where(targets.is_free, targets.total_stress - _total_stress(trial), 0.0)
        volume, volume_slope = _volume(test, trial.gradient)
        growth = 0.0 if targets.volume is None else volume / targets.volume - 1.0
        residual = max(np.abs(lack).max() / _scale(trial, targets, tangent), abs(growth))
        trial = trial._replace(residuals=(*trial.residuals, float(residual)))
        if residual <= TOLERANCE:
            return trial
        if not np.isfinite(residual):
            return None
        change, pressure = _correction(targets, lack, growth, tangent, volume_slope)
        trial = trial._replace(
            gradient=trial.gradient + change, pore_pressure=trial.pore_pressure + pressure
        )
    return None


def _total_stress(element: Element) -> np.ndarray:
    return element.stress - element.pore_pressure * np.eye(3)


def _scale(trial: Element, targets: _Targets, tangent: np.ndarray) -> float:
    stresses = np.where(targets.is_free, targets.total_stress, trial.stress)
    return float(max(np.abs(stresses).max(), SMALLEST_STRAIN * np.abs(tangent).max()))


def _volume(test: _Test, gradient: np.ndarray) -> tuple[float, np.ndarray]:
    """Return the volume over that of F = 1, and its derivative (3, 3) by F."""
    if not test.is_finite_strain:
        return float(np.trace(gradient)) - 2.0, np.eye(3)
    volume = float(np.linalg.det(gradient))
    return volume, volume * np.linalg.inv(gradient).T


def _correction(
    targets: _Targets, lack: np.ndarray, growth: float, tangent: np.ndarray,
    volume_slope: np.ndarray,
) -> tuple[np.ndarray, float]:  # fmt: skip
    """Return the changes of F (3, 3) and of the pore pressure.

    Of least size where perfect plasticity leaves them open, as between two equal stresses.
    """
    free = np.flatnonzero(targets.is_free)
    matrix = tangent.reshape(9, 9)[np.ix_(free, free)]
    right = lack.ravel()[free]
    if targets.volume is not None:
        stiffness = max(np.abs(matrix).max(), 1.0)
        column = -np.eye(3).ravel()[free, None] * stiffness
        row = volume_slope.ravel()[None, free] * stiffness
        matrix = np.block([[matrix, column], [row, np.zeros((1, 1))]])
        right = np.append(right, -growth * targets.volume * stiffness)
    solution = np.linalg.lstsq(matrix, right, rcond=RANK)[0]
    change = np.zeros(9)
    change[free] = solution[: len(free)]
    pressure = 0.0 if targets.volume is None else float(solution[-1] * stiffness)
    return change.reshape(3, 3), pressure


def _respond(test: _Test, now: Element, trial: Element) -> tuple[Element, np.ndarray] | None:
    """Return ``trial`` with stress and state, and d(stress)/dF (3, 3, 3, 3); None if it fails."""
    stress, strain = np.empty(6), np.empty(6)
    state, spatial = np.empty_like(now.state_variables), np.zeros((3, 3, 3, 3))
    if test.is_finite_strain:
        inverse = np.linalg.inv(trial.gradient)
        increment = trial.gradient @ np.linalg.inv(now.gradient)
    else:
        increment = trial.gradient - now.gradient
    status = respond(
        test.materials.model[0], test.materials.parameters[0], test.is_finite_strain, increment,
        now.elastic_strain, now.state_variables, stress, strain, state, spatial,
    )  # fmt: skip
    if status != 0:
        return None
    tensors = np.empty((2, 3, 3))
    from_mandel(stress, tensors[0])
    from_mandel(strain, tensors[1])
    if test.is_finite_strain:  # from Kirchhoff stress and velocity gradient to Cauchy and F
        volume = np.linalg.det(trial.gradient)
        tensors[0] /= volume
        spatial = np.einsum("ijam,bm->ijab", spatial / volume, inverse)
        spatial -= np.einsum("ij,ba->ijab", tensors[0], inverse)
    moved = trial._replace(stress=tensors[0], elastic_strain=tensors[1], state_variables=state)
    return moved, spatial


@jit
def respond(
    model, parameters, is_finite_strain, increment, elastic_strain, state_old, stress, strain,
    state, spatial,
):  # fmt: skip
    """Evaluate a law under an ``increment`` (3, 3) of F, or of F - 1 in small strain.

    ``stress`` (6,), elastic ``strain`` (6,), ``state`` and ``spatial`` are filled as by
    ``dispatch.update_stress`` and ``hencky.spatial_tangent``; the status is returned.
    """
    trial, stretches, axes = np.empty(6), np.empty(3), np.empty((3, 3))
    tangent = np.empty((6, 6))
    if is_finite_strain:
        hencky.trial_log_strain(increment, elastic_strain, trial, stretches, axes)
    else:
        hencky.small_trial_strain(increment, elastic_strain, trial)
    status = dispatch.update_stress(
        model, trial, parameters, state_old, stress, strain, state, tangent
    )
    if is_finite_strain:
        hencky.spatial_tangent(tangent, stretches, axes, 3, spatial)
    else:
        hencky.small_tangent(tangent, 3, spatial)
    return status
