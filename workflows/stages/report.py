"""Write the report, one page that opens without network.

    python -m workflows.stages.report DIR

Reads the results of the other stages; writes ``report.html``.
"""

from __future__ import annotations

from pathlib import Path

from workflows.case import AnyCase
from workflows.directory import INSTALLED
from workflows.progress import Advance, no_progress
from workflows.report import write_report
from workflows.screw_case import ScrewCase
from workflows.screw_report import write_screw_report
from workflows.state_files import read_checked


def run(case: AnyCase, directory: Path, _advance: Advance = no_progress) -> list[str]:
    """Write the report; return where it is."""
    if isinstance(case, ScrewCase):
        installed = read_checked(directory, INSTALLED, case)
        return [f"open {write_screw_report(directory, case, installed)}"]
    return [f"open {write_report(directory)}"]


if __name__ == "__main__":
    from workflows.cli import report as command
    from workflows.script import run_script

    run_script(command)
