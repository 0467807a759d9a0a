"""Pictures of the pile in service: curves of both models, displacement and plastic strain."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from install_mpm.conventions import Kinematics
from install_mpm.geostatic import named_state
from install_mpm.ground import GroundProfile
from install_mpm.state_file import InstalledState
from service_fe.loading import RELEASED, shows_moment
from service_fe.options import Displace, Lateral, Load, Programme, Release
from service_fe.results import (
    CAPACITY_DISPLACEMENT,
    Curve,
    ProgrammeResult,
    ServiceResult,
    characteristics,
    head_load_at,
)
from workflows.case import AnyCase, Case
from workflows.continuity import CONTINUITY_SHARES
from workflows.report_fields import (
    colour_bar,
    draw_nodal,
    draw_pile,
    draw_polygons,
    finish,
    picture_height,
    positive_norm,
    sub_regions,
    window_of,
)
from workflows.report_style import (
    INK,
    INTENSITY,
    MODEL_COLOURS,
    MODEL_NAMES,
    MUTED,
    SEQUENTIAL,
    grid,
    panels,
)
from workflows.report_units import FORCE_UNIT

STRAIN_NORM = Normalize(0.0, 10.0)
"""Plastic shear strains are shown up to 10 %."""


class Shown(NamedTuple):
    """How the curve of a programme is drawn."""

    displacement: float
    """Factor to the display unit of the displacement."""
    displacement_label: str
    load_label: str


def shown_as(programme: Programme, kinematics: Kinematics) -> Shown:
    """Return factor and labels of the curve of a programme; loads are shown in thousands."""
    force = FORCE_UNIT[kinematics]
    if shows_moment(programme):
        return Shown(180.0 / np.pi, "rotation (°)", f"moment ({force} m)")
    if isinstance(programme, Lateral) or getattr(programme, "component", "") == "lateral":
        return Shown(1e3, "displacement of the head, sideways (mm)", f"lateral load ({force})")
    if isinstance(programme, Load):
        return Shown(1e3, "displacement along the leading load (mm)", f"leading load ({force})")
    return Shown(1e3, "displacement, downward (mm)", f"head load ({force})")


def curves(case: AnyCase, service: ServiceResult, wished: ServiceResult) -> Figure:
    """Return head load against displacement of every programme, installed and wished in place."""
    columns = 2
    rows = -(-len(service.programmes) // columns)
    figure, axes = panels(rows, columns, 10.0, 3.3 * rows)
    for here in axes.flat[len(service.programmes) :]:
        here.set_visible(False)
    for here, result in zip(axes.flat, service.programmes, strict=False):
        for model in (service, wished):
            _draw_curve(here, model.model, model.programme(result.programme.name), case)
        labels = shown_as(result.programme, case.kinematics)
        here.set(
            xlabel=labels.displacement_label,
            ylabel=labels.load_label,
            title=title_of(result),
        )
        here.axhline(0.0, color=MUTED, linewidth=0.6)
        grid(here)
    axes[0, 0].legend()
    return figure


def title_of(result: ProgrammeResult) -> str:
    """Return the name of a programme and the pile that it starts from."""
    start = getattr(result.programme, "start", None)
    name = result.programme.name.replace("_", " ")
    return name if start is None else f"{name}, from the {start} pile"


def _draw_curve(axes: Any, model: str, result: ProgrammeResult, case: AnyCase) -> None:
    """Draw one curve with its capacities."""
    curve, colour = result.curve, MODEL_COLOURS[model]
    factor = shown_as(result.programme, case.kinematics).displacement
    axes.plot(
        factor * curve.displacement,
        curve.head_load / 1e3,
        ".-",
        color=colour,
        label=MODEL_NAMES[model],
        markersize=3.0,
    )
    for mark in capacity_marks(result, case.pile.width):
        size = {"markersize": 7.0, "clip_on": False}
        axes.plot(1e3 * mark.displacement, mark.head_load / 1e3, mark.symbol, color=colour, **size)


class CapacityMark(NamedTuple):
    """Where a curve reaches a capacity."""

    displacement: float
    """In m."""
    head_load: float
    """In N."""
    symbol: str
    """Dot at 0.1 widths, cross where the tangents meet."""


def capacity_marks(result: ProgrammeResult, width: float) -> list[CapacityMark]:
    """Return the capacities of a programme that displaces the released pile of ``width`` in m."""
    programme = result.programme
    if not isinstance(programme, Displace | Lateral) or programme.start != RELEASED:
        return []
    curve, marks = result.curve, []
    found = characteristics(curve, width)
    if found.capacity is not None:
        place = np.sign(curve.displacement[-1]) * CAPACITY_DISPLACEMENT * width
        marks.append(CapacityMark(place, found.capacity, "o"))
    if found.tangent_capacity is not None:
        place = (found.tangent_capacity - curve.head_load[0]) / found.initial_stiffness
        marks.append(CapacityMark(place, found.tangent_capacity, "x"))
    return marks


def continuity(case: Case, installed: InstalledState, service: ServiceResult) -> Figure | None:
    """Return the installation force and how the pushed-on pile continues it, None if it cannot."""
    width, history = case.pile.width, installed.history
    pushed = [
        result
        for result in service.programmes
        if isinstance(result.programme, Displace)
        and result.programme.start == "equilibrated"
        and result.programme.displacement > 0.0
    ]
    if not pushed or float(installed.pile.penetration) == 0.0:
        return None
    figure, axes = panels(1, 1, 6.4, 3.2)
    here, end = axes[0, 0], float(installed.pile.penetration)
    force = float(history.crowd_force[-1]) / 1e3
    here.plot(
        1e3 * (history.penetration - end),
        history.crowd_force / 1e3,
        color=INK,
        label="jacked (material points)",
    )
    for result in pushed:
        curve, label = result.curve, f"{result.programme.name.replace('_', ' ')} (finite elements)"
        here.plot(1e3 * curve.displacement, curve.head_load / 1e3, ".-",
                  color=MODEL_COLOURS["installed"], label=label)  # fmt: skip
        _draw_shares(here, curve, width)
    reach = 1e3 * max(float(result.curve.displacement[-1]) for result in pushed)
    band = here.fill_between([0.0, reach], 0.9 * force, 1.1 * force, color=MUTED, alpha=0.25)
    band.set(linewidth=0.0, label="±10 % of the last installation force")
    here.set_xlim(-4.0 * reach, 1.1 * reach)
    loads = [history.crowd_force, *(result.curve.head_load for result in pushed)]
    here.set_ylim(0.0, 1.3 * max(float(load.max()) for load in loads) / 1e3)
    here.set(
        xlabel="displacement since the end of jacking (mm)",
        ylabel=f"force ({FORCE_UNIT[case.kinematics]})",
    )
    here.legend(loc="lower left")
    grid(here)
    return figure


def _draw_shares(axes: Any, curve: Curve, width: float) -> None:
    """Mark the displacements at which the continuity is read."""
    for share in CONTINUITY_SHARES:
        if share * width <= curve.displacement[-1] * (1.0 + 1e-9):
            load = head_load_at(curve, share * width) / 1e3
            axes.plot(1e3 * share * width, load, "o", color=MODEL_COLOURS["installed"])
            axes.annotate(f"{share:g} B", (1e3 * share * width, load), (0, 8),
                          textcoords="offset points", ha="center", fontsize=8)  # fmt: skip


def mechanism(case: Case, service: ServiceResult, wished: ServiceResult, name: str) -> Figure:
    """Return displacement and plastic shear strain of the programme ``name`` in both models.

    Where a soil keeps no plastic strain the picture shows the displacement only.
    """
    models = (service, wished)
    strains = [plastic_shear(case.ground, model, name) for model in models]
    n_fields = 2 if strains[0] is not None else 1
    height = picture_height(window_of(case), 4, 11.0) + 0.3
    figure, axes = panels(1, 2 * n_fields, 5.5 * n_fields, height)
    largest = np.concatenate([_distance(model, name) for model in models])
    norm = positive_norm(largest)
    for here, model in zip(axes[0, :2], models, strict=True):
        drawn = draw_nodal(here, model.mesh, _distance(model, name), norm, SEQUENTIAL)
        _finish(here, case, MODEL_NAMES[model.model], is_first=here is axes[0, 0])
    colour_bar(figure, drawn, axes[0, :2], f"displacement in {name!r} (mm)", "max")
    for here, model, strain in zip(axes[0, 2:], models, strains, strict=False):
        cells = sub_regions(model.mesh, model.integration.position)
        assert strain is not None
        drawn = draw_polygons(here, cells, 100.0 * strain, STRAIN_NORM, INTENSITY)
        _finish(here, case, MODEL_NAMES[model.model], is_first=False)
    if n_fields == 2:
        colour_bar(figure, drawn, axes[0, 2:], f"plastic shear strain in {name!r} (%)", "max")
    return figure


def _finish(axes: Any, case: Case, title: str, *, is_first: bool) -> None:
    window = window_of(case)
    draw_pile(axes, case.pile.half_width, case.final_tip_depth, window)
    finish(axes, window, title, with_height=is_first)


def _distance(model: ServiceResult, name: str) -> np.ndarray:
    """Return the displacement (node,) in mm."""
    moved = model.programme(name).soil.displacement
    distance: np.ndarray = 1e3 * np.linalg.norm(moved, axis=1)
    return distance


def plastic_shear(ground: GroundProfile, model: ServiceResult, name: str) -> np.ndarray | None:
    """Return the plastic shear strain (n_q,) since the release before the programme ``name``.

    None if a soil of the ground does not keep it.
    """
    start: np.ndarray | float = 0.0
    for result in model.programmes:
        state = result.state
        end = named_state(ground, state.material, state.state_variables, "plastic_shear_strain")
        if end is None:
            return None
        if result.programme.name == name:
            return np.asarray(end - start)
        if isinstance(result.programme, Release):
            start = end
    raise KeyError(name)
