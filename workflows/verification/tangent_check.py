"""PE8: the consistent tangent of every soil law, in small and in finite strain.

The directional derivative is compared with central differences of the stress at random states:
elastic, on planes, edges and apex.  A difference across a kink of the law is no derivative: where
it differs from the tangent the step is made smaller, until the kink lies beyond it.  An error of
the tangent itself stays at every step.  No state is left out; how many need that is reported.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.constitutive import dispatch
from install_mpm.constitutive.element_driver import element, respond
from install_mpm.constitutive.parameters import (
    DruckerPrager,
    HenckyElastic,
    HookeanSoil,
    MohrCoulomb,
    NeoHookean,
    Tresca,
    VonMises,
)
from install_mpm.conventions import Unit
from workflows.verification.problem import Check, Outcome, Problem, at_most

STEP = 3e-5
"""First step of the central difference over the size of the strain increment."""
REFINEMENTS = 3
"""Times that the step is made ten times smaller."""
LIMIT = 1e-6
"""Error of a tangent over Young's modulus that is allowed."""
DEGREES_12, DEGREES_35 = float(np.deg2rad(12.0)), float(np.deg2rad(35.0))


class Answer(NamedTuple):
    """Responses at all states."""

    stress: np.ndarray
    """(n, 6) in Pa, Mandel; Kirchhoff in finite strain."""
    tangent: np.ndarray
    """d(stress_ij) / d(l_kl), (n, 3, 3, 3, 3) in Pa."""


def respond_at(
    soil: HookeanSoil, increments: np.ndarray, pressure: float, *, is_finite_strain: bool
) -> Answer:
    """Return the responses to ``increments`` (n, 3, 3) of F from an isotropic initial pressure.

    Raises
    ------
    RuntimeError
        If the law fails.
    """
    materials = dispatch.pack([soil])
    start = element(soil, -pressure * np.eye(3))
    n = len(increments)
    answer = Answer(np.empty((n, 6)), np.zeros((n, 3, 3, 3, 3)))
    strain, state = np.empty(6), np.empty_like(start.state_variables)
    for p in range(n):
        increment = increments[p] + np.eye(3) if is_finite_strain else increments[p]
        status = respond(
            materials.model[0], materials.parameters[0], is_finite_strain, increment,
            start.elastic_strain, start.state_variables, answer.stress[p], strain, state,
            answer.tangent[p],
        )  # fmt: skip
        if status != 0:
            raise RuntimeError(f"{soil.model}: the law fails at a random strain")
    return answer


def tangent_errors(
    soil: HookeanSoil, increments: np.ndarray, pressure: float, *, is_finite_strain: bool
) -> tuple[np.ndarray, int]:
    """Return errors (n,) of the tangent over Young's modulus, and how many states have a kink near.

    Near is within the first step of the difference.
    """
    tangent = respond_at(soil, increments, pressure, is_finite_strain=is_finite_strain).tangent
    errors, rows, near = np.full(len(increments), np.inf), np.arange(len(increments)), 0
    for refinement in range(REFINEMENTS + 1):
        found = _errors_at(
            soil, increments[rows], pressure, tangent[rows], STEP * 0.1**refinement,
            is_finite_strain=is_finite_strain,
        )  # fmt: skip
        errors[rows] = np.minimum(errors[rows], found / soil.youngs_modulus)
        rows = np.flatnonzero(errors > LIMIT)
        near = len(rows) if refinement == 0 else near
    return errors, near


def _errors_at(
    soil: HookeanSoil,
    increments: np.ndarray,
    pressure: float,
    tangent: np.ndarray,
    step: float,
    *,
    is_finite_strain: bool,
) -> np.ndarray:
    """Return largest errors (n,) in Pa of ``tangent`` (n, 3, 3, 3, 3), by differences of ``step``.

    The step is one over the size of the increment.
    """
    rows, columns = [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]
    scale = np.array([1.0, 1.0, 1.0, *[np.sqrt(2.0)] * 3])
    size = step * np.linalg.norm(increments, axis=(1, 2))[:, None, None]
    # l = d(dF) dF^-1, so dF becomes (1 + step l) dF; in small strain d(grad u)
    carried = increments + np.eye(3) if is_finite_strain else np.eye(3)
    error = np.zeros(len(increments))
    for k in range(3):
        for m in range(3):
            direction = np.zeros((3, 3))
            direction[k, m] = 1.0
            forward, backward = (
                respond_at(
                    soil, increments + sign * size * (direction @ carried), pressure,
                    is_finite_strain=is_finite_strain,
                ).stress
                for sign in (1.0, -1.0)
            )  # fmt: skip
            difference = (forward - backward) / (2.0 * size[:, :, 0])
            analytic = tangent[:, rows, columns, k, m] * scale
            error = np.maximum(error, np.abs(difference - analytic).max(axis=1))
    return error


