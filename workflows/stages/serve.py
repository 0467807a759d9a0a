"""Stage 3: load the installed pile in service.

    python -m workflows.stages.serve DIR

Reads ``handed_off.h5``; writes ``service.h5``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from handoff.fe_state_file import HandedOffPile, HandedOffState
from service_fe.result_file import write_service_result
from service_fe.results import ServiceResult
from service_fe.rigid_pile import axial
from service_fe.solve import run as run_programmes
from workflows.case import AnyCase, case_text
from workflows.directory import HANDED_OFF, SERVICE
from workflows.manifest import created_by
from workflows.placed import loaded_in_service, placed_pile, service_problem
from workflows.progress import Advance, no_progress, service_observer
from workflows.ranks import is_first
from workflows.state_files import read_checked


def run(case: AnyCase, directory: Path, advance: Advance = no_progress) -> list[str]:
    """Run the programmes of ``case`` on the handed-off state in ``directory``.

    Raises
    ------
    StateFileError, DirectoryError
        If ``handed_off.h5`` is missing or damaged, or belongs to another case.
    ServiceError
        If a step does not converge; nothing is written.
    MeshError
        If a deformable pile cannot be meshed.
    """
    handed_off: HandedOffState = read_checked(directory, HANDED_OFF, case)
    assert case.service is not None
    pile = handed_off.pile
    placed = placed_pile(case, float(pile.tip_depth), float(pile.rotation))
    rigid = service_problem(case, placed, handed_off.mesh)
    problem, state = loaded_in_service(case, placed, rigid, handed_off.state)
    result = run_programmes(
        problem,
        state,
        case.service.programmes,
        service_observer(case, advance),
        rebound=rebound_motion(pile, problem.dim),
        model="installed",
        case_text=case_text(case),
    )
    if is_first():
        write_service_result(directory / SERVICE, result, created_by())
    return settled_notes(result) + viscous_notes(result) + fallback_notes(result)


def rebound_motion(pile: HandedOffPile, dim: int) -> np.ndarray:
    """Return the motion (n_motions,) in m and rad of the pile while the rig let go of it."""
    motion = float(pile.rebound_rise) * axial(dim)
    motion[-1] += float(pile.rebound_rotation)
    return motion


def settled_notes(result: ServiceResult) -> list[str]:
    """Return a line for each programme in which steps did not converge and were settled."""
    settled = {
        entry.programme.name: int(np.count_nonzero(entry.curve.settled))
        for entry in result.programmes
    }
    return [
        f"{name}: {count} steps were settled with damping"
        for name, count in settled.items()
        if count
    ]


def viscous_notes(result: ServiceResult) -> list[str]:
    """Return a line for each programme in which viscosity took a part of the load."""
    largest = {
        entry.programme.name: float(entry.curve.viscous_share.max()) for entry in result.programmes
    }
    return [
        f"{name}: viscosity of the soil took at most {share:.2%} of the work of the load"
        for name, share in largest.items()
        if share
    ]


def fallback_notes(result: ServiceResult) -> list[str]:
    """Return a line for each programme in which multigrid or factors of low rank failed."""
    counts = {entry.programme.name: int(entry.curve.fallbacks.sum()) for entry in result.programmes}
    return [
        f"{name}: an approximate inverse failed {count} times, and exact factors took over"
        for name, count in counts.items()
        if count
    ]


if __name__ == "__main__":
    from workflows.cli import serve as command
    from workflows.script import run_script

    run_script(command)
