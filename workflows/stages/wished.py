"""The same pile at the same depth, wished in place: finite elements in undisturbed ground.

    python -m workflows.stages.wished CASE -o DIR

Reads the case; writes ``wished_in_place/service.h5``.
"""

from __future__ import annotations

from pathlib import Path

from handoff.fe_mesh import make_mesh
from handoff.surface import level_surface
from install_mpm.ground import boundary_depths
from install_mpm.pile import buried_weight
from service_fe.problem import ServiceProblem
from service_fe.result_file import write_service_result
from service_fe.solve import run as run_programmes
from workflows.case import Case, case_text
from workflows.directory import WISHED, WISHED_SERVICE
from workflows.manifest import created_by
from workflows.progress import Advance, no_progress, service_observer
from workflows.stages.serve import settled_notes


def run(case: Case, directory: Path, advance: Advance = no_progress) -> list[str]:
    """Run the programmes of ``case`` on the pile wished in place at its final depth.

    Raises
    ------
    MeshError
        If the ground cannot be meshed.
    ServiceError
        If a step does not converge; nothing is written.
    """
    depth = case.final_tip_depth
    layers = boundary_depths(case.ground)
    mesh = make_mesh(case.pile, depth, case.box, case.handoff, level_surface(), layers)
    weight = buried_weight(case.pile, depth, case.kinematics, case.ground.water_table)
    problem = ServiceProblem(
        mesh, case.ground, case.interface, weight, case.service.numerics,
        kinematics=case.kinematics,
    )  # fmt: skip
    result = run_programmes(
        problem,
        problem.wished_in_place_state(),
        case.service.programmes,
        service_observer(case, advance),
        model="wished_in_place",
        case_text=case_text(case),
    )
    (directory / WISHED).mkdir(exist_ok=True)
    write_service_result(directory / WISHED_SERVICE, result, created_by())
    return settled_notes(result)


if __name__ == "__main__":
    from workflows.cli import wished as command
    from workflows.script import run_script

    run_script(command)
