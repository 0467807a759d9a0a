"""UNITS: the same installation in m-kg-s and in other units of length, mass and time.

A pile is jacked into clay that yields under its own weight, beside an interface that slips and an
empty layer into which the clay heaves: plasticity, interface, gravity, moving mesh, injection.  All
inputs are converted, gravity among them; the results, converted back, may differ by round-off only.
A number with a dimension anywhere in the method, such as a tolerance in metres, would show.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.conventions import GRAVITY, Unit
from install_mpm.discretisation import Scheme
from install_mpm.ground import Ground
from install_mpm.material_points import cauchy_stress
from workflows.verification.penetration import Penetration, PenetrationResult, penetrate
from workflows.verification.problem import Check, Outcome, Problem, Series, at_most

EXACT = 1e-9
POISSONS_RATIO = 0.49
STEP = 0.02
"""Of the pile, over its half-width."""


class UnitSystem(NamedTuple):
    """Units in SI: m, kg, s."""

    length: float
    mass: float
    time: float

    @property
    def acceleration(self) -> float:
        """Unit of acceleration in m/s^2."""
        return self.length / self.time**2

    @property
    def stress(self) -> float:
        """Unit of stress in Pa."""
        return self.mass / (self.length * self.time**2)

    @property
    def line_force(self) -> float:
        """Unit of a force per metre run in N/m."""
        return self.stress * self.length


@dataclass(frozen=True)
class Jacked(Penetration):
    """A pile jacked into heavy clay."""

    undrained_shear_strength: float = 0.0
    unit_weight: float = 0.0

    @property
    def ground(self) -> Ground:
        """Von Mises clay with K0 = 1."""
        soil = VonMises(self.youngs_modulus, self.poissons_ratio, self.undrained_shear_strength)
        return Ground(self.unit_weight, 1.0, soil)


def independence_of_units(
    *,
    length: Annotated[float, Unit("m")] = 1e-3,
    mass: Annotated[float, Unit("kg")] = 1e-3,
    time: Annotated[float, Unit("s")] = 1.0,
    b: Annotated[float, Unit("m")] = 0.5,
    E: Annotated[float, Unit("Pa")] = 2e6,
    su: Annotated[float, Unit("Pa")] = 10e3,
    gamma: Annotated[float, Unit("N/m^3")] = 18e3,
    alpha: float = 0.5,
    steps: int = 8,
) -> Outcome:
    """A pile of half-width b in clay, in m-kg-s and with the units ``length``, ``mass``, ``time``.

    The units are those of the second run, in SI: by default millimetre, gramme and second.
    """
    units = UnitSystem(length, mass, time)
    clay = (E, su, gamma)
    first = penetrate(_problem(UnitSystem(1.0, 1.0, 1.0), b, clay, alpha, steps))
    second = penetrate(_problem(units, b, clay, alpha, steps))
    share_yielding = _share_yielding(first, su)
    return Outcome(
        checks=(
            *_compared(first, second, units),
            Check("Newton iterations of all steps", sum(map(len, second.residuals)),
                  sum(map(len, first.residuals)),
                  sum(map(len, second.residuals)) - sum(map(len, first.residuals)), 0.0),
            at_most("steps that were cut", first.cuts + second.cuts, 0.0),
        ),
        series=(
            Series(
                "Reaction on the half pile, both runs in SI",
                "penetration, m",
                "reaction, N/m",
                tuple(first.penetration),
                tuple(second.reaction * units.line_force),
                tuple(first.reaction),
            ),
        ),
        remarks=(
            f"{share_yielding:.0%} of the material points have a shear stress beyond 0.99 su at the"
            " end",
        ),
        residual_histories=first.residuals + second.residuals,
    )  # fmt: skip


def _problem(
    units: UnitSystem, b: float, clay: tuple[float, float, float], alpha: float, steps: int
) -> Jacked:
    """Return the problem in ``units``; the half-width ``b`` and ``clay`` (E, su, gamma) in SI."""
    youngs_modulus, strength, unit_weight = clay
    half_width = b / units.length
    spring = youngs_modulus / b * units.length / units.stress  # a stress per length
    return Jacked(
        youngs_modulus=youngs_modulus / units.stress,
        poissons_ratio=POISSONS_RATIO,
        width=6.0 * half_width,
        depth=10.0 * half_width,
        half_width=half_width,
        embedment=4.0 * half_width,
        step=STEP * half_width,
        steps=steps,
        size=half_width,
        law=CoulombInterface(50.0 * spring, 5.0 * spring, adhesion_factor=alpha),
        scheme=Scheme.CARRIERS,
        headroom=half_width,
        max_cuts=0,
        gravity=GRAVITY / units.acceleration,
        undrained_shear_strength=strength / units.stress,
        unit_weight=unit_weight * units.length / units.stress,
    )


def _compared(
    first: PenetrationResult, second: PenetrationResult, units: UnitSystem
) -> tuple[Check, ...]:
    """Return the checks of ``second``, converted to SI, against ``first``.

    Errors are the largest over all steps or points, over the largest value.
    """
    points, others = first.body.points, second.body.points
    fields = (
        ("reaction in N/m", first.reaction, second.reaction * units.line_force),
        ("place of a material point in m", points.position, others.position * units.length),
        ("mass of a material point in kg per metre", points.mass,
         others.mass * units.mass / units.length),
        ("stress in Pa", cauchy_stress(points), cauchy_stress(others) * units.stress),
        ("elastic strain", points.elastic_log_strain, others.elastic_log_strain),
        ("traction of the interface in Pa", first.body.interface.traction,
         second.body.interface.traction * units.stress),
    )  # fmt: skip
    return tuple(
        Check(
            f"largest {name} at the end, error of any",
            float(np.abs(converted).max()),
            float(np.abs(original).max()),
            float(np.abs(converted - original).max() / np.abs(original).max()),
            EXACT,
        )
        for name, original, converted in fields
    )


def _share_yielding(result: PenetrationResult, strength: float) -> float:
    """Return the share of the material points that are at yield."""
    stress = result.body.points.kirchhoff_stress
    deviator = stress - np.trace(stress, axis1=1, axis2=2)[:, None, None] / 3.0 * np.eye(3)
    norm = np.linalg.norm(deviator, axis=(1, 2))
    return float((norm > 0.99 * np.sqrt(2.0) * strength).mean())


PROBLEM = Problem("UNITS", "A pile jacked into clay in two systems of units",
                  independence_of_units, is_quick=True)  # fmt: skip
