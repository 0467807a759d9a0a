"""PF2, PF4 and PF5: the hand-over of a pile in clay: ground at rest, strength, conservation.

The pile is installed by the material point method, in plane strain, and handed over as in a run.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from handoff.hand_over import hand_over
from handoff.options import HandoffOptions
from handoff.placed_pile import PlacedFlatPile
from handoff.quality import Certificate
from handoff.state_transfer import state_map, transfer_state
from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.conventions import Unit
from install_mpm.ground import Ground
from install_mpm.installation import install
from install_mpm.material_points import cauchy_stress
from install_mpm.options import BackgroundMeshOptions, Box, InstallationProgramme, Numerics
from install_mpm.pile import Pile
from install_mpm.state_file import InstalledState
from service_fe.problem import ServiceProblem
from workflows.verification.problem import Check, Outcome, Problem, at_most

SIZE, SIZE_FAR = 0.125, 1.5
"""Cells of the installation at the pile and far away over the width B of the pile."""

FE_SIZE = 0.1
"""Cells of the finite elements at the pile over B."""

STRENGTH_KEPT, CONSERVED, REACTION_KEPT = 1e-6, 0.005, 0.01


class Site(NamedTuple):
    """Pile and ground; lengths in m, stresses in Pa."""

    width: float
    embedment: float
    depth: float
    penetration: float
    unit_weight: float
    k0: float
    strength: float
    modulus: float
    poissons_ratio: float
    adhesion: float


class HandOver(NamedTuple):
    """An installed pile and what became of it."""

    installed: InstalledState
    certificate: Certificate
    stress_integral: tuple[np.ndarray, np.ndarray, np.ndarray]
    """Integral (3, 3) in N m of the stress: points, finite elements as transferred, in balance."""
    residuals: tuple[tuple[float, ...], ...]

    def value(self, name: str) -> float:
        """Return a figure of the certificate."""
        return self.certificate.figures[name].value


def handed_over(site: Site) -> HandOver:
    """Return the hand-over of a pile that was pushed in by ``penetration``."""
    width, soil = site.width, VonMises(site.modulus, site.poissons_ratio, site.strength)
    ground = Ground(site.unit_weight, site.k0, soil)
    pile = Pile(0.5 * width, site.embedment, site.unit_weight)
    spring = 50.0 * site.modulus / width
    interface = CoulombInterface(spring, 0.1 * spring, adhesion_factor=site.adhesion)
    box = Box(6.0 * width, site.depth, 0.6 * width)
    installed = install(
        ground, pile, interface, box, BackgroundMeshOptions(SIZE * width, SIZE_FAR * width),
        InstallationProgramme(site.penetration, 0.03 * width), Numerics(), "",
    )  # fmt: skip
    placed = PlacedFlatPile(pile, float(installed.pile.tip_depth))
    options = HandoffOptions(size_at_pile=FE_SIZE * width, size_far=width)
    handed_off, certificate = hand_over(
        installed, ground, placed, box, interface,
        options,
        lambda mesh: ServiceProblem(
            mesh, ground, interface, placed.weight(None)
        ),
        lambda _phase: None,
    )  # fmt: skip
    points, volume = installed.material_points, handed_off.integration.volume
    problem = ServiceProblem(handed_off.mesh, ground, interface)
    chart = state_map(points, placed, problem.integration_positions, options)
    transferred = transfer_state(installed, ground, placed, problem, chart)
    integral = (
        np.einsum("p,pij->ij", points.volume, cauchy_stress(points)),
        np.einsum("q,qij->ij", volume, transferred.cauchy_stress),
        np.einsum("q,qij->ij", volume, handed_off.state.cauchy_stress),
    )
    rows = installed.history.residual_history[1:]
    residuals = tuple(tuple(row[~np.isnan(row)]) for row in rows)
    return HandOver(installed, certificate, integral, residuals)


def pf2(
    *,
    gamma: Annotated[float, Unit("N/m^3")] = 10e3,
    K0: float = 0.5,
    H: Annotated[float, Unit("m")] = 10.0,
    E: Annotated[float, Unit("Pa")] = 10e6,
    nu: float = 0.3,
) -> Outcome:
    """Ground at rest, H deep, with a pile that was not moved: handed over, nothing may happen."""
    rest = Site(0.2 * H, 0.4 * H, H, 0.0, gamma, K0, gamma * H, E, nu, 1.0)
    result = handed_over(rest)
    settlement = gamma * H**2 / E
    return Outcome(
        (
            at_most("out-of-balance force / weight, transferred",
                    result.value("out_of_balance_before"), 0.01),
            at_most("out-of-balance force / weight, in equilibrium",
                    result.value("out_of_balance_after"), 1e-8),
            at_most("largest displacement E / (gamma H^2)",
                    result.value("equilibration_displacement") / settlement, 1e-6),
        )
    )  # fmt: skip


def pf4(
    *,
    B: Annotated[float, Unit("m")] = 1.0,
    penetration: Annotated[float, Unit("m")] = 0.3,
    gamma: Annotated[float, Unit("N/m^3")] = 18e3,
    su: Annotated[float, Unit("Pa")] = 20e3,
    E_over_su: float = 200.0,
    nu: float = 0.49,
    alpha: float = 0.5,
) -> Outcome:
    """A pile is jacked into clay and handed over: no stress is left outside the yield surface."""
    result = handed_over(_clay(B, penetration, gamma, su, E_over_su, nu, alpha))
    share, mean, largest = (
        result.value(f"yield_correction_{name}") for name in ("share", "mean", "max")
    )
    return Outcome(
        (
            at_most("largest yield function over largest stress",
                    result.value("yield_violation"), STRENGTH_KEPT),
            Check("share of points returned to the yield surface", share, 0.0, share, None),
        ),
        remarks=(
            f"Returned points change by {mean:.2%} of their deviatoric stress on average and by"
            f" {largest:.2%} at most.",
        ),
        residual_histories=result.residuals,
    )  # fmt: skip


def pf5(
    *,
    B: Annotated[float, Unit("m")] = 1.0,
    penetration: Annotated[float, Unit("m")] = 0.3,
    gamma: Annotated[float, Unit("N/m^3")] = 18e3,
    su: Annotated[float, Unit("Pa")] = 20e3,
    E_over_su: float = 200.0,
    nu: float = 0.49,
    alpha: float = 0.5,
) -> Outcome:
    """A pile is jacked into clay and handed over: volume, mass, stress and reaction are kept."""
    result = handed_over(_clay(B, penetration, gamma, su, E_over_su, nu, alpha))
    before, *after = result.stress_integral
    carried, balanced = (
        float(np.linalg.norm(each - before) / np.linalg.norm(before)) for each in after
    )
    return Outcome(
        (
            at_most("difference in volume", result.value("volume_difference"), CONSERVED),
            at_most("difference in mass and weight", result.value("mass_difference"), CONSERVED),
            at_most("difference in the integral of stress, transferred", carried, CONSERVED),
            Check("the same, in equilibrium", balanced, 0.0, balanced, None),
            at_most("change of the soil reaction on the pile",
                    result.value("pile_reaction_change"), REACTION_KEPT),
        ),
        residual_histories=result.residuals,
    )  # fmt: skip


def _clay(
    width: float, penetration: float, gamma: float, su: float, rigidity: float, nu: float,
    alpha: float,
) -> Site:  # fmt: skip
    return Site(
        width, 4.0 * width, 9.0 * width, penetration, gamma, 1.0, su, rigidity * su, nu, alpha
    )


PROBLEMS = (
    Problem("PF2", "Ground at rest is handed over", pf2, is_quick=True),
    Problem("PF4", "Strength after the hand-over", pf4, is_quick=False),
    Problem("PF5", "Conservation in the hand-over", pf5, is_quick=False),
)
