"""``screwpile verify``: chooses reference problems, runs them and shows the results."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text

from workflows.errors import CaseError
from workflows.progress import Reporter
from workflows.verification import registry
from workflows.verification.parameters import parameters_of, read_assignments
from workflows.verification.problem import Problem
from workflows.verification.runner import Run, Verified, run_problem, run_problems
from workflows.verification_case import SUFFIX, read_problem_case
from workflows.verification_kept import KeptResults
from workflows.verification_numbers import HEADINGS, cells, count_text, inputs_text

WIDTH = 110
"""Columns where the output is no terminal."""

STYLES = {True: "green", False: "bold red"}


def console() -> Console:
    """Return the console of the command."""
    is_terminal = sys.stdout.isatty()
    return Console(highlight=False, width=None if is_terminal else WIDTH)


def choose(identifiers: Sequence[str], is_quick: bool) -> list[Problem]:
    """Return the problems that are named, all if none is; of these the quick ones if asked for.

    Of all problems those are left out whose reference is a package that is not installed.

    Raises
    ------
    CaseError
        If a name is unknown, or none is left.
    """
    named = [registry.problem(name) for name in dict.fromkeys(identifiers)]
    available = [problem for problem in registry.problems().values() if problem.is_available]
    chosen = list({problem.identifier: problem for problem in named or available}.values())
    chosen = [problem for problem in chosen if problem.is_quick or not is_quick]
    if not chosen:
        names = ", ".join(problem.identifier for problem in named)
        raise CaseError(f"none of {names} is a quick problem; leave out --quick")
    return chosen


def _require_packages(runs: Iterable[Run]) -> None:
    for problem in (run.problem for run in runs):
        if not problem.is_available:
            raise CaseError(
                f"{problem.identifier} needs the package {problem.needs}; install the extra that "
                f"brings it, see [project.optional-dependencies] of pyproject.toml"
            )


def runs_of(arguments: Sequence[str], is_quick: bool) -> list[Run]:
    """Return what the arguments name: problems, and case files (``.toml``) that describe one.

    Raises
    ------
    CaseError
        If a problem or a file is unknown, or a file is no case of a problem.
    """
    cases = [read_problem_case(Path(text)) for text in arguments if text.endswith(SUFFIX)]
    names = [text for text in arguments if not text.endswith(SUFFIX)]
    if cases and is_quick:
        raise CaseError("--quick chooses among problems; leave it out with case files")
    problems = choose(names, is_quick) if names or not cases else []
    return cases + [Run(problem, {}, problem.identifier, problem.title) for problem in problems]


def verify_problems(
    arguments: Iterable[str],
    overrides: Iterable[str],
    is_quick: bool,
    files: Iterable[Path | None],
    kept: Path | None = None,
) -> list[Verified]:
    """Run the problems that the command line names and return their results.

    ``arguments`` are identifiers or case files, and assignments that follow the first one of
    ``--set``; ``files`` are to be written later.  Results are kept in the folder ``kept`` and taken
    from it.

    Raises
    ------
    CaseError
        If a problem or a parameter is unknown, a value does not suit, a package is missing, or a
        file cannot be written or read.
    """
    arguments, assignments = list(arguments), list(overrides)
    assignments += [text for text in arguments if "=" in text]
    chosen = runs_of([text for text in arguments if "=" not in text], is_quick)
    if assignments and len(chosen) != 1:
        raise CaseError("--set changes one problem; name it, e.g. screwpile verify PA7 --set b=2")
    if assignments:
        values = read_assignments(chosen[0].problem, assignments)
        chosen = [replace(chosen[0], values={**chosen[0].values, **values})]
    _require_packages(chosen)
    for file in files:
        if file is not None:
            _make_folder(file)
    solve = run_problem if kept is None else _kept_results(kept).solve
    reporter = Reporter(console())
    doing = f"{len(chosen)} reference problem{'s' if len(chosen) > 1 else ''}"
    with reporter.stage("verify", doing) as advance:
        results = run_problems(
            chosen, advance, lambda result: print_result(result, reporter.console), solve
        )
    reporter.say(count_text(results))
    return results


def _make_folder(file: Path) -> None:
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise CaseError(f"{file} cannot be written: {error.strerror}") from error
    if file.is_dir():
        raise CaseError(f"{file} is a folder; name a file")


def _kept_results(folder: Path) -> KeptResults:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise CaseError(f"{folder} cannot be made a folder: {error.strerror}") from error
    return KeptResults(folder)


def print_result(result: Verified, console: Console) -> None:
    """Print inputs, checks and convergence of one problem."""
    verdict = "met" if result.is_met else "FAILED"
    console.print(
        Text.assemble(
            (f"{result.name}  {result.title}: ", "bold"),
            (verdict, STYLES[result.is_met]),
            f"  ({result.seconds:.1f} s{', kept' if result.is_kept else ''})",
        )
    )
    console.print(Text(f"with {inputs_text(result)}"), soft_wrap=True)
    if result.outcome is None:
        console.print(Text(f"not solved: {result.failure}", STYLES[False]), soft_wrap=True)
    else:
        console.print(_table(result))
        if result.newton is not None:
            console.print(f"Newton: {result.newton.text}", soft_wrap=True)
        for remark in result.outcome.remarks:
            console.print(Text(remark), soft_wrap=True)
    console.print()


def _table(result: Verified) -> Table:
    table = Table(box=None, pad_edge=False)
    for heading in HEADINGS:
        is_number = heading not in ("quantity", "")
        table.add_column(
            heading, justify="right" if is_number else "left", no_wrap=heading != "quantity"
        )
    for check in result.checks:
        *texts, verdict = cells(check)
        table.add_row(*map(Text, texts), Text(verdict, STYLES[check.is_met]))
    return table


def write_results(
    results: list[Verified], report_file: Path | None, json_file: Path | None
) -> None:
    """Write the page and the numbers, as far as files are named."""
    if json_file is not None:
        from workflows.verification_json import write_json

        write_json(results, json_file)
    if report_file is not None:
        from workflows.verification_report import write_report

        write_report(results, report_file)


def print_list() -> None:
    """Print all problems with their parameters and defaults."""
    out = console()
    for problem in registry.problems().values():
        mark = "  (quick)" if problem.is_quick else ""
        mark += f"  (needs {problem.needs})" if problem.needs else ""
        out.print(Text.assemble((problem.identifier, "bold"), f"  {problem.title}{mark}"))
        inputs = (f"{one.name} = {one.format(one.default)}"
                  for one in parameters_of(problem).values())  # fmt: skip
        out.print(Text("    " + ", ".join(inputs)), soft_wrap=True)
