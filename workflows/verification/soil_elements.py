"""PE1, PE2, PE3, PE6 and PE7: homogeneous tests of one element of soil, beside closed forms.

They go through ``install_mpm.constitutive.element_driver``: Mohr-Coulomb in small strain, and the
simple shear of a Hencky solid in finite strain.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import numpy as np

from install_mpm.constitutive.element_driver import Element, Loading, drive, element
from install_mpm.constitutive.parameters import HenckyElastic, MohrCoulomb
from install_mpm.conventions import Unit
from workflows.verification.problem import Outcome, Problem, Series, absolute, relative
from workflows.verification.references.element_tests import (
    drained_triaxial,
    hencky_simple_shear,
    hencky_simple_shear_peak,
    oedometer,
    simple_shear_ratio,
    undrained_strength,
)

Stress = Annotated[float, Unit("Pa")]
Angle = Annotated[float, Unit("rad")]
DEGREES_5, DEGREES_30, DEGREES_35 = (float(np.deg2rad(angle)) for angle in (5.0, 30.0, 35.0))

AXIAL, RADIAL = 1, 0
LATERAL = np.diag([True, False, True])
NOTHING = np.zeros((3, 3), dtype=bool)
EXACT = 1e-8
"""Tolerance where the law reaches the closed form at a finite strain."""


def _isotropic(pressure: float) -> np.ndarray:
    return -pressure * np.eye(3)


def _shortened(shortening: float) -> np.ndarray:
    return np.diag([0.0, -shortening, 0.0])


def _sheared(shear: float) -> np.ndarray:
    gradient = np.zeros((3, 3))
    gradient[0, 1] = shear
    return gradient


def _compression(path: Sequence[Element], axis: int) -> np.ndarray:
    """Return a normal stress, compression positive, after every step."""
    return np.array([-state.stress[axis, axis] for state in path[1:]])


def _histories(path: Sequence[Element]) -> tuple[tuple[float, ...], ...]:
    return tuple(state.residuals for state in path[1:])


def pe1(
    *,
    E: Stress = 10e6,
    nu: float = 0.0,
    phi: Angle = DEGREES_30,
    psi: Angle = DEGREES_30,
    strain: float = 0.01,
) -> Outcome:
    """Cohesionless soil is compressed from zero stress without sideways strain.

    With nu / (1 - nu) below K_a it yields at once: K = K_a, and the modulus follows from the flow
    rule; without dilation and with psi.
    """
    checks, series = [], []
    for angle in dict.fromkeys((0.0, psi)):
        soil = MohrCoulomb(E, nu, 0.0, phi, angle)
        loading = Loading(NOTHING, _shortened(strain), np.zeros((3, 3)), 10)
        path = drive(soil, element(soil, np.zeros((3, 3))), [loading])
        k, modulus = oedometer(
            friction_angle=phi, dilation_angle=angle, youngs_modulus=E, poissons_ratio=nu
        )
        vertical, lateral = _compression(path, AXIAL), _compression(path, RADIAL)
        name = f"psi = {np.degrees(angle):.3g} deg"
        checks += [
            relative(f"{name}: horizontal over vertical stress", lateral[-1] / vertical[-1], k,
                     EXACT),
            relative(f"{name}: modulus over E", vertical[-1] / strain / E, modulus / E, EXACT),
        ]  # fmt: skip
        x = strain * np.arange(1, 11) / 10.0
        series.append(
            Series(f"oedometer, {name}", "vertical shortening", "vertical stress, Pa",
                   tuple(x), tuple(vertical), tuple(modulus * x))
        )  # fmt: skip
    return Outcome(tuple(checks), tuple(series))


def pe2(
    *,
    p0: Stress = 100e3,
    c: Stress = 0.0,
    phi: Angle = DEGREES_30,
    psi: Angle = 0.0,
    E: Stress = 20e6,
    nu: float = 0.3,
    shortening_over_yield: float = 3.0,
) -> Outcome:
    """A drained sample is compressed at the cell pressure p0: q = (N - 1) p0 + 2 c sqrt(N).

    It yields at q / E; then the volume changes with psi alone.
    """
    soil = MohrCoulomb(E, nu, c, phi, psi)
    inputs = {"cell_pressure": p0, "cohesion": c, "friction_angle": phi, "dilation_angle": psi,
              "youngs_modulus": E, "poissons_ratio": nu}  # fmt: skip
    strength = drained_triaxial(1e6, **inputs).deviator_stress
    end, steps = shortening_over_yield * float(strength) / E, 60
    loading = Loading(LATERAL, _shortened(end), _isotropic(p0), steps)
    path = drive(soil, element(soil, _isotropic(p0)), [loading])
    x = end * np.arange(1, steps + 1) / steps
    exact = drained_triaxial(x, **inputs)
    q = _compression(path, AXIAL) - _compression(path, RADIAL)
    volume = np.array([np.trace(state.gradient) - 3.0 for state in path[1:]])
    worst = float(np.abs(q - exact.deviator_stress).max() / strength)
    return Outcome(
        checks=(
            relative("q at the end, Pa", q[-1], exact.deviator_stress[-1], EXACT),
            absolute("q over its end value, worst step", worst, 0.0, EXACT),
            relative("cell pressure, Pa", _compression(path, RADIAL)[-1], p0, EXACT),
            absolute("volumetric strain at the end over the axial one, extension positive",
                     volume[-1] / end, exact.volumetric_strain[-1] / end, EXACT),
        ),
        series=(
            Series("drained triaxial test", "axial shortening", "q, Pa", tuple(x), tuple(q),
                   tuple(exact.deviator_stress)),
            Series("volume", "axial shortening", "volumetric strain", tuple(x), tuple(volume),
                   tuple(exact.volumetric_strain)),
        ),
        residual_histories=_histories(path),
    )  # fmt: skip


def pe3(
    *,
    p0: Stress = 100e3,
    c: Stress = 0.0,
    phi: Angle = DEGREES_30,
    E: Stress = 20e6,
    nu: float = 0.3,
) -> Outcome:
    """An undrained sample is compressed without dilation: p' stays, q = M (p0 + c cot(phi)).

    The volume is held by a pore pressure, under a constant total cell pressure: its excess is a
    third of q.
    """
    soil = MohrCoulomb(E, nu, c, phi)
    strength = undrained_strength(mean_pressure=p0, cohesion=c, friction_angle=phi)
    end, steps = 3.0 * strength / E, 30
    loading = Loading(LATERAL, _shortened(end), _isotropic(p0), steps, is_undrained=True)
    path = drive(soil, element(soil, _isotropic(p0)), [loading])
    vertical, lateral = _compression(path, AXIAL), _compression(path, RADIAL)
    q, mean = vertical - lateral, (vertical + 2.0 * lateral) / 3.0
    exact = np.minimum(3.0 * E / (2.0 * (1.0 + nu)) * end * np.arange(1, steps + 1) / steps,
                       strength)  # fmt: skip
    x = tuple(end * np.arange(1, steps + 1) / steps)
    return Outcome(
        checks=(
            relative("q at the end, Pa", q[-1], strength, EXACT),
            absolute("q over its end value, worst step",
                     np.abs(q - exact).max() / strength, 0.0, EXACT),
            absolute("p' over p0, worst step less 1", np.abs(mean / p0 - 1.0).max(), 0.0, EXACT),
            relative("excess pore pressure at the end, Pa", path[-1].pore_pressure,
                     strength / 3.0, EXACT),
        ),
        series=(Series("undrained triaxial test", "axial shortening", "q, Pa", x, tuple(q),
                       tuple(exact)),),
        residual_histories=_histories(path),
    )  # fmt: skip


def pe6(
    *,
    sigma: Stress = 100e3,
    K0: float = 1.0,
    phi: Angle = DEGREES_35,
    psi: Angle = DEGREES_5,
    E: Stress = 20e6,
    nu: float = 0.3,
    shear: float = 0.5,
) -> Outcome:
    """Cohesionless soil is sheared under a constant vertical stress sigma (Davis).

    tau / sigma = sin(phi) cos(psi) / (1 - sin(phi) sin(psi)) once the elastic strains stop.
    """
    soil = MohrCoulomb(E, nu, 0.0, phi, psi)
    initial = -sigma * np.diag([K0, 1.0, K0])
    steps = 100
    loading = Loading(np.diag([False, True, False]), _sheared(shear), initial, steps)
    path = drive(soil, element(soil, initial), [loading])
    ratio = np.array([state.stress[0, 1] for state in path[1:]]) / sigma
    exact = simple_shear_ratio(friction_angle=phi, dilation_angle=psi)
    growth = path[-1].gradient - path[-2].gradient
    x = tuple(shear * np.arange(1, steps + 1) / steps)
    return Outcome(
        checks=(
            relative("tau / sigma at the end", ratio[-1], exact, 1e-6),
            absolute("dilation at the end, d(eps_z) / d(gamma)", growth[1, 1] / growth[0, 1],
                     np.tan(psi), 1e-6),
            relative("vertical stress, Pa", _compression(path, AXIAL)[-1], sigma, EXACT),
        ),
        series=(Series("simple shear", "shear strain", "tau / sigma", x, tuple(ratio),
                       (exact,) * steps),),
        residual_histories=_histories(path),
    )  # fmt: skip


def pe7(*, E: Stress = 10e3, nu: float = 0.0) -> Outcome:
    """A Hencky solid is sheared by g without volume change: tau = 2 G asinh(g/2) / sqrt(1 + g^2/4).

    Largest at x tanh(x) = 1, x = asinh(g / 2): g = 3.018, 1.3255 G.  Beyond, it softens.
    """
    soil, shear_modulus = HenckyElastic(E, nu), E / (2.0 * (1.0 + nu))
    peak, largest = hencky_simple_shear_peak(shear_modulus=shear_modulus)
    shears = np.unique(np.append(np.linspace(0.1, 4.0, 40), peak))
    start, loadings = element(soil, np.zeros((3, 3))), []
    for shear in shears:
        loadings.append(Loading(NOTHING, _sheared(shear), np.zeros((3, 3)), 1))
    path = drive(soil, start, loadings, is_finite_strain=True)
    tau = np.array([state.stress[0, 1] for state in path[1:]]) / shear_modulus
    exact = hencky_simple_shear(shears, shear_modulus=shear_modulus) / shear_modulus
    checks = [
        relative(f"tau / G at g = {value:g}", tau[at], exact[at], EXACT)
        for value in (0.1, 0.5, 1.0, 2.0)
        for at in [int(np.argmin(np.abs(shears - value)))]
    ]
    highest = int(np.argmax(tau))
    checks += [
        relative("largest tau / G", tau[highest], largest / shear_modulus, EXACT),
        relative("g of the largest tau", shears[highest], peak, EXACT),
    ]
    curve = Series("simple shear of a Hencky solid", "g", "tau / G", tuple(shears), tuple(tau),
                   tuple(exact))  # fmt: skip
    return Outcome(tuple(checks), (curve,))


PROBLEMS = (
    Problem("PE1", "Oedometer test on Mohr-Coulomb soil", pe1, is_quick=True),
    Problem("PE2", "Drained triaxial test on Mohr-Coulomb soil", pe2, is_quick=True),
    Problem("PE3", "Undrained triaxial test on Mohr-Coulomb soil", pe3, is_quick=True),
    Problem("PE6", "Simple shear of Mohr-Coulomb soil", pe6, is_quick=True),
    Problem("PE7", "Simple shear of a Hencky solid", pe7, is_quick=True),
)
