"""Tables of the report of a screw pile: headline, torque by part, convergence, the case."""

from __future__ import annotations

from dataclasses import fields, is_dataclass

import numpy as np

from install_mpm.conventions import Kinematics
from install_mpm.ground import undrained_shear_strength
from install_mpm.screw_history import ScrewHistory, driven
from install_mpm.state_file import InstalledState
from workflows.compare import QUADRATIC_ORDER
from workflows.report_html import Cell, cell, number, table
from workflows.report_tables import group_row, option_rows, spaced
from workflows.report_units import shown, significant
from workflows.screw_case import ScrewCase
from workflows.screw_report_curves import balance_error, turns
from workflows.screw_theory import PartTorque

Row = list[str | Cell]


def whole(value: float | None, unit: str = "", digits: int = 4) -> str:
    """Return a quantity of the whole pile as text with its display unit."""
    return shown(value, unit, digits, Kinematics.THREE_D)


def summary_table(case: ScrewCase, installed: InstalledState) -> str:
    """Return the figures by which an installation is judged."""
    history = driven(installed.history)
    rows: list[Row] = [
        _group("when the rig stops"),
        ["depth of the tip",
         number(whole(case.pile.embedment + float(history.penetration[-1]), "m", 3))],
        ["rotation", number(f"{significant(float(turns(case.pile, history)[-1]), 3)} turns")],
        ["torque", number(whole(float(history.torque[-1]), "N m"))],
        ["crowd force, downward", number(whole(float(history.crowd_force[-1]), "N"))],
        ["advancement ratio of the last step that turned", number(_last_ratio(history))],
        *_edge_rows(case, history),
        *_release_rows(case, installed),
        _group("largest on the way"),
        ["torque", number(whole(float(history.torque.max()), "N m"))],
        ["crowd force", number(whole(float(history.crowd_force.max()), "N"))],
        ["lateral force", number(whole(_largest(history.lateral_force), "N"))],
        ["overturning moment", number(whole(_largest(history.overturning_moment), "N m"))],
        *_check_rows(installed, history),
        *_point_rows(case, installed),
        *winding_rows(installed.history),
    ]  # fmt: skip
    return table([], rows)


def _edge_rows(case: ScrewCase, history: ScrewHistory) -> list[Row]:
    """Return what resists at edges and rims that are not in the mesh; nothing without such."""
    if not any(helix.is_surface for helix in case.pile.helices):
        return []
    torque, force = float(history.edge_torque[-1]), float(history.edge_force[-1])
    rows: list[Row] = [_group("more, by hand, of edges and rims that are not in the mesh")]
    if np.isnan(torque):
        return [*rows, ["torque and crowd force", number("not stated")]]
    return [
        *rows,
        ["torque", number(whole(torque, "N m", 3))],
        ["crowd force, downward", number(whole(force, "N", 3))],
    ]


def _release_rows(case: ScrewCase, installed: InstalledState) -> list[Row]:
    """Return how the pile moved when the rig let go; nothing if it did not."""
    history: ScrewHistory = installed.history
    last = int((history.release_share == 0.0).sum()) - 1
    if last == len(history.travel) - 1:
        return []
    rise = 1e3 * float(history.penetration[last] - history.penetration[-1])
    back = 360.0 * float(np.diff(turns(case.pile, history)[[-1, last]])[0])
    return [
        _group("when the rig has let go"),
        ["pile has come up", number(f"{significant(rise, 3)} mm")],
        ["pile has turned back", number(f"{significant(back, 3)} °")],
        ["torque that is left", number(whole(float(history.torque[-1]), "N m", 2))],
        ["crowd force that is left", number(whole(float(history.crowd_force[-1]), "N", 2))],
    ]


