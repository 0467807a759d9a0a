"""Load-displacement curves of the pile in service, and the figures that are read from them.

Displacement and load are at the pile's head, for the whole pile and of a wall per metre run; the
displacement counts from the start of the programme.  They are positive downward, so uplift has both
negative; of a lateral load they are positive in its direction, and of a rotation they are angle and
moment.
"""

from __future__ import annotations

from typing import Annotated, Literal, NamedTuple, get_type_hints

import numpy as np

from handoff.fe_mesh import FEMesh
from handoff.fe_state_file import FEIntegrationPoints, FEInterfacePoints, FEState
from install_mpm.record import Field
from service_fe.options import Programme

INITIAL_SHARE = 0.1
"""The initial stiffness is the secant to this share of the capacity."""

FINAL_SHARE = 0.2
"""The final tangent is fitted to this last share of the curve's displacement."""

CAPACITY_DISPLACEMENT = 0.1
"""Displacement, over the pile's width, at which the load is called capacity."""

LINEAR_WORK = ("factorisations", "krylov_iterations", "fallbacks")
"""Counts of a ``Curve`` that tell how the linear systems were solved."""

ModelName = Literal["installed", "wished_in_place"]


def _per_step(unit: str, doc: str, dtype: str = "float64", *, may_be_nan: bool = False) -> Field:
    return Field(("load_step",), unit, doc, dtype, may_be_nan)


class Curve(NamedTuple):
    """Curve of a programme: the first row is its start, then one row per step; whole pile."""

    displacement: Annotated[
        np.ndarray,
        _per_step("m or rad", "displacement of the head, positive downward, or rotation"),
    ]
    head_load: Annotated[
        np.ndarray,
        _per_step("N or N m", "load of the structure on the head, positive downward, or moment"),
    ]
    iterations: Annotated[
        np.ndarray, _per_step("", "Newton iterations of the accepted parts of the step", "int64")
    ]
    residual: Annotated[np.ndarray, _per_step("", "relative out-of-balance force at acceptance")]
    convergence_order: Annotated[
        np.ndarray,
        _per_step("", "order of the last Newton iterations; NaN if too few", may_be_nan=True),
    ]
    cuts: Annotated[np.ndarray, _per_step("", "times the step was halved", "int64")]
    settled: Annotated[np.ndarray, _per_step("", "damped parts of a settled step", "int64")]
    viscous_share: Annotated[
        np.ndarray,
        _per_step("", "work of the viscous stress of the soil over that of the load on the pile"),
    ]
    factorisations: Annotated[
        np.ndarray, _per_step("", "factorisations of the stiffness in the step", "int64")
    ]
    krylov_iterations: Annotated[np.ndarray, _per_step("", "iterations of GMRES", "int64")]
    fallbacks: Annotated[
        np.ndarray,
        _per_step("", "times an approximate inverse failed and exact factors took over", "int64"),
    ]
    residual_history: Annotated[
        np.ndarray,
        Field(
            ("load_step", "iteration"),
            "",
            "relative residuals of the step's last part, NaN-padded",
            may_be_nan=True,
        ),
    ]
    motion: Annotated[
        np.ndarray,
        Field(("load_step", "motion"), "m or rad", "motion of the axis at the ground surface"),
    ]
    load: Annotated[
        np.ndarray,
        Field(("load_step", "motion"), "N or N m", "load on the pile there, besides its weight"),
    ]


class Displacement(NamedTuple):
    """Displacement of the soil in a programme."""

    displacement: Annotated[
        np.ndarray, Field(("node", "dim"), "m", "displacement since the programme's start")
    ]


def _along(unit: str, doc: str, *, is_lateral: bool = False, may_be_nan: bool = True) -> Field:
    axes = ("load_step", "level", "horizontal") if is_lateral else ("load_step", "level")
    return Field(axes, unit, doc, may_be_nan=may_be_nan)


class AlongPile(NamedTuple):
    """The pile along its axis in each step of a programme; whole pile, a wall per metre run."""

    height: Annotated[np.ndarray, Field(("level",), "m", "z of the levels, from the tip upward")]
    reaction: Annotated[
        np.ndarray,
        _along(
            "N/m",
            "horizontal force of the soil on the pile per length; NaN if bonded",
            is_lateral=True,
        ),
    ]
    deflection: Annotated[
        np.ndarray,
        _along(
            "m",
            "horizontal displacement of the pile since the programme's start",
            is_lateral=True,
            may_be_nan=False,
        ),
    ]
    normal_force: Annotated[
        np.ndarray, _along("N", "normal force, tension positive; NaN in a rigid pile")
    ]
    shear_force: Annotated[
        np.ndarray, _along("N", "shear force; NaN in a rigid pile", is_lateral=True)
    ]
    bending_moment: Annotated[
        np.ndarray,
        _along("N m", "bending moment, tension at positive x or y; NaN in a rigid pile",
               is_lateral=True),
    ]  # fmt: skip


class ProgrammeResult(NamedTuple):
    """What a programme did to the pile and to the ground."""

    programme: Programme
    curve: Curve
    soil: Displacement
    state: FEState
    """State of the ground at the end."""
    along: AlongPile | None = None
    """None but for a pile in space."""


