"""The results directory: names of its files, and whose results it holds."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from workflows.case import AnyCase, case_text, parse_case, sections_text
from workflows.errors import CaseError, DirectoryError

CASE = "case.toml"
INSTALLED = "installed.h5"
CHECKPOINT = "installed.checkpoint.h5"
TIMING = "installation_times.json"
HANDED_OFF = "handed_off.h5"
CERTIFICATE = "certificate.json"
SERVICE = "service.h5"
WISHED = "wished_in_place"
WISHED_SERVICE = f"{WISHED}/{SERVICE}"
REPEATS = "repeated"
REPEATED = "repeated.json"
CURVES = "curves.csv"
WISHED_CURVES = f"{WISHED}/{CURVES}"
SUMMARY = "summary.json"
MANIFEST = "manifest.json"
REPORT = "report.html"
VIEW_POINTS = "paraview/material_points.vtu"
VIEW_BACKGROUND = "paraview/background_mesh.vtu"
VIEW_INSTALLED = "paraview/service_installed.vtu"
VIEW_WISHED = "paraview/service_wished_in_place.vtu"
VIEWS = "paraview"
FRAMES = "paraview/frames"
SCREW_VIEWS = tuple(
    f"paraview/installed_{series}.vtu"
    for series in ("pile_surface", "material_points", "background_mesh")
)
"""Views of the end of a screw pile installation."""

INSTALL_KEYS = (
    "kinematics", "ground", "pile", "interface", "box", "background_mesh", "discretisation",
    "installation", "numerics",
)  # fmt: skip
"""Sections of the case that decide the installed state."""

HANDOFF_KEYS = (*INSTALL_KEYS, "handoff", "service.numerics")
"""Sections of the case that decide the handed-off state."""

WISHED_KEYS = (
    "kinematics", "ground", "pile", "interface", "box", "installation", "handoff", "service"
)  # fmt: skip
"""Sections of the case that decide the wished-in-place model; of the installation, its depth."""

SERVICE_KEYS = (*HANDOFF_KEYS, "service")
"""Sections of the case that decide the service results."""

COMPARISON_KEYS = (*SERVICE_KEYS, "comparison")
"""Sections of the case that decide the ratios and their ranges."""


def write_text(path: Path, text: str) -> None:
    """Write a text file atomically: a reader sees the old file or the whole new one."""
    partial = path.with_name(path.name + ".partial")
    with partial.open("w", encoding="utf-8") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    partial.replace(path)


def case_of(directory: Path) -> AnyCase | None:
    """Return the case that ``directory`` belongs to, None if it belongs to none yet.

    Raises
    ------
    DirectoryError
        If ``case.toml`` in it cannot be used.
    """
    path = directory / CASE
    if not path.exists():
        return None
    try:
        return parse_case(path.read_text(encoding="utf-8"), str(path))
    except (CaseError, OSError, UnicodeDecodeError) as error:
        raise DirectoryError(
            f"{directory} cannot be used: {error}, or take another directory with -o"
        ) from error


def check_ownership(directory: Path, case: AnyCase) -> None:
    """Check that ``directory`` is free or holds results of the same case (maybe with other values).

    Raises
    ------
    DirectoryError
        If it is a file, or holds the results of a case of another title.
    """
    if directory.exists() and not directory.is_dir():
        raise DirectoryError(f"{directory} is a file; give a directory with -o")
    owner = case_of(directory)
    if owner is not None and owner.title != case.title:
        raise DirectoryError(
            f"{directory} holds the results of another case, {owner.title!r} instead of "
            f"{case.title!r}; give another directory with -o"
        )


def claim(directory: Path, case: AnyCase) -> None:
    """Write the canonical text of ``case`` into ``directory``, which is made if need be."""
    directory.mkdir(parents=True, exist_ok=True)
    write_text(directory / CASE, case_text(case))


def case_in_file(path: Path, text: str) -> AnyCase:
    """Return the case that the state file ``path`` carries as ``text``.

    Raises
    ------
    DirectoryError
        If it cannot be read.
    """
    try:
        return parse_case(text, str(path))
    except CaseError as error:
        raise DirectoryError(
            f"{path} carries a case that cannot be used ({error}); write it again"
        ) from error


def check_belongs(path: Path, text: str, case: AnyCase, keys: Iterable[str]) -> None:
    """Check that the case ``text`` of the state file ``path`` has the same ``keys`` as ``case``.

    Raises
    ------
    DirectoryError
        Naming the sections that differ.
    """
    other = case_in_file(path, text)
    differing = [key for key in keys if sections_text(case, [key]) != sections_text(other, [key])]
    if differing:
        raise DirectoryError(
            f"{path} belongs to another case ({', '.join(f'[{key}]' for key in differing)} "
            f"{'differs' if len(differing) == 1 else 'differ'}); run the stage that writes it "
            "again, or take another directory"
        )
