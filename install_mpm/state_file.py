"""The installed state: what stage 1 hands to the rest, and its HDF5 file."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import h5py
import numpy as np

from install_mpm.background_mesh import BackgroundMesh
from install_mpm.conventions import Kinematics, conventions_hash
from install_mpm.history import History
from install_mpm.interface import InterfacePoints
from install_mpm.material_points import MaterialPoints
from install_mpm.record import Field, StateFileError, read_record, write_record
from install_mpm.screw_history import ScrewHistory
from install_mpm.seal import new_state_file, open_state_file

FORMAT = "screwpile-installed-state"
VERSION = 1


class PileState(NamedTuple):
    """Where the rigid pile is and what the soil does to it."""

    penetration: Annotated[np.ndarray, Field((), "m", "advance since the start, positive downward")]
    rotation: Annotated[np.ndarray, Field((), "rad", "right-handed about +z since the start")]
    tip_depth: Annotated[np.ndarray, Field((), "m", "depth of the tip below the original surface")]
    reaction: Annotated[
        np.ndarray, Field(("dim",), "N", "force of the soil on the modelled half of the pile")
    ]


STEPS_BEFORE_GROWTH = 4
"""Steps that must converge after a cut before the step is doubled again, if that succeeds."""


class StepControl(NamedTuple):
    """Step-size control and warm start: what a resumed run needs to go on bit-equal."""

    step: Annotated[np.ndarray, Field((), "m", "current size of a load step")]
    cuts: Annotated[np.ndarray, Field((), "", "halvings since the last accepted step", "int64")]
    steps_since_cut: Annotated[
        np.ndarray, Field((), "", "accepted steps since the size changed", "int64")
    ]
    steps_before_growth: Annotated[
        np.ndarray, Field((), "", "steps to be accepted before the size grows again", "int64",
                          default=STEPS_BEFORE_GROWTH)
    ]  # fmt: skip
    displacement_per_step: Annotated[
        np.ndarray, Field(("node", "dim"), "m", "first trial displacement of the next step")
    ]


class InstalledState(NamedTuple):
    """Everything stage 1 knows at the end of a step; also the content of a checkpoint."""

    material_points: MaterialPoints
    background_mesh: BackgroundMesh
    interface: InterfacePoints
    pile: PileState
    history: Any
    """``History``, in three dimensions ``ScrewHistory``."""
    control: StepControl
    case_text: str
    kinematics: Kinematics


RECORDS: dict[str, type] = {
    "material_points": MaterialPoints,
    "background_mesh": BackgroundMesh,
    "interface": InterfacePoints,
    "pile": PileState,
    "history": History,
    "control": StepControl,
}
"""Groups of the file; in three dimensions the history is a ``ScrewHistory``."""


def records_of(kinematics: Kinematics) -> dict[str, type]:
    """Return the record type of each group of a state file."""
    if kinematics == Kinematics.THREE_D:
        return RECORDS | {"history": ScrewHistory}
    return RECORDS


def case_hash(case_text: str) -> str:
    """Return the hash by which later stages recognise the case that a file belongs to."""
    return hashlib.sha256(case_text.encode()).hexdigest()


def write_header(
    file: h5py.File, file_format: str, version: int, case_text: str, created_by: str
) -> None:
    """Write the root attributes and the case that every state file carries."""
    file.attrs["format"] = file_format
    file.attrs["version"] = version
    file.attrs["created_by"] = created_by
    file.attrs["case_sha256"] = case_hash(case_text)
    file.attrs["conventions"] = conventions_hash()
    file.create_group("case").attrs["toml"] = case_text


def read_header(file: h5py.File, file_format: str, version: int) -> str:
    """Check the root attributes and return the case text.

    Raises
    ------
    StateFileError
        If the file is of another format, version or convention, or its case does not match its
        hash.
    """
    path, remedy = file.filename, "write it again with this version of screwpile"
    found = file.attrs.get("format")
    if found != file_format:
        raise StateFileError(
            f"{path}: attribute format is {found!r}, expected {file_format!r}; give the right file"
        )
    if file.attrs.get("version") != version:
        raise StateFileError(
            f"{path}: version {file.attrs.get('version')} of {file_format} "
            f"is not version {version}; {remedy}"
        )
    if file.attrs.get("conventions") != conventions_hash():
        raise StateFileError(f"{path}: written under other conventions of sign or axes; {remedy}")
    case_text = file["case"].attrs.get("toml") if "case" in file else None
    if not isinstance(case_text, str) or case_hash(case_text) != file.attrs.get("case_sha256"):
        raise StateFileError(f"{path}: group /case is missing or does not match its hash; {remedy}")
    return case_text


def write_installed_state(path: Path, state: InstalledState, created_by: str) -> None:
    """Write the state to ``path`` atomically: a reader sees the old file or the whole new one."""
    with new_state_file(path) as file:
        write_header(file, FORMAT, VERSION, state.case_text, created_by)
        file.attrs["kinematics"] = state.kinematics.name
        for name in RECORDS:
            write_record(file.create_group(name), getattr(state, name))


def read_installed_state(path: Path) -> InstalledState:
    """Return the state stored at ``path``.

    Raises
    ------
    StateFileError
        If the file is damaged, foreign or of another version.
    """
    with open_state_file(path) as file:
        case_text = read_header(file, FORMAT, VERSION)
        name = file.attrs.get("kinematics")
        if name not in Kinematics.__members__:
            raise StateFileError(f"{path}: attribute kinematics is {name!r}; write the file again")
        records: dict[str, Any] = {}
        for group, record_type in records_of(Kinematics[name]).items():
            if group not in file:
                raise StateFileError(f"{path}: group /{group} is missing; write the file again")
            records[group] = read_record(file[group], record_type)
        return InstalledState(**records, case_text=case_text, kinematics=Kinematics[name])
