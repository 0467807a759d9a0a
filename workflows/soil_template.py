"""Commented parameters of one soil law, as the ``[ground]`` section of a case."""

from __future__ import annotations

import inspect
from typing import Any, NamedTuple

from install_mpm.constitutive.parameters import SoilParameters
from install_mpm.ground import Ground
from workflows.errors import CaseError
from workflows.schema import alternatives_of, build, suggestion, tag_value
from workflows.template import commented_table, wrapped
from workflows.toml_text import format_toml

HEADING = """\
# Ground of one soil. The section can stand in a case, or alone: screwpile element-test FILE
# drives the soil through laboratory tests. Typical values are for a first try, not for design.

"""


class Typical(NamedTuple):
    """A value to start from, and what is usual."""

    value: Any
    note: str
    """Typical range and its source."""


LAMBE = "Lambe and Whitman 1969"
BOLTON = "Bolton 1986"
STIFFNESS_OF_CLAY = Typical(
    "8 MPa", "E_u 100 to 500 s_u, the more the less plastic (Duncan and Buchignani 1976)"
)
UNDRAINED = Typical(0.49, "0.49: undrained soil keeps its volume")
STRENGTH_OF_CLAY = {
    "undrained_shear_strength": Typical(
        "20 kPa", "12 to 25 kPa soft, 25 to 50 firm, 50 to 100 stiff (BS 5930)"
    ),
    "undrained_shear_strength_gradient": Typical(
        "1.5 kPa/m", "0.2 to 0.3 of the effective unit weight in soft clay (Mesri 1975: 0.22)"
    ),
}
SAND = {
    "youngs_modulus": Typical("40 MPa", f"10 to 30 MPa loose, 40 to 80 MPa dense ({LAMBE})"),
    "poissons_ratio": Typical(0.25, f"0.2 to 0.3 ({LAMBE})"),
    "cohesion": Typical("1 kPa", "0 to 1 kPa in clean sand; a little helps at the surface"),
    "friction_angle": Typical("36 deg", f"30 to 34 deg loose, 36 to 45 deg dense ({BOLTON})"),
    "dilation_angle": Typical("6 deg", f"about the friction angle less 30 deg ({BOLTON})"),
    "initial_void_ratio": Typical(0.6, f"0.5 dense to 0.9 loose ({LAMBE})"),
    "critical_void_ratio": Typical(
        0.75, "0.7 to 0.85 under moderate pressure (Been and Jefferies 1985)"
    ),
}
ELASTIC = {
    "youngs_modulus": Typical("20 MPa", f"5 MPa soft clay to 80 MPa dense sand ({LAMBE})"),
    "poissons_ratio": Typical(0.3, f"0.2 to 0.35 drained ({LAMBE}), 0.49 undrained"),
}
CLAY = {"youngs_modulus": STIFFNESS_OF_CLAY, "poissons_ratio": UNDRAINED, **STRENGTH_OF_CLAY}

TYPICAL: dict[str, dict[str, Typical]] = {
    "hencky_elastic": ELASTIC,
    "neo_hookean": ELASTIC,
    "von_mises": CLAY,
    "tresca": CLAY,
    "mohr_coulomb": SAND,
    "drucker_prager": SAND | {"cone": Typical("compression", "compression, as triaxial tests are")},
}
"""Typical parameters of every soil law by its name."""

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
    k0 = "jaky" if "friction_angle" in values else GROUND["k0"]
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
