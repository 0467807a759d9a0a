"""Stages that several ranks of MPI run together, started with ``mpirun -n N screwpile ...``.

Every rank runs the same commands; the first alone writes files and speaks.  Without ``mpirun`` MPI
is not loaded here.
"""

from __future__ import annotations

import os
import sys
import time
import traceback
from collections.abc import Callable
from typing import TYPE_CHECKING, NoReturn, TypeVar

from workflows.errors import CaseError

if TYPE_CHECKING:
    from mpi4py import MPI

SIZE_VARIABLES = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE")
"""Where Open MPI and MPICH tell the number of ranks."""

PATIENCE = 10.0
"""Seconds that a rank with an error waits for the others to have the same one."""

PARALLEL = ("hand_off", "serve", "wished")
"""Stages that several ranks can run together."""

T = TypeVar("T")


def n_ranks() -> int:
    """Return the number of ranks, 1 without ``mpirun``."""
    return max(int(os.environ.get(name, 1)) for name in SIZE_VARIABLES)


def is_first() -> bool:
    """Return whether this rank writes files and speaks."""
    return n_ranks() == 1 or _all_ranks().Get_rank() == 0


def check_ranks(stage: str, command: str) -> None:
    """Check that ``stage``, run by ``command``, can run on as many ranks as there are.

    Raises
    ------
    CaseError
        If it runs on one only.
    """
    if n_ranks() > 1 and stage not in PARALLEL:
        raise CaseError(
            f"`{command}` runs on one rank; start it without mpirun, which is for"
            " `screwpile handoff`, `screwpile serve` and `screwpile wished`"
        )


def on_first(make: Callable[[], T]) -> T:
    """Return what ``make`` returns, called by the first rank alone; its error is raised on all."""
    if n_ranks() == 1:
        return make()
    made: tuple[T | None, Exception | None] = (None, None)
    if is_first():
        try:
            made = (make(), None)
        except Exception as error:
            made = (None, error)
    value, failure = _all_ranks().bcast(made)
    if failure is not None:
        raise failure
    result: T = value
    return result


def end_after(error: Exception, sentence: str | None, status: int) -> NoReturn:
    """Say what is wrong once, and end all ranks with ``status``.

    A ``sentence`` that all ranks have to say is said by the first.  If this rank alone has it, or
    there is none because the ``error`` is not the user's, the others are ended where they are.
    """
    if n_ranks() > 1 and (sentence is None or not _all_have_come()):
        if sentence is None:
            traceback.print_exception(error)
        else:
            print(sentence, file=sys.stderr, flush=True)
        _all_ranks().Abort(status)
    if sentence is not None and is_first():
        print(sentence, file=sys.stderr)
    sys.exit(status)


def _all_have_come() -> bool:
    """Return whether all ranks call this within ``PATIENCE``."""
    request, end = _all_ranks().Ibarrier(), time.monotonic() + PATIENCE
    while not request.Test():
        if time.monotonic() > end:
            return False
        time.sleep(0.01)
    return True


def _all_ranks() -> MPI.Intracomm:
    from mpi4py import MPI

    return MPI.COMM_WORLD
