"""What made the results: inputs and outputs of each stage by hash, versions, seeds, timings."""

from __future__ import annotations

import hashlib
import importlib
import importlib.metadata
import json
import platform
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from workflows.directory import MANIFEST, write_text
from workflows.errors import DirectoryError

FORMAT = "screwpile-manifest"
VERSION = 1
ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("install_mpm", "handoff", "service_fe", "workflows")


@dataclass(frozen=True)
class StageRecord:
    """One completed stage: it is up to date as long as inputs and outputs keep these hashes."""

    inputs: dict[str, str]
    """Hashes by name: ``case`` (the keys it depends on), ``code``, and each file it reads."""
    outputs: dict[str, str]
    """Hash of each file it wrote."""
    seconds: float


@dataclass
class Manifest:
    """The completed stages of a results directory."""

    stages: dict[str, StageRecord] = field(default_factory=dict)


def read_manifest(directory: Path) -> Manifest:
    """Return the manifest of ``directory``; an empty one if there is none.

    Raises
    ------
    DirectoryError
        If it cannot be read.
    """
    path = directory / MANIFEST
    if not path.exists():
        return Manifest()
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        if (document["format"], document["version"]) != (FORMAT, VERSION):
            raise ValueError(f"it is not {FORMAT} version {VERSION}")
        return Manifest({name: StageRecord(**row) for name, row in document["stages"].items()})
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise DirectoryError(
            f"{path} cannot be read ({error}); delete it to have all stages run again"
        ) from error


def write_manifest(directory: Path, manifest: Manifest) -> None:
    """Write the manifest of ``directory``."""
    document = {
        "format": FORMAT,
        "version": VERSION,
        "stages": {name: asdict(record) for name, record in manifest.stages.items()},
        "software": software_versions(),
    }
    write_text(directory / MANIFEST, json.dumps(document, indent=2) + "\n")


def file_hash(path: Path) -> str:
    """Return the SHA-256 of the content of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def text_hash(text: str) -> str:
    """Return the SHA-256 of a text."""
    return hashlib.sha256(text.encode()).hexdigest()


@cache
def code_hash(sources: tuple[str, ...]) -> str:
    """Return a hash of the Python files of packages (by name) or single files (by path)."""
    digest = hashlib.sha256()
    for source in sources:
        path = ROOT / source
        for file in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            digest.update(f"{file.relative_to(ROOT).as_posix()}\n".encode())
            digest.update(file.read_bytes())
    return digest.hexdigest()


def created_by() -> str:
    """Return what state files carry as their author: the program and its version."""
    return f"screwpile {importlib.metadata.version('screwpile')}"


@cache
def software_versions() -> dict[str, str]:
    """Return the versions of the program, of Python and of the libraries that decide results."""
    versions = {
        "screwpile": importlib.metadata.version("screwpile"),
        "python": platform.python_version(),
    }
    for name in ("numpy", "scipy", "numba", "h5py", "gmsh", "meshio", "dolfinx"):
        versions[name] = _module_version(name)
    versions["petsc"] = _petsc_version()
    versions["system"] = platform.platform()
    return versions


def _module_version(name: str) -> str:
    try:
        return str(importlib.import_module(name).__version__)
    except (ImportError, AttributeError):
        return "not installed"


def _petsc_version() -> str:
    try:
        petsc: Any = importlib.import_module("petsc4py.PETSc")
    except ImportError:
        return "not installed"
    return ".".join(map(str, petsc.Sys.getVersion()))
