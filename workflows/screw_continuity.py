"""What the report of a screw pile shows of continuity: torque and force when it is moved on."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from install_mpm.screw_history import driven
from install_mpm.state_file import InstalledState
from service_fe.results import ServiceResult
from workflows.continuity import FORCE, TORQUE, is_moved_on, moved_on
from workflows.report_html import Cell, number, table
from workflows.report_style import INK, INSTALLED, MUTED, WISHED, grid, panels
from workflows.report_tables import group_row, spaced
from workflows.report_units import significant
from workflows.screw_case import ScrewCase

SHOWN_BEFORE = 4.0
"""Way of the installation that is shown, over that of the programmes that move the pile on."""

BAND = 0.1
"""Share of the installation's last torque and force that is marked to both sides."""

COLOURS = (INSTALLED, WISHED, MUTED)


def continuity_table(results: dict[str, Any]) -> str:
    """Return the loads on the pile that is moved on over those of the installation.

    Of the run, and of each repeat.
    """
    repeats = results.get("repeats", {}).values()
    head: list[str | Cell] = ["", number("run"), *(number(repeat["what"]) for repeat in repeats)]
    rows: list[list[str | Cell]] = []
    for name, figures in results["continuity"].items():
        rows.append(group_row(spaced(name)))
        for key, share in figures.items():
            values = [share, *(repeat["continuity"][name][key] for repeat in repeats)]
            rows.append([spaced(key), *(number(significant(value, 3)) for value in values)])
    return table(head, rows)


def continuity(case: ScrewCase, installed: InstalledState, service: ServiceResult) -> Figure:
    """Return torque and force of the installation, and of the pile that is moved on from its end.

    The way of a pile that turns is that of its rim.
    """
    history = driven(installed.history)
    turned = -case.pile.sense * (history.rotation - history.rotation[-1]) * case.pile.width / 2.0
    figure, axes = panels(1, 2, 10.0, 3.4)
    results = [result for result in service.programmes if is_moved_on(result.programme)]
    for here, name, before, label in (
        (axes[0, 0], TORQUE, history.torque, "torque (kN m)"),
        (axes[0, 1], FORCE, history.crowd_force, "force, downward (kN)"),
    ):
        here.plot(1e3 * turned, before / 1e3, color=INK, label="installation (material points)")
        reach = 0.0
        for result, colour in zip(results, np.resize(COLOURS, len(results)), strict=True):
            way, loads = moved_on(case, result)
            if name in loads:
                text = f"{spaced(result.programme.name)} (finite elements)"
                here.plot(1e3 * way, loads[name] / 1e3, ".-", color=str(colour), label=text)
                reach = max(reach, 1e3 * float(way[-1]))
        last = float(before[-1]) / 1e3
        band = here.fill_between(
            [0.0, reach], (1.0 - BAND) * last, (1.0 + BAND) * last, color=MUTED, alpha=0.25
        )
        band.set(linewidth=0.0, label=f"±{100.0 * BAND:g} % of the last {label.split()[0]}")
        here.set_xlim(-SHOWN_BEFORE * reach, 1.1 * reach)
        here.set(xlabel="way of the rim since the rig stopped (mm)", ylabel=label)
        here.legend(loc="lower left")
        grid(here)
    return figure