def turning_error(soil: HookeanSoil, increments: np.ndarray, pressure: float,
                  rng: np.random.Generator) -> float:  # fmt: skip
    """Return how far the response to turned strains is from the turned response, relative."""
    turn = np.linalg.qr(rng.normal(size=(len(increments), 3, 3)))[0]
    plain = respond_at(soil, increments, pressure, is_finite_strain=False).stress
    turned = np.einsum("nij,njk,nlk->nil", turn, increments, turn)
    other = respond_at(soil, turned, pressure, is_finite_strain=False).stress
    expected = np.einsum("nij,njk,nlk->nil", turn, _tensors(plain), turn)
    return float(np.abs(_tensors(other) - expected).max() / np.abs(expected).max())


def _tensors(vectors: np.ndarray) -> np.ndarray:
    rows, columns = [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]
    tensors = np.empty((len(vectors), 3, 3))
    scaled = vectors / [1.0, 1.0, 1.0, *[np.sqrt(2.0)] * 3]
    tensors[:, rows, columns] = tensors[:, columns, rows] = scaled
    return tensors


def random_increments(rng: np.random.Generator, n: int, smallest: float) -> np.ndarray:
    """Return increments (n, 3, 3) of all sizes from ``smallest`` to a hundred times of it."""
    increments = rng.normal(size=(n, 3, 3))
    increments /= np.linalg.norm(increments, axis=(1, 2))[:, None, None]
    sizes = smallest * 10.0 ** rng.uniform(0.0, 2.0, n)
    return increments * sizes[:, None, None]


def pe8(
    *,
    E: Annotated[float, Unit("Pa")] = 10e6,
    nu: float = 0.3,
    su: Annotated[float, Unit("Pa")] = 20e3,
    c: Annotated[float, Unit("Pa")] = 5e3,
    phi: Annotated[float, Unit("rad")] = DEGREES_35,
    psi: Annotated[float, Unit("rad")] = DEGREES_12,
    p0: Annotated[float, Unit("Pa")] = 20e3,
    n: int = 200,
    seed: int = 1,
) -> Outcome:
    """Tangents of all laws are compared with central differences at ``n`` random states.

    From an isotropic pressure p0, with increments of strain from 0.2 to 20 times su / E; and the
    response to turned strains with the turned response.
    """
    soils: tuple[HookeanSoil, ...] = (
        HenckyElastic(E, nu),
        NeoHookean(E, nu),
        VonMises(E, nu, su),
        Tresca(E, nu, su),
        MohrCoulomb(E, nu, c, phi, psi),
        MohrCoulomb(E, nu, c, phi, psi, 0.6, 0.8),
        DruckerPrager(E, nu, c, phi, psi),
        DruckerPrager(E, nu, c, phi, psi, "inner", 0.6, 0.8),
    )
    rng = np.random.default_rng(seed)
    increments = random_increments(rng, n, 0.2 * su / E)
    checks: list[Check] = []
    states = beside = 0
    for soil in soils:
        name = soil.model.replace("_", " ")
        if getattr(soil, "critical_void_ratio", None) is not None:
            name += ", fading dilation"
        for strain, is_finite in (("small", False), ("finite", True)):
            errors, near = tangent_errors(soil, increments, p0, is_finite_strain=is_finite)
            states, beside = states + n, beside + near
            checks.append(
                at_most(f"{name}, {strain} strain: error of the tangent", errors.max(), LIMIT)
            )
        turned = turning_error(soil, increments, p0, rng)
        checks.append(at_most(f"{name}: response to turned strains", turned, 1e-10))
    remark = f"a kink lay within the first step of the difference at {beside} of {states} states"
    return Outcome(tuple(checks), remarks=(remark,))


PROBLEM = Problem("PE8", "Consistent tangents of all soil laws", pe8, is_quick=True)
