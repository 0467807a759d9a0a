"""State files carry the checksum of their content, so that a damaged one is refused at once.

It stands in the user block, which HDF5 leaves to programs before its own first byte; other readers
of HDF5 do not see it.  A library that parses damaged bytes may raise anything, or crash.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from install_mpm.record import StateFileError

USER_BLOCK = 512
"""Size of the user block in bytes, the smallest that HDF5 has."""

MARK = b"screwpile state file, sha256 of the rest: "

REMEDY = "write it again with the stage that makes it"


@contextmanager
def new_state_file(path: Path) -> Iterator[h5py.File]:
    """Open a new HDF5 file that becomes ``path`` when it is complete, to be used with ``with``.

    A reader sees the old file or the whole new one.
    """
    partial = path.with_suffix(path.suffix + ".partial")
    with h5py.File(partial, "w", userblock_size=USER_BLOCK) as file:
        yield file
    seal(partial)
    partial.replace(path)


def seal(path: Path) -> None:
    """Write the checksum of a file with a user block into it."""
    with path.open("r+b") as file:
        file.seek(USER_BLOCK)
        checksum = hashlib.sha256(file.read()).hexdigest()
        file.seek(0)
        file.write((MARK + checksum.encode()).ljust(USER_BLOCK, b"\0"))


@contextmanager
def open_state_file(path: Path) -> Iterator[h5py.File]:
    """Open an HDF5 state file for reading, to be used with ``with``.

    A file without a checksum, from an earlier version, is read as it is.  Whatever the library
    raises while the file is open becomes one error.

    Raises
    ------
    StateFileError
        If it does not exist, is truncated or damaged, or is no HDF5 file.
    """
    if not path.exists():
        raise StateFileError(f"{path}: no such file; run the stage that writes it first")
    try:
        _check_seal(path)
        file = h5py.File(path, "r")
    except OSError as error:
        raise StateFileError(
            f"{path}: truncated or not an HDF5 file ({error}); {REMEDY}"
        ) from error
    try:
        with file:
            yield file
    except StateFileError:
        raise
    except Exception as error:  # the library has many kinds
        kind = type(error).__name__
        raise StateFileError(f"{path}: damaged ({kind}: {error}); {REMEDY}") from error


def _check_seal(path: Path) -> None:
    with path.open("rb") as file:
        block = file.read(USER_BLOCK)
        if not block.startswith(MARK):
            return
        checksum = hashlib.sha256(file.read()).hexdigest()
    if block[len(MARK) :].rstrip(b"\0") != checksum.encode():
        raise StateFileError(
            f"{path}: damaged, truncated or not an HDF5 file as written: "
            f"its content does not match its checksum; {REMEDY}"
        )
