"""The report of a screw pile installation: one self-contained HTML page."""

from __future__ import annotations

import base64
import json
from html import escape
from pathlib import Path

from matplotlib.figure import Figure

from install_mpm.interface import InterfacePoints
from install_mpm.screw_history import driven
from install_mpm.state_file import InstalledState
from workflows import screw_report_curves as curves
from workflows import screw_report_ground as ground
from workflows import screw_report_service as in_service
from workflows.certified import warning_html
from workflows.directory import REPORT, TIMING, write_text
from workflows.interactive import interactive
from workflows.interactive_curves import torque_and_force
from workflows.interactive_space import view
from workflows.report import filled_page
from workflows.report_html import code, details, figure
from workflows.report_repeats import ratio_note
from workflows.report_sections import Section
from workflows.report_style import styled
from workflows.screw_animation import animation
from workflows.screw_case import ScrewCase
from workflows.screw_export import read_surface, stored_frames
from workflows.screw_frames import PileSurface, pile_surface, points_near_pile
from workflows.screw_report_tables import (
    balance_of,
    case_tables,
    convergence_table,
    part_table,
    summary_table,
    time_table,
    whole,
)
from workflows.screw_report_text import CAPTIONS, FORMS, FRICTION_NOTE, LIMITS, METHOD, TIME_NOTE
from workflows.screw_surface_pictures import tractions
from workflows.screw_theory import has_friction, part_torques

HEADING = "Screw pile installation · three dimensions · forces for the whole pile"


def write_screw_report(directory: Path, case: ScrewCase, installed: InstalledState) -> Path:
    """Write ``report.html`` into ``directory`` and return its path.

    The page opens without network: pictures, styles, text and scripts are all inside.  It has an
    animation if frames of the installation are stored in ``directory``.
    """
    with styled():
        parts = sections(directory, case, installed)
    page = filled_page(case.title, HEADING, subtitle(case, installed), parts)
    path = directory / REPORT
    write_text(path, page)
    return path


def sections(directory: Path, case: ScrewCase, installed: InstalledState) -> list[Section]:
    """Return all sections of the report, in order."""
    parts = _installation_sections(directory, case, installed)
    if case.service is None:
        return parts
    files = in_service.read_service_files(directory, case)
    first = parts[0]._replace(
        html=warning_html(files.certificate)
        + parts[0].html
        + "<h3>Installed against wished in place</h3>"
        + in_service.comparison_table(files)
        + ratio_note(files.summary["results"])
    )
    return [
        first,
        *parts[1:-2],
        Section("handoff", "Hand-over", in_service.handoff_html(case, installed, files)),
        Section("service", "Service", in_service.service_html(case, installed, files)),
        *parts[-2:],
        Section("provenance", "Provenance", in_service.provenance_html(files)),
    ]


def _installation_sections(
    directory: Path, case: ScrewCase, installed: InstalledState
) -> list[Section]:
    """Return the sections on the installation, the last two on checks and method."""
    return [
        Section("results", "Results", results_html(case, installed)),
        Section("case", "The case", case_html(case, installed)),
        Section(
            "installation", "Torque and crowd force", installation_html(directory, case, installed)
        ),
        Section("ground", "Pile and ground", ground_html(directory, case, installed)),
        Section("checks", "Checks", checks_html(directory, case, installed)),
        Section("method", "Method and limits", METHOD + LIMITS),
    ]


def subtitle(case: ScrewCase, installed: InstalledState) -> str:
    """Return the installation in one sentence."""
    pile, n, history = case.pile, len(case.pile.helices), driven(installed.history)
    plates = {0: "no helix", 1: "one helix"}.get(n, f"{n} helices")
    if n:
        largest = max(helix.diameter for helix in pile.helices)
        plates += f" of {whole(largest, 'm', 3)}"
    turned = abs(float(curves.turns(pile, history)[-1]))
    depth = pile.embedment + float(history.penetration[-1])
    return (
        f"A pile with a shaft of {whole(pile.shaft_diameter, 'm', 3)} and {plates}, taken from "
        f"{whole(pile.embedment, 'm', 3)} to {whole(depth, 'm', 3)} depth in {turned:.2f} turns."
    )


