"""Environment of every run (as script/environment), set before numpy, numba or MPI are loaded."""

from __future__ import annotations

import os
import platform

MOST_NUMBA_THREADS = 2
MPI_TRANSPORT = {"12": "self,vader", "13": "self,sm"}
"""Shared memory of Open MPI 4 and 5 by release of Debian; probing networks fails in containers."""


def prepare() -> None:
    """Set the variables that are not set yet; a value that the user chose is kept.

    One thread each for BLAS and MUMPS: at the sizes of this project more cost more than they give,
    and a fixed number keeps results repeatable.  numba has its own threads.
    """
    threads = min(MOST_NUMBA_THREADS, len(os.sched_getaffinity(0)))
    defaults = {
        "OMP_NUM_THREADS": "1",
        "NUMBA_NUM_THREADS": str(threads),
        "OMPI_ALLOW_RUN_AS_ROOT": "1",
        "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
        "HWLOC_HIDE_ERRORS": "2",  # it reports a missing /sys of containers, which is harmless
        "MPLBACKEND": "Agg",
    }
    transport = MPI_TRANSPORT.get(_debian_release())
    if transport is not None:
        defaults["OMPI_MCA_btl"] = transport
    for name, value in defaults.items():
        os.environ.setdefault(name, value)


def _debian_release() -> str:
    """Return the release of Debian, "" on other systems."""
    try:
        release = platform.freedesktop_os_release()
    except OSError:
        return ""
    return release.get("VERSION_ID", "") if release.get("ID") == "debian" else ""
