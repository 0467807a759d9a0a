"""The reference problems by their identifiers; a module is imported when it is asked for."""

from __future__ import annotations

import difflib
import re
from functools import cache
from importlib import import_module

from workflows.errors import CaseError
from workflows.verification.problem import Problem

MODULES: tuple[str, ...] = (
    "deep_penetration",
    "stretched_body",
    "rigid_rotation",
    "moving_mesh",
    "moving_solid",
    "opensees_triaxial",
    "ellipse",
    "annulus_interface",
    "annulus",
    "annulus_slab",
    "ample_beam",
    "ample_collapse",
    "ample_column",
    "reload",
    "cam_clay_undrained",
    "cantilever",
    "cavity",
    "circular_footing",
    "circular_footing_mpm",
    "circular_footing_solid",
    "column",
    "cyclic_interface",
    "deep_cylinder",
    "deep_cylinder_fe",
    "flexible_load",
    "hand_over_checks",
    "interface_shear",
    "lateral_pile",
    "paper_friction",
    "paper_hencky",
    "paper_penetration",
    "pile_head",
    "plate_anchor",
    "point_force",
    "rigid_disc",
    "rigid_disc_solid",
    "rotating_shaft",
    "round_trip",
    "sand_cavity",
    "sand_footing_factors",
    "scheme_comparison",
    "screw_pile_work",
    "shaft_friction",
    "short_pile",
    "slab",
    "sliding_block",
    "soil_elements",
    "strip_footing_fe",
    "strip_footing_mpm",
    "surface_plate",
    "tangent_check",
    "thin_helix",
    "thick_cylinder",
    "transfer_fields",
    "units",
    "weight_block",
)
"""Files of this folder with a ``PROBLEM`` or ``PROBLEMS``, sorted."""


@cache
def problems() -> dict[str, Problem]:
    """Return all problems by identifier, in natural order (PA2 before PA10).

    Raises
    ------
    ValueError
        If two problems have the same identifier.
    """
    found = [problem for name in MODULES for problem in _problems_of(name)]
    by_identifier = {
        problem.identifier: problem
        for problem in sorted(found, key=lambda problem: _natural(problem.identifier))
    }
    if len(by_identifier) < len(found):
        raise ValueError("two reference problems have the same identifier")
    return by_identifier


def problem(identifier: str) -> Problem:
    """Return the problem with ``identifier``; upper and lower case are the same.

    Raises
    ------
    CaseError
        If there is none; the message names those that are spelt alike.
    """
    known = {name.casefold(): name for name in problems()}
    if identifier.casefold() in known:
        return problems()[known[identifier.casefold()]]
    near = difflib.get_close_matches(identifier.casefold(), known, n=4)
    names = " or ".join(known[name] for name in near)
    hint = f"did you mean {names}?" if near else "`screwpile verify --list` names them all"
    raise CaseError(f"there is no reference problem {identifier!r}; {hint}")


def _problems_of(module_name: str) -> tuple[Problem, ...]:
    module = import_module(f"workflows.verification.{module_name}")
    several = getattr(module, "PROBLEMS", None)
    return (module.PROBLEM,) if several is None else tuple(several)


def _natural(identifier: str) -> list[tuple[int, str]]:
    """Return a key that sorts numbers by value."""
    parts = re.findall(r"\d+|\D+", identifier)
    return [(int(part), "") if part.isdigit() else (-1, part) for part in parts]
