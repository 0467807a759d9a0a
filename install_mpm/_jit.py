"""The project's only use of numba's decorator: compile flags and the folder of compiled code.

numba's disk cache looks at the file of the cached function alone. After an edit to a compiled
function that is called from *another* file, it would go on returning results of the old code. All
compiled code is therefore kept in a folder whose name is a hash of every source file that kernels
are made of; an edit to any of them starts a new folder. Folders that were not used for 30 days are
removed.

What reaches a kernel as a constant has to stand in a hashed file as well: in a file that imports
this module, in `conventions.py`, or in `constitutive/` or `kernels/`. `tests/contract` checks this.

The folder is ``screwpile/numba/<hash>`` in the user's cache folder (``XDG_CACHE_HOME``, else
``~/.cache``), or ``<hash>`` in ``NUMBA_CACHE_DIR`` where that is set. ``NUMBA_DISABLE_JIT=1`` runs
the kernels as plain Python.
"""

import hashlib
import os
import platform
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import llvmlite.binding
import numba
from numba import prange

__all__ = ["cache_folder", "jit", "kernel_sources", "parallel_jit", "prange", "source_hash"]

Function = TypeVar("Function", bound=Callable[..., Any])

UNUSED_FOLDERS_KEPT = 30 * 24 * 3600.0  # s

# No fastmath: it lets sums be reordered, and results would depend on the machine's vector width.
# error_model "numpy": a division by zero gives inf or nan, as in numpy; kernels test for it.
OPTIONS = {"nogil": True, "error_model": "numpy"}


def kernel_sources(root: Path) -> list[Path]:
    """Return the source files below `root` whose text decides what the compiled code does."""
    fixed = [root / "install_mpm" / "conventions.py"]
    fixed += (root / "install_mpm" / "constitutive").glob("*.py")
    fixed += (root / "install_mpm" / "kernels").glob("*.py")
    users = [
        file
        for package in ("install_mpm", "handoff", "service_fe")
        for file in (root / package).glob("*.py")
        if b"_jit" in file.read_bytes()
    ]
    return sorted({file for file in [*fixed, *users] if file.is_file()})


def source_hash(root: Path) -> str:
    """Return a hash of all kernel sources below `root`, of numba, Python and the processor."""
    digest = hashlib.sha256()
    machine = (platform.python_version(), platform.machine(), llvmlite.binding.get_host_cpu_name())
    digest.update(repr((numba.__version__, *machine)).encode())
    for file in kernel_sources(root):
        text = file.read_bytes()
        digest.update(f"{file.relative_to(root).as_posix()} {len(text)}\n".encode())
        digest.update(text)
    return digest.hexdigest()[:32]


def _base_folder() -> Path:
    if folder := os.environ.get("NUMBA_CACHE_DIR"):
        return Path(folder)
    home = os.environ.get("XDG_CACHE_HOME")
    return (Path(home) if home else Path.home() / ".cache") / "screwpile" / "numba"


def _prepared_folder() -> Path | None:
    """Return the folder for compiled code, or None where it cannot be written."""
    try:
        base = _base_folder()
        folder = base / source_hash(Path(__file__).resolve().parent.parent)
        is_new = not folder.is_dir()
        folder.mkdir(parents=True, exist_ok=True)
        os.utime(folder)
        if is_new:
            _remove_unused_folders(base)
    except (OSError, RuntimeError):  # read-only cache folder; no home folder
        return None
    return folder if os.access(folder, os.W_OK) else None


def _remove_unused_folders(base: Path) -> None:
    """Remove the hash folders in `base` that no process has started with for 30 days."""
    oldest = time.time() - UNUSED_FOLDERS_KEPT
    for folder in base.iterdir():
        has_hash_name = len(folder.name) == 32 and set(folder.name) <= set("0123456789abcdef")
        if has_hash_name and folder.is_dir() and folder.stat().st_mtime < oldest:
            shutil.rmtree(folder, ignore_errors=True)


_FOLDER = _prepared_folder()


def cache_folder() -> Path | None:
    """Return the folder in which this process keeps compiled code; None if it keeps none."""
    return _FOLDER


def _compiled(function: Function, **options: bool) -> Function:
    """Return `function`, to be compiled at its first call and kept in the cache folder."""
    # numba chooses the folder while it decorates, and forgets a folder set earlier when a NUMBA_*
    # variable changes: so set it here, for each function, and leave other users of numba theirs.
    before = numba.config.CACHE_DIR
    if _FOLDER is not None:
        numba.config.CACHE_DIR = str(_FOLDER)
    try:
        decorated: Function = numba.njit(cache=_FOLDER is not None, **OPTIONS, **options)(function)
    finally:
        numba.config.CACHE_DIR = before
    return decorated


def jit(function: Function) -> Function:
    """Return `function` compiled; to be used as a bare decorator."""
    return _compiled(function)


def parallel_jit(function: Function) -> Function:
    """Return `function` compiled, with `prange` loops shared among threads.

    A parallel loop must write to disjoint parts of its outputs, so that results do not depend on
    the number of threads.
    """
    return _compiled(function, parallel=True)
