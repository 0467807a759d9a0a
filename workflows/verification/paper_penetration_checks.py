"""What the problems with the paper's pile share: geometry, checks, curves and pictures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from workflows.verification.penetration import Penetration, PenetrationResult, work_and_energy
from workflows.verification.problem import Check, Picture, Series, absolute, at_most, relative
from workflows.verification.references import prototype

Run = tuple[str, Penetration, PenetrationResult]
"""Name, what was run, and its result."""


def geometry(
    size: float,
    width: float,
    depth: float,
    half_width: float,
    embedment: float,
    step: float,
    penetration: float,
) -> Penetration:
    """Return the geometry, mesh size and steps of a run, lengths in m."""
    return Penetration(
        size=size, width=width, depth=depth, half_width=half_width, embedment=embedment,
        step=step, steps=round(penetration / step),
    )  # fmt: skip


def is_of_the_paper(problem: Penetration) -> bool:
    """Return whether geometry and step are the paper's, so that the prototype's table holds."""
    paper = Penetration()
    names = ("width", "depth", "half_width", "embedment", "step")
    return all(getattr(problem, name) == getattr(paper, name) for name in names)


def scaled(table: dict[int, float], youngs_modulus: float) -> dict[int, float]:
    """Return the prototype's reactions in N for another modulus in Pa: they are in proportion."""
    factor = youngs_modulus / prototype.YOUNGS_MODULUS
    return {number: factor * force for number, force in table.items()}


def checks_to_prototype(
    name: str,
    result: PenetrationResult,
    table: dict[int, float],
    tolerance: float,
) -> list[Check]:
    """Return checks of the reaction at the steps of the table that were made."""
    return [
        relative(
            f"({name}) reaction at step {number} against the prototype, N/m",
            result.reaction_at(Penetration.step * number),
            force,
            tolerance,
        )
        for number, force in table.items()
        if Penetration.step * number <= result.penetration[-1] + 1e-9
    ]


def not_claimed(check: Check) -> str:
    """Return a comparison that is not claimed, in words."""
    return f"not claimed within {check.tolerance:.0%}: {check.quantity}, {check.error:+.1%}"


def energy_check(name: str, result: PenetrationResult, problem: Penetration) -> Check:
    """Return the check that no energy comes from nowhere: elastic soil stores the work at most."""
    work, energy = work_and_energy(result, problem)
    beyond = max(energy / work - 1.0, 0.0)
    return at_most(f"({name}) energy beyond the work of the pile, share", beyond, 0.01)


def dissipation_remark(name: str, result: PenetrationResult, problem: Penetration) -> str:
    """Return the remark on the work that the scheme loses from step to step."""
    work, energy = work_and_energy(result, problem)
    return (
        f"({name}) work {work / 1e3:.2f} kJ/m, stored {energy / 1e3:.2f} kJ/m: the scheme loses "
        f"{100.0 * (1.0 - energy / work):.1f} %; steps cut: {result.cuts}."
    )


def dragged_check(levels: np.ndarray, result: PenetrationResult, problem: Penetration) -> Check:
    """Return the check of the surface that sticks to the pile against the prototype's, Fig. 6."""
    is_same = is_of_the_paper(problem) and abs(result.penetration[-1] - 4.0) < 1e-9
    if not is_same or len(levels) != 8:
        rise = max(levels[0] - levels[-1], 0.0)
        return at_most("rise of the surface towards a rough pile, m", rise, 0.0)
    worst = int(np.abs(levels - prototype.NO_SLIP_SURFACE).argmax())
    return absolute(
        "surface beside a rough pile against the prototype without slip, worst, m",
        levels[worst],
        prototype.NO_SLIP_SURFACE[worst],
        0.02,
    )


def excess_of_strength(result: PenetrationResult, cohesion: float, friction: float) -> float:
    """Return by how much |t_s| exceeds c - t_n tan(phi), over the largest strength; 0 if never."""
    shear, normal = result.body.interface.traction.T
    strength = cohesion - normal * np.tan(friction)
    return float(max((np.abs(shear) - strength).max() / strength.max(), 0.0))


def reaction_curve(name: str, result: PenetrationResult, table: dict[int, float]) -> Series:
    """Return the reaction; the reference is the table, between its steps linear."""
    steps = result.penetration / Penetration.step
    reference: tuple[float, ...] = ()
    if table:
        reference = tuple(np.interp(steps, [0, *table], [0.0, *table.values()]))
    return Series(
        f"({name}) reaction on the half pile",
        "penetration, m",
        "reaction, N/m",
        tuple(result.penetration),
        tuple(result.reaction),
        reference,
    )


def states_picture(runs: Sequence[Run]) -> Picture:
    """Return the picture of the initial state and of the final state of each run."""

    def draw() -> Any:
        from workflows.verification.paper_drawings import pile_states

        return pile_states(runs)

    return Picture("states", "Vertical displacement, initial and final state", draw)
