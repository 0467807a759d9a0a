"""Drucker-Prager beside OpenSees, a drained triaxial test step by step: extra ``opensees``.

The cone matches Mohr-Coulomb in compression, so q ends at (N - 1) p0 + 2 c sqrt(N) with
N = (1 + sin phi) / (1 - sin phi), which neither code is told.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from install_mpm.constitutive.element_driver import Loading, drive, element
from install_mpm.constitutive.parameters import DruckerPrager
from install_mpm.conventions import Unit
from workflows.verification.problem import Outcome, Problem, Series, at_most, relative
from workflows.verification.references.opensees import PACKAGE, drained_triaxial

Stress = Annotated[float, Unit("Pa")]
Angle = Annotated[float, Unit("rad")]
DEGREES_10, DEGREES_30 = (float(np.deg2rad(angle)) for angle in (10.0, 30.0))
EXACT = 1e-8
"""Demanded of q and volume in every step; OpenSees iterates to 1e-12."""


def opensees_triaxial(
    *,
    p0: Stress = 100e3,
    E: Stress = 20e6,
    nu: float = 0.3,
    c: Stress = 5e3,
    phi: Angle = DEGREES_30,
    psi: Angle = DEGREES_10,
    shortening: float = 0.03,
    steps: int = 30,
) -> Outcome:
    """A drained triaxial test on Drucker-Prager soil agrees with OpenSees in every step.

    Without dilation, with psi, and with associated flow.
    """
    checks, series = [], []
    for angle in dict.fromkeys((0.0, psi, phi)):
        soil = DruckerPrager(E, nu, c, phi, angle)
        q, volume = _drained_triaxial(soil, p0, shortening, steps)
        expected_q, expected_volume = drained_triaxial(soil, p0, shortening, steps)
        n = (1.0 + np.sin(phi)) / (1.0 - np.sin(phi))
        name = f"psi = {np.degrees(angle):.3g} deg"
        checks += [
            at_most(f"{name}: q of any step, difference over q at the end",
                    np.abs(q - expected_q).max() / expected_q[-1], EXACT),
            at_most(f"{name}: volumetric strain of any step, difference over the shortening",
                    np.abs(volume - expected_volume).max() / shortening, EXACT),
            relative(f"{name}: q at the end in Pa, Mohr-Coulomb in compression", q[-1],
                     (n - 1.0) * p0 + 2.0 * c * np.sqrt(n), EXACT),
        ]  # fmt: skip
        x = tuple(shortening * np.arange(1, steps + 1) / steps)
        series.append(Series(f"q, {name}", "shortening", "deviator stress, Pa", x, tuple(q),
                             tuple(expected_q)))  # fmt: skip
    return Outcome(tuple(checks), tuple(series))


def _drained_triaxial(
    soil: DruckerPrager, cell_pressure: float, shortening: float, steps: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return q in Pa and volumetric strain (steps,) of the law of this package."""
    start = -cell_pressure * np.eye(3)
    lateral = np.diag([True, False, True])
    loading = Loading(lateral, np.diag([0.0, -shortening, 0.0]), start, steps)
    path = drive(soil, element(soil, start), [loading])[1:]
    q = np.array([state.stress[0, 0] - state.stress[1, 1] for state in path])
    return q, np.array([np.trace(state.gradient) - 3.0 for state in path])


PROBLEM = Problem("OPENSEES-DP", "Drucker-Prager beside OpenSees", opensees_triaxial, True, PACKAGE)