def results_html(case: ScrewCase, installed: InstalledState) -> str:
    """Return the figures that a reader looks for first, and the table of all."""
    history = driven(installed.history)
    depth = whole(case.pile.embedment + float(history.penetration[-1]), "m", 3)
    cards = (
        (whole(float(history.torque[-1]), "N m", 3), f"torque at {depth} tip depth"),
        (whole(float(history.crowd_force[-1]), "N", 3), "crowd force there, downward"),
        (whole(float(history.torque.max()), "N m", 3), "largest torque on the way"),
        (whole(100.0 * balance_of(history), "%", 2), "error of the power balance"),
    )
    html = "".join(
        f'<div class="card"><b>{escape(value)}</b><span>{escape(text)}</span></div>'
        for value, text in cards
    )
    return f'<div class="cards">{html}</div>' + summary_table(case, installed)


def case_html(case: ScrewCase, installed: InstalledState) -> str:
    """Return the case as a table, and as text to run it again."""
    return case_tables(case) + details(
        "Case file, complete and in SI units", code(installed.case_text)
    )


def caption(name: str) -> str:
    """Return the caption of a figure as one line of text."""
    return " ".join(CAPTIONS[name].split())


def captioned(name: str, picture: Figure) -> str:
    """Return a picture with the caption of its name."""
    return figure(name, picture, caption(name))


def installation_html(directory: Path, case: ScrewCase, installed: InstalledState) -> str:
    """Return curves of torque, crowd force, their parts and side forces."""
    history, pile = driven(installed.history), case.pile
    parts = part_torques(pile, installed, driven_surface(directory, installed))
    picture = curves.torque_and_force(case, installed.history)
    plot = torque_and_force(case, installed.history)
    return "\n".join(
        [
            interactive("torque", picture, plot, caption("torque")),
            captioned("parts", curves.torque_by_part(pile, history, parts)),
            part_table(parts, float(history.torque[-1])),
            forms_html(installed.interface),
            captioned("side", curves.side_forces(pile, history)),
        ]
    )


def driven_surface(directory: Path, installed: InstalledState) -> PileSurface | None:
    """Return the pile surface in the last step in which the rig drove; None if not stored."""
    last = len(driven(installed.history).travel) - 1
    if last == len(installed.history.travel) - 1:
        return pile_surface(installed.interface)
    return read_surface(directory, last) if last in stored_frames(directory) else None


def forms_html(interface: InterfacePoints) -> str:
    """Return what the closed forms are."""
    return FORMS.format(friction=FRICTION_NOTE if has_friction(interface) else "")


def ground_html(directory: Path, case: ScrewCase, installed: InstalledState) -> str:
    """Return the pictures of pile and ground, and the animation if frames are stored."""
    surface = pile_surface(installed.interface)
    picture = tractions(case.pile, surface, ground.pose_of(installed))
    plot = view(surface, points_near_pile(installed), case.ground)
    parts = [
        captioned("vertical", ground.vertical(case, installed)),
        captioned("horizontal", ground.horizontal(case, installed)),
        interactive("tractions", picture, plot, caption("tractions")),
    ]
    moving = animation(directory, case, installed.history)
    if moving is not None:
        parts.insert(0, animation_html(moving))
    return "\n".join(parts)


def animation_html(gif: bytes) -> str:
    """Return an animation with its caption."""
    words = escape(caption("animation"))
    content = base64.b64encode(gif).decode("ascii")
    return (
        '<figure id="animation"><img style="width: 100%; border-radius: 8px" '
        f'alt="{words}" src="data:image/gif;base64,{content}">'
        f"<figcaption>{words}</figcaption></figure>"
    )


def checks_html(directory: Path, case: ScrewCase, installed: InstalledState) -> str:
    """Return power balance, far field, Newton's method, what was irregular, and the time."""
    history, pile = driven(installed.history), case.pile
    parts = [
        captioned("work", curves.work(pile, history)),
        captioned("far", curves.far_field(case, history)),
        captioned("newton", curves.convergence(pile, history)),
        convergence_table(case, installed.history),
        captioned("irregular", curves.irregularities(pile, history)),
    ]
    if (directory / TIMING).exists():
        seconds = json.loads((directory / TIMING).read_text(encoding="utf-8"))
        parts += ["<h3>Time</h3>", TIME_NOTE, time_table(seconds, len(installed.history.travel))]
    return "\n".join(parts)
