"""The case: one TOML file that describes ground, pile, installation, hand-over and service."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from handoff.options import HandoffOptions
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.conventions import Kinematics
from install_mpm.ground import GroundProfile
from install_mpm.options import (
    BackgroundMeshOptions,
    Box,
    DiscretisationOptions,
    InstallationProgramme,
    Numerics,
)
from install_mpm.pile import Pile
from service_fe.options import ServiceOptions
from workflows.comparison import ComparisonOptions
from workflows.cross_checks import check
from workflows.errors import CaseError
from workflows.overrides import apply_overrides
from workflows.schema import build, table_of
from workflows.screw_case import ScrewCase, check_screw_case
from workflows.toml_text import format_toml

__all__ = ["AnyCase", "Case", "CaseError", "case_text", "parse_case", "read_case", "sections_text"]


@dataclass(frozen=True)
class Case:
    """Everything that a run depends on; the sections of the case file have the same names."""

    title: str
    """What the results are called; a results directory belongs to one title."""
    kinematics: Kinematics = field(default=Kinematics.PLANE_STRAIN, kw_only=True)
    """A wall in plane strain, per metre run, or a round pile in axisymmetry."""
    ground: GroundProfile
    pile: Pile
    interface: CoulombInterface
    box: Box
    background_mesh: BackgroundMeshOptions
    discretisation: DiscretisationOptions = field(default=DiscretisationOptions(), kw_only=True)
    installation: InstallationProgramme
    numerics: Numerics
    handoff: HandoffOptions
    service: ServiceOptions
    comparison: ComparisonOptions | None = None
    """Without it the ratios installed over wished in place have no range."""

    @property
    def final_tip_depth(self) -> float:
        """Depth in m of the pile tip after the installation."""
        return self.pile.embedment + self.installation.penetration


AnyCase = Case | ScrewCase
"""A jacked pile, or a screw pile in space; ``pile.model`` tells them apart."""


def read_case(path: Path, overrides: Iterable[str] = ()) -> tuple[AnyCase, str]:
    """Return the case in the TOML file ``path`` after ``--set`` overrides, and its canonical text.

    Raises
    ------
    CaseError
        In one sentence: the file, the dotted key, what is wrong and the remedy.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError as error:
        raise CaseError(f"{path}: no such file; give the path of a case file") from error
    except (OSError, UnicodeDecodeError) as error:
        raise CaseError(f"{path}: cannot be read as text ({error}); give a TOML file") from error
    case = parse_case(text, str(path), overrides)
    return case, case_text(case)


def parse_case(text: str, source: str, overrides: Iterable[str] = ()) -> AnyCase:
    """Return the case in TOML ``text``; ``source`` is what errors call it.

    Raises
    ------
    CaseError
        As ``read_case``.
    """
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise CaseError(f"{source}: not valid TOML: {error}; correct that line") from error
    changed = apply_overrides(document, overrides)
    if changed:
        source += f" with --set {', '.join(changed)}"
    try:
        if _describes_screw_pile(document):
            screw_case: ScrewCase = build(ScrewCase, document)
            check_screw_case(screw_case)
            return screw_case
        case: Case = build(Case, document)
        check(case)
    except CaseError as error:
        raise CaseError(f"{source}: {error}") from error
    return case


def _describes_screw_pile(document: dict[str, Any]) -> bool:
    pile = document.get("pile")
    return isinstance(pile, dict) and pile.get("model") == "screw_pile"


def case_text(case: AnyCase) -> str:
    """Return the canonical TOML text: every key, defaults filled in, quantities in SI.

    Two spellings of the same case have the same text, and reading it gives the same case.
    """
    return format_toml(table_of(case))


def sections_text(case: AnyCase, keys: Iterable[str]) -> str:
    """Return the canonical text of some keys only, e.g. of the sections that a stage depends on.

    A key is the name of a section or, dotted, of one key of it; a case that has no such section
    leaves it out.
    """
    table = table_of(case)
    found = {key.replace(".", "_"): _lookup(table, key) for key in sorted(set(keys))}
    return format_toml({key: value for key, value in found.items() if value is not None})


def _lookup(table: dict[str, Any], key: str) -> Any:
    value: Any = table
    for part in key.split("."):
        if part not in value:
            return None
        value = value[part]
    return value
