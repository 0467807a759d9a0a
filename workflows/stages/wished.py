"""The same pile at the same depth, wished in place: finite elements in undisturbed ground.

    python -m workflows.stages.wished CASE -o DIR

Reads the case, and ``installed.h5`` if loads have found the depth; writes
``wished_in_place/service.h5``.
"""

from __future__ import annotations

from pathlib import Path

from handoff.hand_over import wished_in_place
from handoff.placed_pile import PlacedPile
from handoff.surface import level_surface
from install_mpm.ground import boundary_depths
from service_fe.result_file import write_service_result
from service_fe.solve import run as run_programmes
from workflows.case import AnyCase, case_text
from workflows.directory import INSTALLED, WISHED, WISHED_SERVICE
from workflows.manifest import created_by
from workflows.placed import (
    is_end_given,
    loaded_in_service,
    pile_at_end,
    pile_where_rig_stopped,
    service_problem,
)
from workflows.progress import Advance, no_progress, service_observer
from workflows.ranks import is_first, on_first
from workflows.screw_case import ScrewCase
from workflows.stages.serve import fallback_notes, settled_notes, viscous_notes
from workflows.state_files import read_checked


def run(case: AnyCase, directory: Path, advance: Advance = no_progress) -> list[str]:
    """Run the programmes of ``case`` on the pile wished in place at its final depth.

    Raises
    ------
    StateFileError, DirectoryError
        If the end of the installation is not given, and ``installed.h5`` is missing or damaged.
    MeshError, EquilibrationError
        If the ground cannot be meshed or brought to equilibrium.
    ServiceError
        If a step does not converge; nothing is written.
    """
    assert case.handoff is not None
    assert case.service is not None
    placed = _placed(case, directory)
    options, boundaries = case.handoff, boundary_depths(case.ground)
    mesh = on_first(lambda: placed.mesh(case.box, options, level_surface(), boundaries))
    rigid = service_problem(case, placed, mesh)
    undisturbed = wished_in_place(case.ground, case.interface, rigid, options)
    problem, state = loaded_in_service(case, placed, rigid, undisturbed)
    result = run_programmes(
        problem,
        state,
        case.service.programmes,
        service_observer(case, advance),
        model="wished_in_place",
        case_text=case_text(case),
    )
    if is_first():
        (directory / WISHED).mkdir(exist_ok=True)
        write_service_result(directory / WISHED_SERVICE, result, created_by())
    return settled_notes(result) + viscous_notes(result) + fallback_notes(result)


def _placed(case: AnyCase, directory: Path) -> PlacedPile:
    if is_end_given(case):
        return pile_at_end(case)
    assert isinstance(case, ScrewCase)
    return pile_where_rig_stopped(case, read_checked(directory, INSTALLED, case))


if __name__ == "__main__":
    from workflows.cli import wished as command
    from workflows.script import run_script

    run_script(command)