def _check_rows(installed: InstalledState, history: ScrewHistory) -> list[Row]:
    """Return what tells whether the figures can be trusted, over the driven steps."""
    moved = history.travel > 0.0
    worst = float(balance_error(history)[moved].max(initial=0.0))
    moment = float(history.far_moment_mismatch.max())
    force = float(history.far_force_mismatch.max())
    return [
        _group("checks"),
        ["work of the rig", number(whole(float(history.rig_work.sum()), "J"))],
        ["error of the power balance, all steps", number(whole(balance_of(history), "", 2))],
        ["error of the power balance, worst step", number(whole(worst, "", 2))],
        ["moment on the pile against the supports, worst step", number(whole(moment, "", 2))],
        ["force on the pile against the supports, worst step", number(whole(force, "", 2))],
        ["cells", number(str(len(installed.background_mesh.cell_nodes)))],
    ]


def _point_rows(case: ScrewCase, installed: InstalledState) -> list[Row]:
    """Return what became of the material points and of their stress, over all steps."""
    history: ScrewHistory = installed.history
    n_points = points_per_step(installed)
    most, n_start = int(n_points.max()), int(n_points[0])
    low, high = history.smallest_volume_ratio.min(), history.largest_volume_ratio.max()
    scatter = largest_known(history.pressure_scatter)
    strength = undrained_shear_strength(case.ground, -installed.pile.tip_depth[None])[0]
    over = f", {significant(scatter / strength, 2)} su" if scatter is not None and strength else ""
    return [
        _group("material points"),
        ["at the start", number(str(n_start))],
        ["at the end", number(f"{n_points[-1]}, {n_points[-1] / n_start:.2f} of that")],
        ["most on the way", number(f"{most}, {most / n_start:.2f} of that")],
        ["volume ratio J", number(f"{low:.3f} to {high:.3f}")],
        ["mass changed by merging and splitting, worst step",
         number(whole(largest_known(history.mass_error), "", 2))],
        ["volume changed by them, worst step",
         number(whole(largest_known(history.volume_error), "", 2))],
        ["openings of sand that closed, all steps, over the volume of the soil",
         number(whole(_closed_share(installed), "", 2))],
        ["scatter of the pressure in a cell within a diameter of the pile, worst step",
         number(whole(scatter, "Pa", 2) + over)],
    ]  # fmt: skip


def _closed_share(installed: InstalledState) -> float | None:
    """Return the volume of closed openings over that of the soil; None if it was not recorded."""
    closed = installed.history.closed_volume
    known = closed[np.isfinite(closed)]
    return float(known.sum() / installed.material_points.volume.sum()) if len(known) else None


def winding_rows(history: ScrewHistory) -> list[Row]:
    """Return what winding the mesh back changed; nothing if it never was."""
    n_windings = int(np.isfinite(history.winding_stress_change).sum())
    if not n_windings:
        return []
    largest_energy = largest_known(history.winding_energy_change)
    return [
        _group(f"largest change by winding the mesh back, {n_windings} times"),
        ["stress at the integration points",
         number(whole(largest_known(history.winding_stress_change), "", 2))],
        ["vertical force of that stress on the pile",
         number(whole(largest_known(history.winding_force_change), "N", 2))],
        ["torque of that stress on the pile",
         number(whole(largest_known(history.winding_torque_change), "N m", 2))],
        ["energy of the stress in the soil", number(whole(largest_energy, "J", 2))],
    ]  # fmt: skip


def largest_known(values: np.ndarray) -> float | None:
    """Return the largest size of ``values`` (n,) that were recorded; None if none was."""
    known = np.abs(values[np.isfinite(values)])
    return float(known.max()) if len(known) else None


def points_per_step(installed: InstalledState) -> np.ndarray:
    """Return how many material points there were after each step, (n_steps,), the start first."""
    history = installed.history
    added = np.cumsum(history.injected_points - history.merged_points)
    n_points: np.ndarray = len(installed.material_points.mass) - added[-1] + np.append(0, added)
    return n_points


def balance_of(history: ScrewHistory) -> float:
    """Return the error of the power balance summed over all steps, over the work of the rig."""
    taken = history.interface_work + history.soil_work - history.weight_work
    rig = float(history.rig_work.sum())
    return abs(rig - float(taken.sum())) / abs(rig) if rig else 0.0


def _last_ratio(history: ScrewHistory) -> str:
    known = history.advancement_ratio[np.isfinite(history.advancement_ratio)]
    return significant(float(known[-1]), 3) if len(known) else "–"


