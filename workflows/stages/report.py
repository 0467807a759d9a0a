"""Write the report, one page that opens without network.

    python -m workflows.stages.report DIR

Reads the results of the other stages; writes ``report.html``.
"""

from __future__ import annotations

from pathlib import Path

from workflows.case import Case
from workflows.progress import Advance, no_progress
from workflows.report import write_report


def run(_case: Case, directory: Path, _advance: Advance = no_progress) -> list[str]:
    """Write the report; return where it is."""
    return [f"open {write_report(directory)}"]


if __name__ == "__main__":
    from workflows.cli import report as command
    from workflows.cli import run_script

    run_script(command)