class ServiceResult(NamedTuple):
    """Everything stage 3 knows at its end."""

    model: ModelName
    mesh: FEMesh
    integration: FEIntegrationPoints
    interface: FEInterfacePoints
    programmes: tuple[ProgrammeResult, ...]
    case_text: str

    def programme(self, name: str) -> ProgrammeResult:
        """Return the result of a programme.

        Raises
        ------
        KeyError
            If there is no programme of that name.
        """
        for result in self.programmes:
            if result.programme.name == name:
                return result
        names = ", ".join(result.programme.name for result in self.programmes)
        raise KeyError(f"there is no programme {name!r}; there are: {names}")


def without_pile(result: ServiceResult, n_soils: int) -> ServiceResult:
    """Return the result on the cells of the ground alone; a deformable pile is the last material.

    ``n_soils`` is the number of materials of the ground.
    """
    is_soil = result.programmes[0].state.material < n_soils
    if is_soil.all():
        return result
    per_cell = len(is_soil) // len(result.mesh.cell_nodes)
    of_points = [
        name
        for name, hint in get_type_hints(FEState, include_extras=True).items()
        if hint.__metadata__[0].shape[0] == "integration_point"
    ]
    return result._replace(
        mesh=result.mesh._replace(cell_nodes=result.mesh.cell_nodes[is_soil[::per_cell]]),
        integration=FEIntegrationPoints(*(values[is_soil] for values in result.integration)),
        programmes=tuple(
            entry._replace(
                state=entry.state._replace(
                    **{name: getattr(entry.state, name)[is_soil] for name in of_points}
                )
            )
            for entry in result.programmes
        ),
    )


class Characteristics(NamedTuple):
    """Figures read from a curve that is driven by displacement."""

    initial_stiffness: float
    """Secant stiffness in N/m up to 10 % of the capacity (``initial_stiffness``)."""
    capacity: float | None
    """Load in N at a displacement of 0.1 pile widths; None if the curve ends before."""
    tangent_capacity: float | None
    """Load in N where initial and final tangent meet; None if they do not meet on the curve."""


def head_load_at(curve: Curve, displacement: float) -> float:
    """Return the head load in N at ``displacement`` in m, linear between steps.

    Raises
    ------
    ValueError
        If the curve does not reach it.
    """
    direction = _direction(curve)
    reached = abs(curve.displacement[-1])
    if not -1e-12 <= direction * displacement <= reached * (1.0 + 1e-9):
        raise ValueError(
            f"the curve ends at {curve.displacement[-1]:g} m and does not reach {displacement:g} m;"
            " give the programme a larger displacement"
        )
    return float(
        np.interp(direction * displacement, direction * curve.displacement, curve.head_load)
    )


def initial_stiffness(curve: Curve, capacity: float) -> float:
    """Return the secant stiffness in N/m up to a change of load of 10 % of ``capacity`` in N.

    The curve is linear between its steps, so a first step beyond 10 % gives the secant of that
    step. A curve that never changes by 10 % gives the secant to its end.

    Raises
    ------
    ValueError
        If the pile does not move.
    """
    if curve.displacement[-1] == curve.displacement[0]:
        raise ValueError("a stiffness needs a curve along which the pile moves")
    displacement = np.abs(curve.displacement - curve.displacement[0])
    change = np.abs(curve.head_load - curve.head_load[0])
    wanted = INITIAL_SHARE * abs(capacity)
    beyond = np.flatnonzero(change >= wanted)
    if len(beyond) == 0 or wanted == 0.0:
        return float(change[-1] / displacement[-1])
    k = max(int(beyond[0]), 1)
    share = (wanted - change[k - 1]) / (change[k] - change[k - 1])
    return float(wanted / (displacement[k - 1] + share * (displacement[k] - displacement[k - 1])))


def tangent_intersection(curve: Curve, stiffness: float) -> float | None:
    """Return the load in N where the initial tangent (``stiffness`` in N/m) meets the final one.

    The final tangent is fitted to the last 20 % of the displacement.  None if the two do not meet
    within the curve, as when it is still straight at its end.
    """
    direction = _direction(curve)
    displacement = direction * curve.displacement
    load = direction * curve.head_load
    is_late = displacement >= (1.0 - FINAL_SHARE) * displacement[-1]
    if np.count_nonzero(is_late) < 2:
        is_late[-2:] = True
    slope, intercept = np.polyfit(displacement[is_late], load[is_late], 1)
    if stiffness <= slope:
        return None
    meeting = (intercept - load[0]) / (stiffness - slope)
    if not 0.0 < meeting <= displacement[-1]:
        return None
    return float(direction * (load[0] + stiffness * meeting))


def characteristics(curve: Curve, pile_width: float) -> Characteristics:
    """Return stiffness and capacities of a curve, for a pile of ``pile_width`` in m."""
    displacement = _direction(curve) * CAPACITY_DISPLACEMENT * pile_width
    is_reached = abs(curve.displacement[-1]) >= abs(displacement) * (1.0 - 1e-9)
    capacity = head_load_at(curve, displacement) if is_reached else None
    stiffness = initial_stiffness(
        curve, float(curve.head_load[-1]) if capacity is None else capacity
    )
    return Characteristics(stiffness, capacity, tangent_intersection(curve, stiffness))


def _direction(curve: Curve) -> float:
    """Return 1 for a curve downward, -1 for uplift."""
    return -1.0 if curve.displacement[-1] < curve.displacement[0] else 1.0
