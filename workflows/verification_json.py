"""Results of reference problems for machines: ``screwpile verify --json FILE``."""

from __future__ import annotations

import enum
import json
import math
from dataclasses import asdict
from pathlib import Path
from typing import Any

from workflows.directory import write_text
from workflows.verification.runner import Verified

FORMAT, VERSION = "screwpile-verification", 1


def write_json(results: list[Verified], path: Path) -> None:
    """Write the results to ``path``; values are in SI, and what is not finite becomes null."""
    document = {
        "format": FORMAT,
        "version": VERSION,
        "is_met": all(result.is_met for result in results),
        "problems": [_problem(result) for result in results],
    }
    write_text(path, json.dumps(_plain(document), indent=1, allow_nan=False) + "\n")


def _problem(result: Verified) -> dict[str, Any]:
    outcome = result.outcome
    return {
        "id": result.problem.identifier,
        "title": result.title,
        "case": result.case_name or None,
        "is_met": result.is_met,
        "failure": result.failure or None,
        "seconds": round(result.seconds, 3),
        "inputs": {
            one.name: {
                "value": result.values[one.name],
                "unit": one.unit.symbol if one.unit else None,
            }
            for one in result.parameters
        },
        "checks": [{**asdict(check), "is_met": check.is_met} for check in result.checks],
        "newton": asdict(result.newton) if result.newton else None,
        "remarks": outcome.remarks if outcome else [],
        "series": [asdict(series) for series in outcome.series] if outcome else [],
        "residual_histories": outcome.residual_histories if outcome else [],
    }


def _plain(value: Any) -> Any:
    """Return ``value`` in what JSON knows; numpy's numbers become Python's."""
    if isinstance(value, dict):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if isinstance(value, enum.Enum):
        return value.name.lower()
    if hasattr(value, "item"):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value