def _largest(vectors: np.ndarray) -> float:
    return float(np.linalg.norm(vectors, axis=1).max())


def _group(title: str) -> Row:
    return group_row(title)[:2]


def part_table(parts: list[PartTorque], total: float) -> str:
    """Return the torque of each part in the last step beside its closed form."""
    head: Row = ["part", *map(number, ("along the surface", "closed form", "deviation", "normal",
                                       "sum", "share of all"))]  # fmt: skip
    rows: list[Row] = []
    for part in parts:
        deviation = part.deviation
        both = part.tangential + part.normal
        rows.append([
            part.name,
            number(whole(part.tangential, "N m", 3)),
            number(whole(part.closed_form, "N m", 3)),
            number("–" if deviation is None else _percent(deviation, signed=True)),
            number(whole(part.normal, "N m", 3)),
            number(whole(both, "N m", 3)),
            number(_percent(both / total) if total else "–"),
        ])  # fmt: skip
    with_form = [part for part in parts if part.closed_form is not None]
    along, across = (sum(getattr(p, name) for p in parts) for name in ("tangential", "normal"))
    form = sum(part.closed_form or 0.0 for part in with_form)
    compared = sum(part.tangential for part in with_form)
    rows.append([
        Cell("<b>sum</b>"),
        number(whole(along, "N m", 3)),
        number(whole(form if with_form else None, "N m", 3)),
        number(_percent(compared / form - 1.0, signed=True) if form else "–"),
        number(whole(across, "N m", 3)),
        number(whole(along + across, "N m", 3)),
        "",
    ])  # fmt: skip
    return table(head, rows)


def _percent(share: float, *, signed: bool = False) -> str:
    text = f"{100.0 * share:+.1f} %" if signed else f"{100.0 * share:.0f} %"
    return text.replace("-", "−")


def convergence_table(case: ScrewCase, history: ScrewHistory) -> str:
    """Return the statistics of Newton's method."""
    order = history.convergence_order[np.isfinite(history.convergence_order)]
    n_cut = int((history.cuts > 0).sum())
    rows: list[Row] = [
        ["steps", number(str(len(history.travel)))],
        ["iterations, mean", number(significant(float(history.iterations.mean()), 3))],
        ["iterations, most", number(str(int(history.iterations.max())))],
        ["steps that had to be halved", number(f"{n_cut} ({_percent(n_cut / len(history.cuts))})")],
        ["largest residual of an accepted step",
         number(significant(float(history.residual.max()), 2))],
        ["tolerance of the case", number(significant(case.numerics.tolerance, 2))],
    ]  # fmt: skip
    if len(order):
        quadratic = float((order >= QUADRATIC_ORDER).mean())
        rows.append(["order, median", number(significant(float(np.median(order)), 3))])
        rows.append([f"order ≥ {QUADRATIC_ORDER:g}",
                     number(f"{_percent(quadratic)} of {len(order)}")])  # fmt: skip
    return table([], rows)


def case_tables(case: ScrewCase) -> str:
    """Return what the case describes, a table for each section, in display units."""
    tables = "".join(
        f"<div><h3>{cell(spaced(section.name)).html}</h3>"
        f"{table([], option_rows(getattr(case, section.name)))}</div>"
        for section in fields(case)
        if is_dataclass(getattr(case, section.name))
    )
    return f'<div class="columns">{tables}</div>'


def time_table(seconds: dict[str, float], n_steps: int) -> str:
    """Return where the time of the installation went, in all and for each step."""
    total = sum(seconds.values()) or 1.0
    rows: list[Row] = [
        [phase, number(f"{value:.1f} s"), number(f"{1e3 * value / n_steps:.0f} ms"),
         number(_percent(value / total))]
        for phase, value in seconds.items()
    ]  # fmt: skip
    rows.append([Cell("<b>sum</b>"), number(f"{total:.1f} s"),
                 number(f"{1e3 * total / n_steps:.0f} ms"), ""])  # fmt: skip
    return table(["", number("time"), number("per step"), number("share")], rows)
