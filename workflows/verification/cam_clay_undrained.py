"""PE4: undrained triaxial compression of one point of modified Cam clay, against its closed form.

The sample is sheared at constant volume, once by the drained law with the strain prescribed, and
once as undrained soil with a pore fluid.  The law's shear modulus follows the pressure of the last
step, so that strains converge with the number of steps; the effective stress path does not depend
on it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from install_mpm.constitutive import dispatch
from install_mpm.constitutive.mandel import COLUMN, ROW, SCALE
from install_mpm.constitutive.parameters import ModifiedCamClay
from install_mpm.conventions import Unit
from workflows.verification.problem import Check, Outcome, Problem, Series, at_most, relative
from workflows.verification.references.cam_clay import (
    CamClay,
    critical_pressure,
    undrained_shear_strength,
    undrained_triaxial,
)

SHORTENINGS = (0.005, 0.01, 0.02, 0.05)
"""Axial strains at which the deviator stress is compared."""
END = 0.3
"""Axial strain at which the clay is as good as critical."""
FLUID = 100e9
"""Bulk modulus in Pa of the pore fluid over the porosity, so large that the volume is constant."""
MOST_ITERATIONS = 30


@dataclass(frozen=True)
class UndrainedTest:
    """Effective stress after each step, (n_steps,)."""

    shortening: np.ndarray
    deviator_stress: np.ndarray
    """q in Pa."""
    mean_pressure: np.ndarray
    """Effective, p in Pa."""
    pore_pressure: np.ndarray
    """Excess pore pressure in Pa; zero without pore fluid."""
    residuals: tuple[tuple[float, ...], ...]
    """Of the Newton iterations of each step, over the pressure at the start."""


def undrained_test(
    soil: ModifiedCamClay, mean_pressure: float, shortening: float, steps: int
) -> UndrainedTest:
    """Return the response to axial ``shortening`` from isotropic stress in Pa.

    Without pore fluid the volume is held; with it, the total radial stress.
    """
    materials, material = dispatch.pack([soil]), np.zeros(1, dtype=np.int64)
    start = -mean_pressure * np.eye(3)[None]
    state = dispatch.initial_state(soil, np.zeros(1), start)
    stress = np.ascontiguousarray(start[:, ROW, COLUMN] * SCALE)
    strain, tangent = np.empty((1, 6)), np.empty((1, 6, 6))
    dispatch.elastic_strain_from_stress_all(materials, material, stress, state, strain)
    is_wet = soil.pore_fluid_bulk_modulus > 0.0
    status, records, residuals = np.zeros(1, dtype=np.int64), [], []
    radial, axial = 0.5 * shortening / steps, shortening / steps
    for _ in range(steps):
        old_strain, old_state = strain.copy(), state.copy()
        history: list[float] = []
        for _ in range(MOST_ITERATIONS):
            trial = old_strain + np.array([radial, -axial, radial, 0.0, 0.0, 0.0])
            dispatch.update_all(
                materials, material, trial, old_state, stress, strain, state, tangent, status
            )
            excess = stress[0, 0] + mean_pressure
            history.append(float(abs(excess)) / mean_pressure if is_wet else 0.0)
            if history[-1] < 1e-9:
                break
            radial -= excess / (tangent[0, 0, 0] + tangent[0, 0, 2])
        pore = float(state[0, 0]) if is_wet else 0.0
        residuals.append(tuple(history))
        records.append((stress[0, 0] - stress[0, 1], -stress[0, :3].mean() - pore, pore))
    deviator, pressure, pore_pressure = np.array(records).T
    path = shortening * np.arange(1, steps + 1) / steps
    return UndrainedTest(path, deviator, pressure, pore_pressure, tuple(residuals))


Stress = Annotated[float, Unit("Pa")]


def pe4(
    *,
    M: float = 1.2,
    lam: float = 0.2,
    kap: float = 0.04,
    e0: float = 1.0,
    nu: float = 0.3,
    p0: Stress = 100e3,
    ocr: float = 1.0,
    steps: int = 6000,
) -> Outcome:
    """Modified Cam clay with K = (1 + e0) p / kap and constant nu is sheared at constant volume.

    p0 is the isotropic pressure at the start, pc = OCR p0.  Strength s_u = (M / 2) p_cs, p_cs = p0
    (OCR / 2)^(1 - kap / lam); effective stress path p / p0 = [(M^2 + n0^2) / (M^2 + n^2)]^Lambda.
    """
    soil = ModifiedCamClay(M, lam, kap, e0, poissons_ratio=nu, overconsolidation_ratio=ocr)
    clay = CamClay(M, lam, kap, e0, nu)
    known = {"mean_pressure": p0, "overconsolidation_ratio": ocr}
    test = undrained_test(soil, p0, END, steps)
    exact = np.array([undrained_triaxial(x, clay, **known) for x in test.shortening])
    strength = undrained_shear_strength(clay, **known)
    wet = undrained_test(replace(soil, pore_fluid_bulk_modulus=FLUID), p0, END, steps)
    distance = np.abs(test.mean_pressure / p0 - _stress_path(test, clay, ocr)).max()
    difference = np.abs(wet.deviator_stress - test.deviator_stress).max() / strength
    critical = critical_pressure(clay, **known) / 1e3
    checks = (
        *_curve_checks(test, clay, known),
        relative("s_u, kPa", test.deviator_stress[-1] / 2e3, strength / 1e3, 1e-3),
        relative("p at the end, kPa", test.mean_pressure[-1] / 1e3, critical, 1e-3),
        at_most("effective stress path, largest distance over p0", float(distance), 1e-3),
        at_most("with pore fluid: q, largest difference over s_u", float(difference), 1e-3),
        relative("with pore fluid: excess pore pressure at the end, kPa",
                 wet.pore_pressure[-1] / 1e3, (p0 + 2.0 * strength / 3.0) / 1e3 - critical, 1e-3),
    )  # fmt: skip
    return Outcome(
        checks=checks,
        series=(
            Series(
                "Deviator stress",
                "axial strain",
                "q, kPa",
                tuple(test.shortening[::60]),
                tuple(test.deviator_stress[::60] / 1e3),
                tuple(exact[::60, 0] / 1e3),
            ),
        ),
        remarks=(f"{steps} equal steps to an axial strain of {END:g}.",),
        residual_histories=wet.residuals,
    )


def _stress_path(test: UndrainedTest, clay: CamClay, ocr: float) -> np.ndarray:
    """Return p / p0 at the stress ratios of the test, (n_steps,)."""
    ratio = test.deviator_stress / test.mean_pressure
    start = clay.critical_stress_ratio * np.sqrt(ocr - 1.0)
    eta = np.maximum(ratio, start)
    if ocr > 2.0:  # the dry side: the ratio falls to M after yield
        eta = np.where(np.arange(len(ratio)) > np.argmax(ratio), ratio, start)
    squared = clay.critical_stress_ratio**2
    path: np.ndarray = ((squared + start**2) / (squared + eta**2)) ** clay.plastic_share
    return path


def _curve_checks(test: UndrainedTest, clay: CamClay, known: dict[str, float]) -> list[Check]:
    """Return the checks of q at ``SHORTENINGS``."""
    return [
        relative(
            f"q at an axial strain of {strain:g}, kPa",
            float(np.interp(strain, test.shortening, test.deviator_stress)) / 1e3,
            undrained_triaxial(strain, clay, **known)[0] / 1e3,
            2e-3,
        )
        for strain in SHORTENINGS
    ]


PROBLEM = Problem(
    identifier="PE4",
    title="Modified Cam clay: undrained triaxial compression",
    run=pe4,
    is_quick=True,
)
