"""The command line ``screwpile``: run, its stages one by one, check, template, verify.

Modules that take long to load are imported inside the commands, so that others answer at once.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from workflows.environment import prepare
from workflows.script import run_as_command

if TYPE_CHECKING:
    from workflows.case import AnyCase

NOT_MET = 1
"""Exit status after a reference problem that is not within its tolerance."""

app = typer.Typer(
    help="Install a pile with the material point method, hand the ground over, load it in service.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

CaseFile = Annotated[Path, typer.Argument(metavar="CASE", help="Case file (TOML).")]
Results = Annotated[Path, typer.Argument(metavar="DIR", help="Results directory.")]
Output = Annotated[
    Path | None,
    typer.Option("--output", "-o", metavar="DIR", help="Results directory [default: out/CASE]."),
]
Overrides = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a value, e.g. pile.embedment='5 m'."),
]
Resume = Annotated[
    bool, typer.Option("--resume", help="Continue an interrupted installation from its checkpoint.")
]

Accept = Annotated[
    bool,
    typer.Option("--accept-uncertified", help="Load the pile though the certificate has failed."),
]


@app.command()
def run(
    case: CaseFile,
    output: Output = None,
    overrides: Overrides = None,
    resume: Resume = False,
    accept: Accept = False,
) -> None:
    """Run all stages; those whose inputs did not change are skipped."""
    from workflows.runner import run_case

    loaded, directory = _load(case, output, overrides)
    with _resumable(directory):
        run_case(loaded, directory, resume=resume, accept_uncertified=accept)


@app.command()
def install(
    case: CaseFile, output: Output = None, overrides: Overrides = None, resume: Resume = False
) -> None:
    """Stage 1: jack the pile into the ground; writes installed.h5."""
    from workflows.runner import run_from_case

    loaded, directory = _load(case, output, overrides)
    with _resumable(directory):
        run_from_case("install", loaded, directory, resume=resume)


@app.command()
def handoff(directory: Results) -> None:
    """Stage 2: from installed.h5; writes handed_off.h5 and certificate.json."""
    from workflows.runner import run_from_files

    run_from_files("hand_off", directory)


@app.command()
def serve(directory: Results, accept: Accept = False) -> None:
    """Stage 3: load the pile in service, from handed_off.h5; writes service.h5."""
    from workflows.runner import run_from_files

    run_from_files("serve", directory, accept_uncertified=accept)


@app.command()
def wished(case: CaseFile, output: Output = None, overrides: Overrides = None) -> None:
    """Load the same pile wished in place; writes wished_in_place/."""
    from workflows.runner import run_from_case

    loaded, directory = _load(case, output, overrides)
    run_from_case("wished", loaded, directory)


@app.command()
def repeat(directory: Results) -> None:
    """Repeat hand-over and service on a second mesh and with a second transfer."""
    from workflows.runner import run_from_files

    run_from_files("repeat", directory)


@app.command()
def compare(directory: Results) -> None:
    """Compare installed and wished in place; writes curves.csv and summary.json."""
    from workflows.runner import run_from_files

    run_from_files("compare", directory)


@app.command()
def report(directory: Results) -> None:
    """Write report.html, a self-contained page, from the results."""
    from workflows.runner import run_from_files

    run_from_files("report", directory)


@app.command()
def export(directory: Results) -> None:
    """Write the results for ParaView into paraview/."""
    from workflows.runner import run_from_files

    run_from_files("export", directory)


@app.command()
def check(
    case: CaseFile,
    overrides: Overrides = None,
    plot: Annotated[
        Path | None,
        typer.Option("--plot", metavar="FILE.png", help="Draw the mesh around a screw pile."),
    ] = None,
) -> None:
    """Validate a case and forecast its size and time."""
    from workflows.case import CaseError, read_case
    from workflows.forecast import forecast, print_forecast
    from workflows.screw_case import ScrewCase

    loaded, _ = read_case(case, overrides or ())
    if isinstance(loaded, ScrewCase):
        from workflows.screw_forecast import print_screw_forecast, screw_forecast

        print_screw_forecast(loaded, screw_forecast(loaded))
        if plot is not None:
            from workflows.screw_pictures import write_mesh_picture

            write_mesh_picture(plot, loaded)
        return
    if plot is not None:
        raise CaseError(f"{case}: --plot draws the mesh of a screw pile only; leave it out")
    print_forecast(loaded, forecast(loaded))


@app.command()
def template(
    soil: Annotated[
        str | None,
        typer.Option("--soil", metavar="LAW", help="A soil law only, with typical values."),
    ] = None,
) -> None:
    """Print a commented case file, or the parameters of a soil law."""
    if soil is None:
        from workflows.template import template_text

        sys.stdout.write(template_text())
        return
    from workflows.soil_template import soil_template_text

    sys.stdout.write(soil_template_text(soil))


@app.command("element-test")
def element_test(
    source: Annotated[
        str, typer.Argument(metavar="CASE|LAW", help="Case, a file of its ground, or a soil law.")
    ],
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Where tables and pictures go.")
    ],
    layer: Annotated[
        str | None, typer.Option("--soil", metavar="LAYER", help="Layer; the first by default.")
    ] = None,
    tests: Annotated[
        list[str] | None, typer.Option("--test", metavar="NAME", help="Test; all by default.")
    ] = None,
    pressures: Annotated[
        list[str] | None,
        typer.Option("--pressure", metavar="STRESS", help="Cell pressure or vertical stress."),
    ] = None,
    strain: Annotated[
        float | None, typer.Option("--strain", help="Largest axial or shear strain.")
    ] = None,
    overrides: Overrides = None,
) -> None:
    """Drive a soil through laboratory tests; writes tables (CSV) and pictures."""
    from workflows.element_tests.command import run

    print(run(source, output, layer, tests or (), pressures or (), strain, overrides or ()), end="")


@app.command()
def verify(
    problems: Annotated[
        list[str] | None,
        typer.Argument(metavar="[ID | CASE]...", help="Problems or case files; all if none."),
    ] = None,
    overrides: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE...", help="Change values of one problem."),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Only those that take seconds.")] = False,
    report_file: Annotated[
        Path | None, typer.Option("--report", metavar="FILE", help="Write a page (Markdown).")
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Write all numbers (JSON).")
    ] = None,
    kept: Annotated[
        Path | None,
        typer.Option("--keep", metavar="DIR", help="Keep results in DIR; reuse those there."),
    ] = None,
    is_listed: Annotated[
        bool, typer.Option("--list", help="Print the problems and their parameters.")
    ] = False,
) -> None:
    """Run reference problems; exit status 1 if one is not within its tolerance."""
    from workflows.verification_console import print_list, verify_problems, write_results

    if is_listed:
        print_list()
        return
    files = (report_file, json_file)
    results = verify_problems(problems or (), overrides or (), quick, files, kept)
    write_results(results, *files)
    if not all(result.is_met for result in results):
        raise typer.Exit(NOT_MET)


def _load(path: Path, output: Path | None, overrides: list[str] | None) -> tuple[AnyCase, Path]:
    from workflows.case import read_case

    case, _ = read_case(path, overrides or ())
    return case, output or Path("out") / path.stem


@contextmanager
def _resumable(directory: Path) -> Iterator[None]:
    """Say after Ctrl-C that the installation can go on, if it has left a checkpoint."""
    from workflows.directory import CHECKPOINT

    try:
        yield
    except KeyboardInterrupt:
        if (directory / CHECKPOINT).exists():
            print("screwpile: --resume continues the installation", file=sys.stderr)
        raise


def main() -> None:
    """Run the command line."""
    prepare()
    run_as_command(app)


if __name__ == "__main__":
    main()
