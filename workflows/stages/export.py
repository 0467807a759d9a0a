"""Write the results for ParaView.

    python -m workflows.stages.export DIR

Reads the results of the other stages; writes ``paraview/``.
"""

from __future__ import annotations

from pathlib import Path

from workflows import directory as names
from workflows.case import AnyCase
from workflows.export import export_background_mesh, export_material_points, export_service
from workflows.progress import Advance, no_progress
from workflows.screw_case import ScrewCase
from workflows.screw_export import export_screw_pile
from workflows.state_files import read_checked


def run(case: AnyCase, directory: Path, _advance: Advance = no_progress) -> list[str]:
    """Write the views of the installed state and, if the case has them, of both service models.

    Raises
    ------
    StateFileError, DirectoryError
        If a file is missing or damaged, or belongs to another case.
    """
    installed = read_checked(directory, names.INSTALLED, case)
    if isinstance(case, ScrewCase):
        export_screw_pile(directory, installed, case.ground)
        if case.service is None:
            return []
    service = read_checked(directory, names.SERVICE, case)
    wished = read_checked(directory, names.WISHED_SERVICE, case)
    if not isinstance(case, ScrewCase):
        export_material_points(directory / names.VIEW_POINTS, installed, case.ground)
        export_background_mesh(directory / names.VIEW_BACKGROUND, installed)
    export_service(directory / names.VIEW_INSTALLED, service)
    export_service(directory / names.VIEW_WISHED, wished)
    return []


if __name__ == "__main__":
    from workflows.cli import export as command
    from workflows.script import run_script

    run_script(command)
