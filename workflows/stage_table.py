"""The stages of each kind of case: their commands, the files between them, what they depend on."""

from __future__ import annotations

from dataclasses import dataclass, replace

from workflows import directory as names
from workflows.case import AnyCase
from workflows.errors import CaseError
from workflows.placed import is_end_given
from workflows.screw_case import ScrewCase


@dataclass(frozen=True)
class Stage:
    """One arrow of the data flow: files in, files out."""

    name: str
    """Name of its module in ``workflows.stages``."""
    command: str
    """Command that runs it alone."""
    doing: str
    keys: tuple[str, ...]
    """Keys of the case that it depends on."""
    reads: tuple[str, ...]
    writes: tuple[str, ...]
    sources: tuple[str, ...]
    """Packages and files whose code decides its results."""


NUMERICS = ("install_mpm", "handoff", "service_fe")

STAGES = (
    Stage(
        "install", "screwpile install CASE", "jack the pile into the ground", names.INSTALL_KEYS,
        reads=(), writes=(names.INSTALLED,),
        sources=("install_mpm", "workflows/stages/install.py"),
    ),
    Stage(
        "hand_off", "screwpile handoff DIR", "hand the ground over to finite elements",
        names.HANDOFF_KEYS,
        reads=(names.INSTALLED,), writes=(names.HANDED_OFF, names.CERTIFICATE),
        sources=(*NUMERICS, "workflows/stages/hand_off.py"),
    ),
    Stage(
        "serve", "screwpile serve DIR", "load the installed pile in service", names.SERVICE_KEYS,
        reads=(names.HANDED_OFF,), writes=(names.SERVICE,),
        sources=(*NUMERICS, "workflows/stages/serve.py"),
    ),
    Stage(
        "wished", "screwpile wished CASE", "load the same pile wished in place", names.WISHED_KEYS,
        reads=(), writes=(names.WISHED_SERVICE,),
        sources=(*NUMERICS, "workflows/stages/wished.py"),
    ),
    Stage(
        "repeat", "screwpile repeat DIR", "repeat with a second mesh and a second transfer",
        names.COMPARISON_KEYS,
        reads=(names.INSTALLED, names.WISHED_SERVICE), writes=(names.REPEATED,),
        sources=(
            *NUMERICS, "workflows/stages/repeat.py", "workflows/comparison.py",
            "workflows/compare.py", "workflows/continuity.py",
        ),
    ),
    Stage(
        "compare", "screwpile compare DIR", "compare the two", ("title", *names.COMPARISON_KEYS),
        reads=(names.INSTALLED, names.CERTIFICATE, names.SERVICE, names.WISHED_SERVICE),
        writes=(names.CURVES, names.WISHED_CURVES, names.SUMMARY),
        sources=(
            *NUMERICS, "workflows/stages/compare.py", "workflows/compare.py",
            "workflows/continuity.py", "workflows/ratio_ranges.py",
        ),
    ),
    Stage(
        "export", "screwpile export DIR", "write views for ParaView", names.SERVICE_KEYS,
        reads=(names.INSTALLED, names.SERVICE, names.WISHED_SERVICE),
        writes=(
            names.VIEW_POINTS, names.VIEW_BACKGROUND, names.VIEW_INSTALLED, names.VIEW_WISHED
        ),
        sources=("workflows/stages/export.py", "workflows/export.py"),
    ),
    Stage(
        "report", "screwpile report DIR", "write the report", ("title", *names.COMPARISON_KEYS),
        reads=(
            names.INSTALLED, names.HANDED_OFF, names.CERTIFICATE, names.SERVICE,
            names.WISHED_SERVICE, names.CURVES, names.SUMMARY,
        ),
        writes=(names.REPORT,),
        sources=("workflows",),
    ),
)  # fmt: skip


INSTALL_SCREW, EXPORT_SCREW, REPORT_SCREW = (
    Stage(
        "install", "screwpile install CASE", "screw the pile into the ground", names.INSTALL_KEYS,
        reads=(), writes=(names.INSTALLED,),
        sources=("install_mpm", "workflows/stages/install.py"),
    ),
    Stage(
        "export", "screwpile export DIR", "write views for ParaView", names.INSTALL_KEYS,
        reads=(names.INSTALLED,), writes=names.SCREW_VIEWS,
        sources=(
            "workflows/stages/export.py", "workflows/export.py", "workflows/screw_export.py",
            "workflows/screw_frames.py",
        ),
    ),
    Stage(
        "report", "screwpile report DIR", "write the report", ("title", *names.INSTALL_KEYS),
        reads=(names.INSTALLED,), writes=(names.REPORT,), sources=("workflows",),
    ),
)  # fmt: skip

SCREW_STAGES = (INSTALL_SCREW, EXPORT_SCREW, REPORT_SCREW)
"""Stages of a screw pile that is installed only."""

SCREW_SERVICE_STAGES = (
    INSTALL_SCREW,
    *STAGES[1:-2],
    replace(
        EXPORT_SCREW, keys=names.SERVICE_KEYS,
        reads=(names.INSTALLED, names.SERVICE, names.WISHED_SERVICE),
        writes=(*names.SCREW_VIEWS, names.VIEW_INSTALLED, names.VIEW_WISHED),
    ),
    replace(
        REPORT_SCREW, keys=("title", *names.COMPARISON_KEYS),
        reads=next(stage.reads for stage in STAGES if stage.name == "report"),
    ),
)  # fmt: skip
"""Stages of a screw pile that is loaded in service."""


def stages_of(case: AnyCase) -> tuple[Stage, ...]:
    """Return the stages of a case, in order; only one with [comparison] has repeats."""
    stages = _stages_of_pile(case)
    if case.comparison is None:
        return tuple(stage for stage in stages if stage.name != "repeat")
    return tuple(
        replace(stage, reads=(*stage.reads, names.REPEATED)) if stage.name == "compare" else stage
        for stage in stages
    )


def _stages_of_pile(case: AnyCase) -> tuple[Stage, ...]:
    if not isinstance(case, ScrewCase):
        return STAGES
    if case.service is None:
        return SCREW_STAGES
    if is_end_given(case):
        return SCREW_SERVICE_STAGES
    return tuple(
        replace(stage, reads=(names.INSTALLED,)) if stage.name == "wished" else stage
        for stage in SCREW_SERVICE_STAGES
    )


def stage_named(name: str, case: AnyCase) -> Stage:
    """Return the stage of ``case`` called ``name``.

    Raises
    ------
    CaseError
        If a case of its kind has no such stage.
    """
    for stage in stages_of(case):
        if stage.name == name:
            return stage
    known = ", ".join(stage.name for stage in stages_of(case))
    needed = "[comparison]" if name == "repeat" else "[handoff] and [service]"
    raise CaseError(f"{case.title}: there is no stage {name!r} without {needed}; it has {known}")
