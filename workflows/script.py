"""How every command ends: with status 2 and one sentence after an error that the user can mend."""

from __future__ import annotations

import sys
from collections.abc import Callable

import typer

from workflows.environment import prepare
from workflows.ranks import end_after, n_ranks

USER_ERROR = 2
"""Exit status after an error that the user can mend."""

CRASHED = 1
"""Exit status after an error that is not the user's."""

INTERRUPTED = 130
"""Exit status after Ctrl-C."""

USER_ERRORS = {
    "workflows.errors.CaseError",
    "workflows.errors.DirectoryError",
    "install_mpm.record.StateFileError",
    "install_mpm.installation.NotConvergedError",
    "handoff.gmsh_triangles.MeshError",
    "handoff.equilibration.EquilibrationError",
    "service_fe.solve.ServiceError",
}
"""Errors of the stages that are one sentence for the user; by name, to import no stage for them."""


def is_user_error(error: Exception) -> bool:
    """Return whether ``error`` is one that a stage documents, with a message for the user."""
    kinds = {f"{kind.__module__}.{kind.__qualname__}" for kind in type(error).__mro__}
    return bool(kinds & USER_ERRORS)


def run_script(command: Callable[..., None]) -> None:
    """Run one command as a script of its own, e.g. ``python -m workflows.stages.install``."""
    script = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
    script.command()(command)
    prepare()
    run_as_command(script)


def run_as_command(command: typer.Typer) -> None:
    """Run ``command``; exit with status 2 and one sentence after a user error."""
    try:
        command()
    except SystemExit as end:  # typer turns Ctrl-C into this status
        if end.code == INTERRUPTED:
            print("screwpile: stopped", file=sys.stderr)
        raise
    except Exception as error:
        if is_user_error(error):
            end_after(error, f"screwpile: {' '.join(str(error).split())}", USER_ERROR)
        if n_ranks() > 1:
            end_after(error, None, CRASHED)
        raise
