"""The same pile at the same depth, wished in place: finite elements in undisturbed ground.

    python -m workflows.stages.wished CASE -o DIR

Reads the case; writes ``wished_in_place/service.h5``.
"""

from __future__ import annotations

from pathlib import Path

from handoff.hand_over import wished_in_place
from handoff.surface import level_surface
from install_mpm.ground import boundary_depths
from service_fe.result_file import write_service_result
from service_fe.solve import run as run_programmes
from workflows.case import AnyCase, case_text
from workflows.directory import WISHED, WISHED_SERVICE
from workflows.manifest import created_by
from workflows.placed import pile_at_end, service_problem
from workflows.progress import Advance, no_progress, service_observer
from workflows.ranks import is_first, on_first
from workflows.stages.serve import fallback_notes, settled_notes


def run(case: AnyCase, directory: Path, advance: Advance = no_progress) -> list[str]:
    """Run the programmes of ``case`` on the pile wished in place at its final depth.

    Raises
    ------
    MeshError, EquilibrationError
        If the ground cannot be meshed or brought to equilibrium.
    ServiceError
        If a step does not converge; nothing is written.
    """
    assert case.handoff is not None
    assert case.service is not None
    placed = pile_at_end(case)
    options, boundaries = case.handoff, boundary_depths(case.ground)
    mesh = on_first(lambda: placed.mesh(case.box, options, level_surface(), boundaries))
    problem = service_problem(case, placed, mesh)
    result = run_programmes(
        problem,
        wished_in_place(case.ground, case.interface, problem, case.handoff),
        case.service.programmes,
        service_observer(case, advance),
        model="wished_in_place",
        case_text=case_text(case),
    )
    if is_first():
        (directory / WISHED).mkdir(exist_ok=True)
        write_service_result(directory / WISHED_SERVICE, result, created_by())
    return settled_notes(result) + fallback_notes(result)


if __name__ == "__main__":
    from workflows.cli import wished as command
    from workflows.script import run_script

    run_script(command)
