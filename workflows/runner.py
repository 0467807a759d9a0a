"""Runs the stages in order: which are up to date, and their record."""

from __future__ import annotations

import time
from importlib import import_module
from pathlib import Path

from workflows import directory as names
from workflows.case import AnyCase, sections_text
from workflows.certified import check_certified
from workflows.directory import check_ownership, claim
from workflows.errors import DirectoryError
from workflows.manifest import (
    StageRecord,
    code_hash,
    file_hash,
    read_manifest,
    text_hash,
    write_manifest,
)
from workflows.progress import Reporter
from workflows.ranks import check_ranks, is_first
from workflows.stage_table import STAGES, Stage, stage_named, stages_of
from workflows.state_files import STATE_FILES, case_for, check_existing, read_checked


def inputs_of(stage: Stage, case: AnyCase, directory: Path) -> dict[str, str]:
    """Return the hashes of everything that decides the outputs of ``stage``."""
    return {
        "case": text_hash(sections_text(case, stage.keys)),
        "code": code_hash(stage.sources),
        **{
            file: file_hash(directory / file) for file in stage.reads if (directory / file).exists()
        },
    }


def is_up_to_date(stage: Stage, case: AnyCase, directory: Path) -> bool:
    """Return whether the outputs of ``stage`` are there and would be the same if it ran again."""
    record = read_manifest(directory).stages.get(stage.name)
    if record is None or not all((directory / file).exists() for file in stage.writes):
        return False
    outputs = {file: file_hash(directory / file) for file in stage.writes}
    return record.outputs == outputs and record.inputs == inputs_of(stage, case, directory)


def check_present(stage: Stage, case: AnyCase, directory: Path) -> None:
    """Check that the files that ``stage`` reads are there.

    Raises
    ------
    DirectoryError
        Naming the first that is missing, and the command that writes it.
    """
    for file in stage.reads:
        if not (directory / file).exists():
            command = _writer(file, case).command
            raise DirectoryError(f"{directory / file}: no such file; run `{command}` first")


def check_made_from_each_other(stage: Stage, case: AnyCase, directory: Path) -> None:
    """Check that the files that ``stage`` reads were made from the files that are there now.

    Raises
    ------
    DirectoryError, StateFileError
        Naming the first that is out of date, or a state file that is damaged or foreign.
    """
    records = read_manifest(directory).stages
    for file in stage.reads:
        writer = _writer(file, case)
        inputs = records[writer.name].inputs if writer.name in records else {}
        for source in writer.reads:
            path = directory / source
            if source not in inputs or not path.exists() or file_hash(path) == inputs[source]:
                continue
            if source in STATE_FILES:
                read_checked(directory, source, case)
            raise DirectoryError(
                f"{directory / file} was made from another {source}; run `{writer.command}` first"
            )


def _writer(file: str, case: AnyCase) -> Stage:
    return next(stage for stage in stages_of(case) if file in stage.writes)


def run_stage(stage: Stage, case: AnyCase, directory: Path, reporter: Reporter) -> None:
    """Run one stage and record it in the manifest.

    Raises
    ------
    DirectoryError, StateFileError
        If a file that it reads is missing, damaged, out of date or of another case.
    """
    check_ranks(stage.name, stage.command)
    check_present(stage, case, directory)
    check_made_from_each_other(stage, case, directory)
    inputs = inputs_of(stage, case, directory)
    start = time.perf_counter()
    with reporter.stage(stage.name, stage.doing) as advance:
        remarks = import_module(f"workflows.stages.{stage.name}").run(case, directory, advance)
    for remark in remarks:
        reporter.say(f"{'':<9} {remark}")
    if not is_first():
        return
    manifest = read_manifest(directory)
    manifest.stages[stage.name] = StageRecord(
        inputs=inputs,
        outputs={file: file_hash(directory / file) for file in stage.writes},
        seconds=round(time.perf_counter() - start, 3),
    )
    write_manifest(directory, manifest)


def check_before(
    stage: Stage, case: AnyCase, directory: Path, reporter: Reporter, *, accept: bool
) -> None:
    """Check before the service stage that the hand-over is certified, or its failure accepted.

    Raises
    ------
    DirectoryError
        If it is neither; the message names the rows that failed.
    """
    if stage.name != "serve":
        return
    for remark in check_certified(directory, case, accept=accept):
        reporter.say(f"{'':<9} {remark}")


def run_case(
    case: AnyCase,
    directory: Path,
    reporter: Reporter | None = None,
    *,
    resume: bool = False,
    accept_uncertified: bool = False,
) -> None:
    """Run all stages in order; those whose inputs did not change are skipped.

    Raises
    ------
    DirectoryError, StateFileError
        Before anything runs, if ``directory`` holds another case's files or damaged ones; before
        the service stage, if the certificate has failed and this is not accepted.
    """
    reporter = reporter or Reporter()
    check_ranks("run", "screwpile run")
    check_ownership(directory, case)
    check_existing(directory, case)
    claim(directory, case)
    if not resume:
        (directory / names.CHECKPOINT).unlink(missing_ok=True)
    for stage in stages_of(case):
        check_before(stage, case, directory, reporter, accept=accept_uncertified)
        if is_up_to_date(stage, case, directory):
            reporter.say(f"{stage.name:<9} {stage.doing}: up to date")
        else:
            run_stage(stage, case, directory, reporter)


def run_from_case(
    name: str,
    case: AnyCase,
    directory: Path,
    reporter: Reporter | None = None,
    *,
    resume: bool = False,
) -> None:
    """Run one stage that needs nothing but the case: ``install`` or ``wished``.

    Raises
    ------
    DirectoryError
        Before anything runs, if ``directory`` holds another case's results.
    """
    stage = stage_named(name, case)
    check_ranks(stage.name, stage.command)
    check_ownership(directory, case)
    if is_first():
        claim(directory, case)
    if name == "install" and not resume:
        (directory / names.CHECKPOINT).unlink(missing_ok=True)
    run_stage(stage, case, directory, reporter or Reporter())


def run_from_files(
    name: str,
    directory: Path,
    reporter: Reporter | None = None,
    *,
    accept_uncertified: bool = False,
) -> None:
    """Run one stage from the files that the stages before it wrote into ``directory``.

    Raises
    ------
    DirectoryError, StateFileError
        If a file is missing, damaged or belongs to another case; if the service stage would begin
        from a hand-over whose certificate has failed, and this is not accepted.
    """
    if not directory.is_dir():
        raise DirectoryError(f"{directory}: no such directory; run `screwpile install` first")
    case = case_for(directory, _first_state_file(name, directory))
    stage, reporter = stage_named(name, case), reporter or Reporter()
    check_before(stage, case, directory, reporter, accept=accept_uncertified)
    run_stage(stage, case, directory, reporter)


def _first_state_file(name: str, directory: Path) -> str:
    """Return the first state file that a stage reads; all kinds of case have the same.

    Raises
    ------
    DirectoryError
        If it is not there.
    """
    reads = next(stage.reads for stage in STAGES if stage.name == name)
    first = next(file for file in reads if file in STATE_FILES)
    if not (directory / first).exists():
        command = next(stage.command for stage in STAGES if first in stage.writes)
        raise DirectoryError(f"{directory / first}: no such file; run `{command}` first")
    return first
