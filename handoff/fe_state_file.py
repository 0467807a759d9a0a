"""The handed-off state: what stage 2 hands to the service stage, and its HDF5 file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np

from handoff.fe_mesh import FEMesh
from install_mpm.record import Field, StateFileError, read_record, write_record
from install_mpm.seal import new_state_file, open_state_file
from install_mpm.state_file import read_header, write_header

FORMAT = "screwpile-handed-off-state"
VERSION = 3


class FEState(NamedTuple):
    """Stress and state of a finite-element model at its integration and interface points."""

    cauchy_stress: Annotated[
        np.ndarray, Field(("integration_point", 3, 3), "Pa", "total Cauchy stress")
    ]
    elastic_strain: Annotated[
        np.ndarray,
        Field(("integration_point", 3, 3), "", "small elastic strain that carries the stress"),
    ]
    state_variables: Annotated[
        np.ndarray, Field(("integration_point", "state"), "SI", "state variables of the soil law")
    ]
    material: Annotated[
        np.ndarray, Field(("integration_point",), "", "row of the soil table", "int64")
    ]
    interface_traction: Annotated[
        np.ndarray,
        Field(
            ("interface_point", "dim"),
            "Pa",
            "traction on the soil in local axes (tangential ..., normal), tension positive",
        ),
    ]
    pile_displacement: Annotated[
        np.ndarray, Field(("dim",), "m", "displacement of the rigid pile since the hand-over")
    ]


class FEIntegrationPoints(NamedTuple):
    """Where the stresses of an ``FEState`` are."""

    position: Annotated[np.ndarray, Field(("integration_point", "dim"), "m", "position")]
    volume: Annotated[
        np.ndarray,
        Field(("integration_point",), "m^3", "integration weight, of a wall per metre run"),
    ]


class FEInterfacePoints(NamedTuple):
    """Where the interface tractions of an ``FEState`` are."""

    position: Annotated[np.ndarray, Field(("interface_point", "dim"), "m", "position")]
    normal: Annotated[
        np.ndarray, Field(("interface_point", "dim"), "", "exact unit normal from soil to pile")
    ]
    area: Annotated[
        np.ndarray,
        Field(("interface_point",), "m^2", "integration weight, of a wall per metre run"),
    ]
    part: Annotated[np.ndarray, Field(("interface_point",), "", "part of the pile", "int64")]


class HandedOffPile(NamedTuple):
    """The rigid pile at the hand-over."""

    tip_depth: Annotated[np.ndarray, Field((), "m", "depth of the tip below the original surface")]
    rotation: Annotated[np.ndarray, Field((), "rad", "right-handed about +z since the start")]
    head_load: Annotated[
        np.ndarray,
        Field((), "N", "downward load that holds the modelled part: soil reaction less its weight"),
    ]
    rebound_rise: Annotated[
        np.ndarray,
        Field((), "m", "rise of the pile while the rig let go, in the installation"),
    ]
    rebound_rotation: Annotated[
        np.ndarray,
        Field((), "rad", "its rotation meanwhile, right-handed about +z"),
    ]


class HandedOffState(NamedTuple):
    """Everything the service stage starts from."""

    mesh: FEMesh
    state: FEState
    integration: FEIntegrationPoints
    interface: FEInterfacePoints
    pile: HandedOffPile
    certificate: str
    """The certificate as JSON text (``handoff.quality``)."""
    case_text: str


RECORDS = {
    "mesh": FEMesh,
    "state": FEState,
    "integration": FEIntegrationPoints,
    "interface": FEInterfacePoints,
    "pile": HandedOffPile,
}


def write_handed_off_state(path: Path, handed_off: HandedOffState, created_by: str) -> None:
    """Write the state to ``path`` atomically: a reader sees the old file or the whole new one."""
    with new_state_file(path) as file:
        write_header(file, FORMAT, VERSION, handed_off.case_text, created_by)
        file.create_group("certificate").attrs["json"] = handed_off.certificate
        for name in RECORDS:
            write_record(file.create_group(name), getattr(handed_off, name))


def read_handed_off_state(path: Path) -> HandedOffState:
    """Return the state stored at ``path``.

    Raises
    ------
    StateFileError
        If the file is damaged, foreign or of another version, or its groups do not belong together.
    """
    with open_state_file(path) as file:
        case_text = read_header(file, FORMAT, VERSION)
        records: dict[str, Any] = {}
        for group, record_type in RECORDS.items():
            if group not in file:
                raise StateFileError(f"{path}: group /{group} is missing; hand over again")
            records[group] = read_record(file[group], record_type)
        certificate = _read_certificate(path, file)
    handed_off = HandedOffState(**records, certificate=certificate, case_text=case_text)
    _check_extents(path, handed_off)
    return handed_off


def _read_certificate(path: Path, file: object) -> str:
    """Return the certificate's JSON text, checked to be JSON."""
    text = file["certificate"].attrs.get("json") if "certificate" in file else None  # type: ignore[index,operator]
    try:
        json.loads(text)  # type: ignore[arg-type]
    except (TypeError, ValueError) as error:
        raise StateFileError(
            f"{path}: group /certificate holds no JSON; hand over again"
        ) from error
    return str(text)


def _check_extents(path: Path, handed_off: HandedOffState) -> None:
    """Check that the groups belong together: numbers of points, and nodes named by cells."""
    mesh, state = handed_off.mesh, handed_off.state
    counts = {
        "integration": (len(handed_off.integration.volume), len(state.material)),
        "interface": (len(handed_off.interface.area), len(state.interface_traction)),
    }
    for group, (points, states) in counts.items():
        if points != states:
            raise StateFileError(
                f"{path}: group /{group} has {points} points, /state has {states}; hand over again"
            )
    for name in ("cell_nodes", "facet_nodes"):
        indices = getattr(mesh, name)
        if indices.size and not 0 <= indices.min() <= indices.max() < len(mesh.nodes):
            raise StateFileError(
                f"{path}: dataset /mesh/{name} names a node that does not exist; hand over again"
            )
