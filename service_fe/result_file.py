"""The file of the service stage, ``service.h5``: curves, stress and displacement."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any, get_args

import h5py

from handoff.fe_mesh import FEMesh
from handoff.fe_state_file import FEIntegrationPoints, FEInterfacePoints, FEState
from install_mpm.record import StateFileError, read_record, write_record
from install_mpm.seal import new_state_file, open_state_file
from install_mpm.state_file import read_header, write_header
from service_fe.options import Cycles, Displace, Lateral, Load, Programme, Release, Resume, Rotate
from service_fe.results import (
    AlongPile,
    Curve,
    Displacement,
    ModelName,
    ProgrammeResult,
    ServiceResult,
)

FORMAT = "screwpile-service-result"
VERSION = 5

RECORDS = {"mesh": FEMesh, "integration": FEIntegrationPoints, "interface": FEInterfacePoints}
"""Groups of the file that all programmes share."""

PROGRAMME_RECORDS = {"curve": Curve, "soil": Displacement, "state": FEState}
"""Groups below ``/programmes/<number>``."""

ALONG: dict[str, type] = {"along": AlongPile}
"""Group of a programme for a pile in space."""

_PROGRAMME_OF_KIND: dict[str, type[Programme]] = {
    kind.kind: kind for kind in (Release, Resume, Displace, Lateral, Rotate, Load, Cycles)
}
_REMEDY = "run the service stage again"


def write_service_result(path: Path, result: ServiceResult, created_by: str) -> None:
    """Write the result to ``path`` atomically: a reader sees the old file or the whole new one."""
    with new_state_file(path) as file:
        write_header(file, FORMAT, VERSION, result.case_text, created_by)
        file.attrs["model"] = result.model
        for name in RECORDS:
            write_record(file.create_group(name), getattr(result, name))
        programmes = file.create_group("programmes")
        for number, programme_result in enumerate(result.programmes):
            group = programmes.create_group(f"{number:03d}")
            group.attrs["programme"] = json.dumps(asdict(programme_result.programme))
            for name in PROGRAMME_RECORDS:
                write_record(group.create_group(name), getattr(programme_result, name))
            if programme_result.along is not None:
                write_record(group.create_group("along"), programme_result.along)


def read_service_result(path: Path) -> ServiceResult:
    """Return the result stored at ``path``.

    Raises
    ------
    StateFileError
        If the file is damaged, foreign or of another version.
    """
    with open_state_file(path) as file:
        case_text = read_header(file, FORMAT, VERSION)
        model = file.attrs.get("model")
        if model not in get_args(ModelName):
            raise StateFileError(f"{path}: attribute model is {model!r}; {_REMEDY}")
        records = _read_records(path, file, RECORDS)
        if "programmes" not in file:
            raise StateFileError(f"{path}: group /programmes is missing; {_REMEDY}")
        programmes = tuple(
            ProgrammeResult(
                programme=_read_programme(path, group),
                **_read_records(path, group, PROGRAMME_RECORDS),
                **_read_records(path, group, ALONG if "along" in group else {}),
            )
            for _, group in sorted(file["programmes"].items())
        )
    return ServiceResult(model=model, **records, programmes=programmes, case_text=case_text)


def _read_records(path: Path, group: h5py.Group, types: dict[str, type]) -> dict[str, Any]:
    """Return the records of ``types`` stored below ``group``."""
    for name in types:
        if name not in group:
            place = f"{group.name.rstrip('/')}/{name}"
            raise StateFileError(f"{path}: group {place} is missing; {_REMEDY}")
    return {name: read_record(group[name], record_type) for name, record_type in types.items()}


def _read_programme(path: Path, group: h5py.Group) -> Programme:
    """Return the programme's options, stored as JSON."""
    try:
        values = json.loads(group.attrs["programme"])
        programme: Programme = _PROGRAMME_OF_KIND[values["kind"]](**values)
    except (KeyError, TypeError, ValueError) as error:
        raise StateFileError(
            f"{path}: attribute programme of group {group.name} is missing or unreadable; {_REMEDY}"
        ) from error
    return programme
