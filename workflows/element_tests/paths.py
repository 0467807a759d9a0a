"""The laboratory tests by name: how an element of soil is loaded from its initial stress.

Axis 1 of the element is vertical, axes 0 and 2 are horizontal.  Strains are those that the
apparatus measures, over the initial lengths, and large: the element is in finite strain, as the
soil of an installation is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from install_mpm.constitutive.element_driver import Element, Loading, drive, element
from install_mpm.constitutive.parameters import SoilParameters

LATERAL = np.diag([True, False, True])
VERTICAL = np.diag([False, True, False])
NOTHING = np.zeros((3, 3), dtype=bool)
STEPS = 200
"""Steps of a test, and of each quarter of a cycle a fifth of them."""
CYCLES = 5


@dataclass(frozen=True)
class Sample:
    """Where a test starts, and how far it goes."""

    pressure: float
    """Effective stress in Pa after consolidation, compression positive: the cell pressure in
    triaxial tests, the vertical stress in others."""
    k0: float
    """Horizontal over vertical stress; not in triaxial tests."""
    depth: float
    """Depth in m below the surface from which the sample is, for laws that vary with it."""
    strain: float
    """Largest axial or shear strain; the amplitude in cyclic loading."""


@dataclass(frozen=True)
class LaboratoryTest:
    """A test: its path, and what is plotted against what."""

    meaning: str
    loadings: Callable[[Sample], list[Loading]]
    is_isotropic: bool
    is_undrained: bool
    is_shear: bool
    strain: float
    """Largest strain unless another is asked for."""


def _axial(sample: Sample, *, is_undrained: bool) -> list[Loading]:
    """Return axial shortening at constant cell pressure."""
    gradient, stress = np.diag([0.0, -sample.strain, 0.0]), -sample.pressure * np.eye(3)
    return [Loading(LATERAL, gradient, stress, STEPS, is_undrained)]


def _confined(sample: Sample) -> list[Loading]:
    """Return axial shortening without lateral strain."""
    return [Loading(NOTHING, np.diag([0.0, -sample.strain, 0.0]), np.zeros((3, 3)), STEPS)]


def _sheared(sample: Sample, *, is_undrained: bool, turns: tuple[float, ...]) -> list[Loading]:
    """Return simple shear to ``turns`` times the strain, at constant vertical stress or volume."""
    stress = -sample.pressure * VERTICAL.astype(float)
    loadings, last = [], 0.0
    for turn in turns:
        gradient = np.zeros((3, 3))
        gradient[0, 1] = turn * sample.strain
        steps = STEPS if len(turns) == 1 else int(abs(turn - last) * STEPS / 5)
        is_driven = NOTHING if is_undrained else VERTICAL
        loadings.append(Loading(is_driven, gradient, stress, steps))
        last = turn
    return loadings


def _monotonic(sample: Sample) -> list[Loading]:
    return _sheared(sample, is_undrained=False, turns=(1.0,))


def _constant_volume(sample: Sample) -> list[Loading]:
    return _sheared(sample, is_undrained=True, turns=(1.0,))


def _cyclic(sample: Sample) -> list[Loading]:
    return _sheared(sample, is_undrained=True, turns=(1.0, -1.0) * CYCLES + (0.0,))


TESTS = {
    "oedometer": LaboratoryTest(
        "axial shortening without lateral strain", _confined, False, False, False, 0.1
    ),
    "triaxial_drained": LaboratoryTest(
        "axial shortening at constant cell pressure, drained",
        lambda sample: _axial(sample, is_undrained=False), True, False, False, 0.2,
    ),
    "triaxial_undrained": LaboratoryTest(
        "axial shortening at constant cell pressure and volume",
        lambda sample: _axial(sample, is_undrained=True), True, True, False, 0.2,
    ),
    "simple_shear": LaboratoryTest(
        "simple shear at constant vertical stress", _monotonic, False, False, True, 0.5
    ),
    "simple_shear_undrained": LaboratoryTest(
        "simple shear at constant volume", _constant_volume, False, True, True, 0.5
    ),
    "cyclic_shear": LaboratoryTest(
        f"{CYCLES} cycles of simple shear at constant volume", _cyclic, False, True, True, 0.02
    ),
}  # fmt: skip
"""Every test by its name on the command line."""


def skeleton_of(soil: SoilParameters) -> SoilParameters:
    """Return the law without its pore fluid: in the laboratory the test says whether it drains."""
    has_fluid = getattr(soil, "pore_fluid_bulk_modulus", 0.0) > 0.0
    return replace(soil, pore_fluid_bulk_modulus=0.0) if has_fluid else soil  # type: ignore[arg-type]


def run_test(soil: SoilParameters, name: str, sample: Sample) -> list[Element]:
    """Return the states of the element after every step of the test ``name``.

    Raises
    ------
    ElementTestError
        If the soil cannot follow the path.
    """
    test = TESTS[name]
    k0 = 1.0 if test.is_isotropic else sample.k0
    start = element(soil, -sample.pressure * np.diag([k0, 1.0, k0]), depth=sample.depth)
    return drive(soil, start, test.loadings(sample), is_finite_strain=True)
