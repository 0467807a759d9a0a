"""Commented parameters of one soil law, as the ``[ground]`` section of a case."""

from __future__ import annotations

import inspect
from typing import Any

from install_mpm.constitutive.parameters import SoilParameters
from install_mpm.ground import Ground
from workflows.errors import CaseError
from workflows.schema import alternatives_of, build, suggestion, tag_value
from workflows.soil_typical import TYPICAL
from workflows.template import commented_table, wrapped
from workflows.toml_text import format_toml

HEADING = """\
# Ground of one soil. The section can stand in a case, or alone: screwpile element-test FILE
# drives the soil through laboratory tests. Typical values are for a first try, not for design.

"""


GROUND: dict[str, Any] = {"unit_weight": "18 kN/m^3", "k0": 1.0}


def soil_law(name: str) -> Any:
    """Return the dataclass of the parameters of the law ``name``.

    Raises
    ------
    CaseError
        If there is no such law.
    """
    known = {tag_value(law): law for law in alternatives_of(SoilParameters)}
    if name not in known:
        raise CaseError(f"{name!r} is not a soil law; {suggestion(name, known)}")
    return known[name]


def soil_example(name: str) -> dict[str, Any]:
    """Return a ``[ground]`` table of the law ``name`` with typical parameters."""
    soil_law(name)
    values = {key: typical.value for key, typical in TYPICAL[name].items()}
    has_friction = not {"friction_angle", "critical_stress_ratio"}.isdisjoint(values)
    k0 = "jaky" if has_friction else GROUND["k0"]
    return {**GROUND, "k0": k0, "soil": {"model": name, **values}}


def soil_template_text(name: str) -> str:
    """Return the commented ``[ground]`` section of the law ``name``; it is valid as it stands.

    Raises
    ------
    CaseError
        If there is no such law.
    """
    law, example = soil_law(name), soil_example(name)
    build(Ground, example, "ground")
    table, comments = commented_table(Ground, example, "ground")
    comments["ground.soil"] = (_paragraphs(law), "")
    for key, typical in TYPICAL[name].items():
        above, behind = comments[f"ground.soil.{key}"]
        comments[f"ground.soil.{key}"] = ([*above, *wrapped(f"Typical: {typical.note}.")], behind)
    return HEADING + format_toml({"ground": table}, lambda key: comments.get(key, ([], "")))


def _paragraphs(law: type) -> list[str]:
    """Return the documentation of a law as lines of comment."""
    paragraphs = (inspect.getdoc(law) or "").split("\n\n")
    lines: list[str] = []
    for paragraph in paragraphs:
        lines += ["", *wrapped(" ".join(paragraph.split()))]
    return lines[1:]
