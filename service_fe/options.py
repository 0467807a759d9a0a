"""Options of the service stage: numerics and programmes of loading, each with unit and range."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le, MinLen

from install_mpm.conventions import Unit


@dataclass(frozen=True)
class Release:
    """Take the load off the pile's head in equal steps, force-controlled."""

    name: Annotated[str, MinLen(1)] = "release"
    steps: Annotated[int, Ge(1)] = 5
    kind: Literal["release"] = "release"


@dataclass(frozen=True)
class Displace:
    """Move the pile along its axis in equal steps; ``displacement`` is positive downward."""

    name: Annotated[str, MinLen(1)]
    displacement: Annotated[float, Unit("m")]
    step: Annotated[float, Unit("m"), Gt(0)]
    """Largest length of a step."""
    start: Literal["released", "equilibrated"] = "released"
    """Start from the end of the release, or from the state that was handed over."""
    first_step_halvings: Annotated[int, Ge(0), Le(10)] = 4
    """The first step is taken in parts: step / 2^4 twice, step / 2^3, ..., step / 2."""
    kind: Literal["displace"] = "displace"


Programme = Release | Displace
"""Every programme a case can name; ``kind`` tells them apart."""


@dataclass(frozen=True)
class ServiceNumerics:
    """Numerical parameters of the service stage; the defaults are explained in docs/method.md."""

    tolerance: Annotated[float, Gt(0), Le(1e-6)] = 1e-9
    """Out-of-balance force over external force plus reactions."""
    max_iterations: Annotated[int, Ge(3)] = 20
    max_cuts: Annotated[int, Ge(0)] = 6
    """Times a step may be halved before the run stops."""
    damping: Annotated[float, Ge(0), Le(10)] = 0.0
    """Viscous over elastic stress with which a step that does not converge is settled; 0: never."""


@dataclass(frozen=True)
class ServiceOptions:
    """The programmes of the service stage, in order, and its numerics."""

    programmes: tuple[Programme, ...]
    numerics: ServiceNumerics = ServiceNumerics()
