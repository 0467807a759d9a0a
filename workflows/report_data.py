"""The results that a report is made of: everything is read from the files of one directory."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NamedTuple

from handoff.fe_state_file import HandedOffState
from install_mpm.ground import soils_of
from install_mpm.state_file import InstalledState
from service_fe.results import ServiceResult, without_pile
from workflows import directory as names
from workflows.case import Case, case_text
from workflows.errors import DirectoryError
from workflows.state_files import case_for, read_checked


class Results(NamedTuple):
    """Content of a results directory."""

    case: Case
    case_text: str
    """Canonical TOML text of the case."""
    installed: InstalledState
    handed_off: HandedOffState
    service: ServiceResult
    wished: ServiceResult
    certificate: dict[str, dict[str, Any]]
    """Figure by name: value, unit, meaning, limit, is_met."""
    summary: dict[str, Any]


def read_results(directory: Path) -> Results:
    """Return the results in ``directory``.

    Raises
    ------
    DirectoryError
        If the directory or a JSON file is missing or damaged, or a file belongs to another case.
    StateFileError
        If a state file is missing or damaged.
    """
    if not directory.is_dir():
        raise DirectoryError(f"{directory}: no such directory; run `screwpile run` first")
    case = case_for(directory, names.INSTALLED)
    if not isinstance(case, Case):
        raise DirectoryError(f"{directory} holds a screw pile; run `screwpile report` on it")
    n_soils = len(soils_of(case.ground))
    return Results(
        case=case,
        case_text=case_text(case),
        installed=read_checked(directory, names.INSTALLED, case),
        handed_off=read_checked(directory, names.HANDED_OFF, case),
        service=without_pile(read_checked(directory, names.SERVICE, case), n_soils),
        wished=without_pile(read_checked(directory, names.WISHED_SERVICE, case), n_soils),
        certificate=read_json(directory / names.CERTIFICATE, "screwpile handoff"),
        summary=read_json(directory / names.SUMMARY, "screwpile compare"),
    )


def read_json(path: Path, command: str) -> dict[str, Any]:
    """Return the content of a JSON file that ``command`` writes.

    Raises
    ------
    DirectoryError
        If it is missing or no JSON object.
    """
    remedy = f"run `{command} {path.parent}` first"
    if not path.exists():
        raise DirectoryError(f"{path}: no such file; {remedy}")
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise DirectoryError(f"{path}: cannot be read ({error}); {remedy}") from error
    if not isinstance(content, dict):
        raise DirectoryError(f"{path}: holds no table of results; {remedy}")
    return content
