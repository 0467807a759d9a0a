"""Repeat hand-over and service on a second mesh and with a second transfer.

    python -m workflows.stages.repeat DIR

Reads ``installed.h5`` and the results of the pile wished in place; writes ``repeated.json`` and,
below ``repeated/``, a results directory of each repeat, in which what did not change is kept.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from install_mpm.state_file import InstalledState
from service_fe.results import ServiceResult
from workflows import directory as names
from workflows.case import AnyCase
from workflows.certified import failed_rows
from workflows.compare import installation_figures, programme_figures
from workflows.comparison import Repeat, repeats_of
from workflows.continuity import continuity_figures
from workflows.directory import claim, write_text
from workflows.progress import Advance, Reporter, no_progress
from workflows.report_data import read_json
from workflows.runner import is_up_to_date, run_stage
from workflows.stage_table import stage_named
from workflows.state_files import read_checked


def run(case: AnyCase, directory: Path, advance: Advance = no_progress) -> list[str]:
    """Run the repeats of ``case``; return what their certificates object to.

    A repeat whose certificate has failed counts all the same: it only widens the range.

    Raises
    ------
    StateFileError, DirectoryError
        If a file is missing or damaged, or belongs to another case.
    MeshError, EquilibrationError, ServiceError
        If a repeat cannot be meshed, balanced or loaded.
    """
    installed: InstalledState = read_checked(directory, names.INSTALLED, case)
    installation = installation_figures(installed)
    wished: ServiceResult = read_checked(directory, names.WISHED_SERVICE, case)
    repeats = repeats_of(case)
    reporter = _OneCount(advance, sum(len(repeat.stages) for repeat in repeats))
    results = {}
    for repeat in repeats:
        folder = directory / names.REPEATS / repeat.name
        _run_stages(repeat, folder, reporter)
        results[repeat.name] = _results(repeat, folder, installation, wished)
    write_text(directory / names.REPEATED, json.dumps(results, indent=2) + "\n")
    return [
        f"{result['what']}: certificate not kept in {', '.join(result['failed_checks'])}"
        for result in results.values()
        if result["failed_checks"]
    ]


def _run_stages(repeat: Repeat, folder: Path, reporter: _OneCount) -> None:
    """Run those stages of a repeat in ``folder`` that are not up to date."""
    claim(folder, repeat.case)
    installed = folder / names.INSTALLED
    installed.unlink(missing_ok=True)
    installed.symlink_to(Path("..", "..", names.INSTALLED))
    for name in repeat.stages:
        stage = stage_named(name, repeat.case)
        if not is_up_to_date(stage, repeat.case, folder):
            run_stage(stage, repeat.case, folder, reporter)
        reporter.finished += 1


def _results(
    repeat: Repeat, folder: Path, installation: dict[str, Any], wished: ServiceResult
) -> dict[str, Any]:
    """Return what was changed, the rows of the certificate that failed, and all figures."""
    case = repeat.case
    service: ServiceResult = read_checked(folder, names.SERVICE, case)
    if "wished" in repeat.stages:
        wished = read_checked(folder, names.WISHED_SERVICE, case)
    certificate = read_json(folder / names.CERTIFICATE, "screwpile handoff")
    return {
        "what": repeat.what,
        "failed_checks": failed_rows(certificate),
        "service": {
            result.programme.name: programme_figures(
                result, wished.programme(result.programme.name), case.pile.width
            )
            for result in service.programmes
        },
        "continuity": continuity_figures(case, installation, service),
    }


class _OneCount(Reporter):
    """Shows the stages of all repeats as one count, each as a hundred."""

    def __init__(self, advance: Advance, n_stages: int) -> None:
        self.advance, self.n_stages = advance, n_stages
        self.finished = 0

    @contextmanager
    def stage(self, name: str, doing: str) -> Iterator[Advance]:
        """Show one stage as a part of the whole."""

        def show(done: int, total: int, _note: str) -> None:
            share = 100 * done // total
            self.advance(100 * self.finished + share, 100 * self.n_stages, f"{name}: {doing}")

        yield show

    def say(self, text: str) -> None:
        """Say nothing: what counts is said at the end."""


if __name__ == "__main__":
    from workflows.cli import repeat as command
    from workflows.script import run_script

    run_script(command)
