"""Options of the service stage: numerics and programmes of loading, each with unit and range."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le, Lt, MinLen

from install_mpm.conventions import Unit

Name = Annotated[str, MinLen(1)]
Halvings = Annotated[int, Ge(0), Le(10)]


@dataclass(frozen=True)
class Release:
    """Take the loads off the pile's head in equal steps, force-controlled."""

    name: Name = "release"
    steps: Annotated[int, Ge(1)] = 5
    kind: Literal["release"] = "release"


@dataclass(frozen=True)
class Resume:
    """Bring the pile, in space, back to where the rig stopped driving it, in equal steps.

    It rose and turned while the rig took off crowd force and torque.  What the hand-over has left
    of them is taken off before; a pile whose rig did not let go stays as it is.
    """

    name: Name = "resume"
    steps: Annotated[int, Ge(1)] = 4
    """Of the way back."""
    kind: Literal["resume"] = "resume"


@dataclass(frozen=True)
class Displace:
    """Move the pile along its axis in equal steps, guided; a positive way is downward."""

    name: Name
    displacement: Annotated[float, Unit("m")]
    step: Annotated[float, Unit("m"), Gt(0)]
    """Largest length of a step."""
    start: Name = "released"
    """Start from the end of the release, from the state that was handed over ("equilibrated"),
    from where the rig goes on ("resumed"), or from the end of the programme of this name.
    """
    first_step_halvings: Halvings = 4
    """The first step is taken in parts: step / 2^4 twice, step / 2^3, ..., step / 2."""
    kind: Literal["displace"] = "displace"


@dataclass(frozen=True)
class Lateral:
    """Move a point of the axis sideways, in space; all other loads on the pile stay as they are."""

    name: Name
    displacement: Annotated[float, Unit("m")]
    step: Annotated[float, Unit("m"), Gt(0)]
    height: Annotated[float, Unit("m")] = 0.0
    """Of the point of load above the ground."""
    direction: Annotated[float, Unit("rad")] = 0.0
    """Of the displacement, from the x axis towards the y axis."""
    head: Literal["free", "fixed"] = "free"
    """Whether the head can rotate."""
    start: Name = "released"
    first_step_halvings: Halvings = 4
    kind: Literal["lateral"] = "lateral"


@dataclass(frozen=True)
class Rotate:
    """Turn the pile, in space: by torsion about its axis, or by a moment about a horizontal one."""

    name: Name
    rotation: Annotated[float, Unit("rad")]
    """Right-handed about the axis, which points up, or about the horizontal one, at 90 degrees from
    the direction: a positive moment tilts the head in the direction.
    """
    step: Annotated[float, Unit("rad"), Gt(0)]
    about: Literal["axis", "horizontal"] = "axis"
    advance: Annotated[float | None, Unit("m")] = None
    """Of the pile in a whole torsion, positive downward; by default its vertical load stays."""
    direction: Annotated[float, Unit("rad")] = 0.0
    start: Name = "released"
    first_step_halvings: Halvings = 4
    kind: Literal["rotate"] = "rotate"


@dataclass(frozen=True)
class Load:
    """Bring all loads of the pile in space to given values together, force-controlled."""

    name: Name
    vertical: Annotated[float, Unit("N")] = 0.0
    """Positive downward."""
    lateral: Annotated[float, Unit("N")] = 0.0
    moment: Annotated[float, Unit("N m")] = 0.0
    """Besides that of the lateral load about the ground surface; positive tilts the same way."""
    torque: Annotated[float, Unit("N m")] = 0.0
    """Right-handed about the axis, which points up."""
    height: Annotated[float, Unit("m")] = 0.0
    """Of the point of load above the ground."""
    direction: Annotated[float, Unit("rad")] = 0.0
    steps: Annotated[int, Ge(1)] = 10
    start: Name = "released"
    kind: Literal["load"] = "load"


@dataclass(frozen=True)
class Cycles:
    """Cycles of one load of a pile in space, force-controlled; all other loads stay as they are."""

    name: Name
    component: Literal["vertical", "lateral"]
    """Vertical is positive downward; lateral is a load at the ``height``."""
    amplitude: Annotated[float, Unit("N"), Gt(0)]
    cycles: Annotated[int, Ge(1)]
    mean: Annotated[float, Unit("N")] = 0.0
    """Zero: two-way; the amplitude: one-way."""
    steps: Annotated[int, Ge(1)] = 4
    """From the mean to the amplitude; twice as many from peak to peak."""
    height: Annotated[float, Unit("m")] = 0.0
    direction: Annotated[float, Unit("rad")] = 0.0
    start: Name = "released"
    kind: Literal["cycles"] = "cycles"


Programme = Release | Resume | Displace | Lateral | Rotate | Load | Cycles
"""Every programme a case can name; ``kind`` tells them apart."""

IN_THE_PLANE = (Release, Displace)
"""Programmes of a wall and of a pile of revolution; a pile in space takes them all."""


@dataclass(frozen=True)
class DeformablePile:
    """Elasticity of a pile that is meshed inside; without it the pile is rigid."""

    youngs_modulus: Annotated[float, Unit("Pa"), Gt(0), Le(1e13)]
    """Of the solid section: that of a tube is E of the steel times its share of EI.

    Beyond 10 TPa, 50 times steel, the round-off of its forces exceeds the tolerance of the steps.
    """
    poissons_ratio: Annotated[float, Ge(0), Lt(0.5)] = 0.3
    contact: Literal["interface", "bonded"] = "interface"
    """The interface of the rigid pile, or the soil sticks to the pile."""


@dataclass(frozen=True)
class ServiceNumerics:
    """Numerical parameters of the service stage; the defaults are explained in docs/method.md."""

    tolerance: Annotated[float, Gt(0), Le(1e-4)] = 1e-9
    """Out-of-balance force over external force plus reactions; the equilibration of the hand-over
    ends at 1e-9 in any case.
    """
    max_iterations: Annotated[int, Ge(3)] = 20
    max_cuts: Annotated[int, Ge(0)] = 6
    """Times a step may be halved before the run stops."""
    mean_dilatation: bool = True
    """In space all points of a cell have its mean change of volume: undrained clay does not lock.

    Without it soil that can be compressed and stays elastic is modelled more accurately.
    """
    damping: Annotated[float, Ge(0), Le(10)] = 0.0
    """Viscous over elastic stress with which a step that does not converge is settled; 0: never."""
    viscosity: Annotated[float, Ge(0), Le(1)] = 0.0
    """Viscous over elastic stress of the strain in a whole step of a programme.

    Sand in space needs some; ``viscous_share`` of the results tells how much of the load it takes.
    """
    solver: Literal["mumps", "iterative"] = "mumps"
    """Of the linear systems: LU factors, or multigrid with MUMPS where that fails."""
    max_factor_reuse: Annotated[int | None, Ge(0), Le(200)] = None
    """Most iterations of GMRES with the factors of an iteration before; 0: factorise each time.

    By default 40 in space from 20,000 unknowns on, else 0: the end of Newton's method is then the
    exact quadratic one.
    """


@dataclass(frozen=True)
class ServiceOptions:
    """The programmes of the service stage; [service.pile] (youngs_modulus, ...): elastic pile."""

    programmes: tuple[Programme, ...]
    numerics: ServiceNumerics = ServiceNumerics()
    pile: DeformablePile | None = None
    """Without it the pile is rigid."""
