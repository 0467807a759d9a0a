"""Stage 2: hand the ground that the installation left over to finite elements.

    python -m workflows.stages.hand_off DIR

Reads ``installed.h5``; writes ``handed_off.h5`` and ``certificate.json``.
"""

from __future__ import annotations

from pathlib import Path

from handoff.fe_state_file import write_handed_off_state
from handoff.hand_over import hand_over
from handoff.quality import as_json, failed_checks
from install_mpm.state_file import InstalledState
from workflows.case import AnyCase, case_text
from workflows.directory import CERTIFICATE, HANDED_OFF, INSTALLED, write_text
from workflows.manifest import created_by
from workflows.placed import placed_pile, service_problem
from workflows.progress import Advance, no_progress
from workflows.ranks import is_first, on_first
from workflows.state_files import read_checked

PHASES = ("mesh", "transfer", "admissibility", "equilibration", "certificate")


def run(case: AnyCase, directory: Path, advance: Advance = no_progress) -> list[str]:
    """Hand over the installed state in ``directory``; return what the certificate objects to.

    Raises
    ------
    StateFileError, DirectoryError
        If ``installed.h5`` is missing or damaged, or belongs to another case.
    MeshError, EquilibrationError
        If the ground cannot be meshed or brought to equilibrium; nothing is written.
    """
    installed: InstalledState = read_checked(directory, INSTALLED, case)

    assert case.handoff is not None
    placed = placed_pile(case, float(installed.pile.tip_depth), float(installed.pile.rotation))
    handed_off, certificate = hand_over(
        installed,
        case.ground,
        placed,
        case.box,
        case.interface,
        case.handoff,
        lambda mesh: service_problem(case, placed, mesh),
        observe=lambda phase: advance(PHASES.index(phase), len(PHASES), phase),
        once=on_first,
    )
    handed_off = handed_off._replace(case_text=case_text(case))
    if is_first():
        write_handed_off_state(directory / HANDED_OFF, handed_off, created_by())
        write_text(directory / CERTIFICATE, as_json(certificate))
    return failed_checks(certificate)


if __name__ == "__main__":
    from workflows.cli import handoff as command
    from workflows.script import run_script

    run_script(command)
