"""The state files of a results directory: how each is read, which keys of the case decide it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from workflows import directory as names
from workflows.case import AnyCase
from workflows.directory import case_of, check_belongs
from workflows.manifest import file_hash, read_manifest


@dataclass(frozen=True)
class StateFile:
    """One kind of state file."""

    reader: tuple[str, str]
    """Module and function that reads it and refuses a damaged one."""
    keys: tuple[str, ...]
    """Keys of the case that its content depends on."""

    def read(self, path: Path) -> Any:
        """Return the record in the file."""
        module, function = self.reader
        read: Callable[[Path], Any] = getattr(import_module(module), function)
        return read(path)


READ_INSTALLED = ("install_mpm.state_file", "read_installed_state")
READ_HANDED_OFF = ("handoff.fe_state_file", "read_handed_off_state")
READ_SERVICE = ("service_fe.result_file", "read_service_result")

STATE_FILES = {
    names.CHECKPOINT: StateFile(READ_INSTALLED, names.INSTALL_KEYS),
    names.INSTALLED: StateFile(READ_INSTALLED, names.INSTALL_KEYS),
    names.HANDED_OFF: StateFile(READ_HANDED_OFF, names.HANDOFF_KEYS),
    names.SERVICE: StateFile(READ_SERVICE, names.SERVICE_KEYS),
    names.WISHED_SERVICE: StateFile(READ_SERVICE, names.WISHED_KEYS),
}


def read_checked(directory: Path, name: str, case: AnyCase) -> Any:
    """Return the record in a state file of ``directory`` that belongs to ``case``.

    Raises
    ------
    StateFileError, DirectoryError
        If the file is missing or damaged, or belongs to another case.
    """
    state_file = STATE_FILES[name]
    record = state_file.read(directory / name)
    check_belongs(directory / name, record.case_text, case, state_file.keys)
    return record


def case_for(directory: Path, name: str) -> AnyCase:
    """Return the case of a stage that starts from the state file ``name`` of ``directory``.

    It is ``case.toml`` of the directory if there is one, else the case that the file carries.

    Raises
    ------
    StateFileError, DirectoryError
        If the file is missing or damaged, or the case cannot be read.
    """
    text = STATE_FILES[name].read(directory / name).case_text
    return case_of(directory) or names.case_in_file(directory / name, text)


def check_existing(directory: Path, case: AnyCase) -> None:
    """Check the state files in ``directory`` that are not those which screwpile wrote there.

    Raises
    ------
    StateFileError, DirectoryError
        If such a file is damaged or belongs to another case: it would otherwise be overwritten.
    """
    recorded: dict[str, str] = {}
    for stage in read_manifest(directory).stages.values():
        recorded |= stage.outputs
    for name in STATE_FILES:
        path = directory / name
        if name != names.CHECKPOINT and path.exists() and recorded.get(name) != file_hash(path):
            read_checked(directory, name, case)
