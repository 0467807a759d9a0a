"""Runs the paper's demonstrations as their cases describe them and writes their pictures.

python -m workflows.verification.paper_figures [DIRECTORY]
"""

from __future__ import annotations

import sys
from pathlib import Path

from workflows.environment import prepare
from workflows.report_style import png_of, styled
from workflows.verification.runner import Run, Verified, run_problem
from workflows.verification_case import read_problem_case
from workflows.verification_report import draw

CASES = Path("cases/paper")
DIRECTORY = Path("docs/images/paper")


def cases(folder: Path = CASES) -> list[Run]:
    """Return what the case files of the paper describe, by name."""
    return [read_problem_case(path) for path in sorted(folder.glob("*.toml"))]


def write_pictures(name: str, result: Verified, directory: Path) -> list[Path]:
    """Write the curves and the states of a result into ``directory``; return the files.

    Raises
    ------
    ValueError
        If the problem was not solved.
    """
    if result.outcome is None:
        raise ValueError(f"{name}: not solved: {result.failure}")
    directory.mkdir(parents=True, exist_ok=True)
    figures = {name: draw(result.outcome.series)} if result.outcome.series else {}
    with styled():
        figures |= {f"{name}-{one.name}": one.draw() for one in result.outcome.pictures}
        files = {directory / f"{file}.png": figure for file, figure in figures.items()}
        for path, figure in files.items():
            path.write_bytes(png_of(figure))
    return list(files)


def main() -> None:
    """Write the pictures of all cases."""
    directory = Path(sys.argv[1]) if len(sys.argv) > 1 else DIRECTORY
    prepare()
    for run in cases():
        write_pictures(run.name, run_problem(run.problem, run.values), directory)


if __name__ == "__main__":
    main()
