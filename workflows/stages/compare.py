"""Compare the installed pile with the one wished in place.

    python -m workflows.stages.compare DIR

Reads the results of the other stages, also of the repeats if the case has them; writes
``curves.csv`` and ``summary.json``.
"""

from __future__ import annotations

import json
from pathlib import Path

from install_mpm.state_file import InstalledState, case_hash
from service_fe.results import ServiceResult
from workflows import directory as names
from workflows.case import AnyCase, case_text
from workflows.compare import convergence, curves_csv, headline
from workflows.directory import write_text
from workflows.errors import DirectoryError
from workflows.manifest import file_hash, read_manifest, software_versions
from workflows.progress import Advance, no_progress
from workflows.ratio_ranges import with_ranges
from workflows.report_data import read_json
from workflows.report_units import value_and_range
from workflows.state_files import read_checked

HASHED = (names.INSTALLED, names.HANDED_OFF, names.SERVICE, names.WISHED_SERVICE, names.CURVES)


def run(case: AnyCase, directory: Path, _advance: Advance = no_progress) -> list[str]:
    """Write the curves of both models and the summary.

    Raises
    ------
    StateFileError, DirectoryError
        If a file is missing or damaged, or belongs to another case.
    """
    installed: InstalledState = read_checked(directory, names.INSTALLED, case)
    service: ServiceResult = read_checked(directory, names.SERVICE, case)
    wished: ServiceResult = read_checked(directory, names.WISHED_SERVICE, case)
    write_text(directory / names.CURVES, curves_csv([service, wished]))
    write_text(directory / names.WISHED_CURVES, curves_csv([wished]))
    results = headline(case, installed, service, wished)
    if case.comparison is not None:
        repeated = read_json(directory / names.REPEATED, "screwpile repeat")
        results = with_ranges(results, repeated)
    summary = {
        "title": case.title,
        "results": results,
        "certificate": _certificate(directory),
        "convergence": convergence(installed, [service, wished]),
        "seeds": {"numerics.random_seed": case.numerics.random_seed},
        "case_sha256": case_hash(case_text(case)),
        "files_sha256": {
            name: file_hash(directory / name) for name in HASHED if (directory / name).exists()
        },
        "versions": software_versions(),
        "timings_s": {
            name: record.seconds for name, record in read_manifest(directory).stages.items()
        },
    }
    write_text(directory / names.SUMMARY, json.dumps(summary, indent=2) + "\n")
    return _remarks(results)


def _certificate(directory: Path) -> dict[str, float]:
    """Return the figures of the certificate, values only."""
    path = directory / names.CERTIFICATE
    try:
        figures = json.loads(path.read_text(encoding="utf-8"))
        return {name: figure["value"] for name, figure in figures.items()}
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise DirectoryError(
            f"{path} cannot be read ({error}); run `screwpile handoff` again"
        ) from error


def _remarks(results: dict[str, dict[str, dict[str, dict[str, float]]]]) -> list[str]:
    """Return one line for each programme that has ratios."""
    lines = []
    for name, figures in results["service"].items():
        ratios = {key: value for key, value in figures.get("ratio", {}).items() if value}
        found = figures.get("ratio_range", {})
        if ratios:
            shown = ", ".join(
                f"{key} {value_and_range(value, found.get(key))}" for key, value in ratios.items()
            )
            lines.append(f"{name}, installed over wished in place: {shown}")
    return lines


if __name__ == "__main__":
    from workflows.cli import compare as command
    from workflows.script import run_script

    run_script(command)
