"""Results of reference problems that are kept in a folder: ``screwpile verify --keep DIR``.

A result is one file.  Its name holds a hash of all that decides the result: the values of the
parameters, the source files that the problem is made of, and the versions of Python and of the
libraries.  As long as these are the same, the file stands for the run; so a run that was
interrupted goes on, and runs of single problems make one page.  A problem that could not be solved
is not kept.
"""

from __future__ import annotations

import base64
import inspect
import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from workflows.directory import write_text
from workflows.errors import CaseError
from workflows.manifest import software_versions, text_hash
from workflows.sources import sources_hash
from workflows.verification.problem import Check, Outcome, Picture, Problem, Series
from workflows.verification.runner import Verified, inputs_of, run_problem

VERSION = 1
"""Of the file; part of the hash."""

DIGITS = 16
"""Of the hash in the name of a file."""


@dataclass(frozen=True)
class KeptResults:
    """The results in ``folder``."""

    folder: Path

    def solve(self, problem: Problem, values: Mapping[str, Any]) -> Verified:
        """Return the kept result of a problem; without one, run the problem and keep its result.

        Raises
        ------
        CaseError
            If the kept result cannot be read.
        """
        path = self.path_of(problem, values)
        if path.exists():
            return _read(path, problem, inputs_of(problem, values))
        result = run_problem(problem, values)
        if result.outcome is not None:
            write_text(path, _text(result, result.outcome))
        return result

    def path_of(self, problem: Problem, values: Mapping[str, Any]) -> Path:
        """Return the file of a problem with ``values`` in place of its defaults."""
        sources = sources_hash(source_module(problem))
        inputs = sorted(inputs_of(problem, values).items())
        versions = sorted(software_versions().items())
        key = text_hash(repr((VERSION, problem.identifier, inputs, sources, versions)))
        return self.folder / f"{problem.identifier}-{key[:DIGITS]}.json"


def source_module(problem: Problem) -> str:
    """Return the name of the module that a problem is written in."""
    return inspect.unwrap(problem.run).__module__


def _text(result: Verified, outcome: Outcome) -> str:
    document = {
        "seconds": result.seconds,
        "checks": [asdict(check) for check in outcome.checks],
        "series": [asdict(series) for series in outcome.series],
        "remarks": outcome.remarks,
        "residual_histories": outcome.residual_histories,
        "round_off": outcome.round_off,
        "pictures": [
            {"name": one.name, "caption": one.caption, "png": base64.b64encode(one.png()).decode()}
            for one in outcome.pictures
        ],
    }
    return json.dumps(document, default=lambda number: number.item()) + "\n"


def _read(path: Path, problem: Problem, inputs: Mapping[str, Any]) -> Verified:
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        outcome = Outcome(
            checks=tuple(Check(**row) for row in document["checks"]),
            series=tuple(Series(**row) for row in document["series"]),
            remarks=tuple(document["remarks"]),
            residual_histories=tuple(map(tuple, document["residual_histories"])),
            round_off=document["round_off"],
            pictures=tuple(map(_picture, document["pictures"])),
        )
        return Verified(problem, inputs, document["seconds"], outcome, is_kept=True)
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise CaseError(f"{path} cannot be read ({error}); delete it to run it again") from error


def _picture(row: Mapping[str, str]) -> Picture:
    image = base64.b64decode(row["png"], validate=True)
    return Picture(row["name"], row["caption"], _constant(image))


def _constant(image: bytes) -> Callable[[], bytes]:
    return lambda: image
