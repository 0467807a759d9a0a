"""Sections of the report: what is shown, in which order, and what is said about it."""

from __future__ import annotations

from html import escape
from typing import NamedTuple

from matplotlib.figure import Figure

from workflows import (
    interactive_curves,
    report_handoff,
    report_installation,
    report_service,
    report_tables,
)
from workflows.case import Case
from workflows.certified import warning_html
from workflows.interactive import interactive
from workflows.report_data import Results
from workflows.report_html import code, details, figure
from workflows.report_repeats import ratio_note
from workflows.report_text import CAPTIONS, LIMITS, METHOD, SHAPE_LIMITS
from workflows.report_units import shown, significant


class Section(NamedTuple):
    """Part of the page with a heading of its own."""

    name: str
    title: str
    html: str


def sections(results: Results) -> list[Section]:
    """Return all sections of the report, in order."""
    return [
        Section("results", "Results", results_html(results)),
        Section("case", "The case", case_html(results)),
        Section("installation", "Installation", installation_html(results)),
        Section("convergence", "Convergence", convergence_html(results)),
        Section("handoff", "Hand-over", handoff_html(results)),
        Section("service", "Service", service_html(results)),
        Section("method", "Method and limits", METHOD + limits_html(results.case)),
        Section("provenance", "Provenance", provenance_html(results)),
    ]


def results_html(results: Results) -> str:
    """Return cards, failed checks and the headline table."""
    warning = warning_html(results.certificate)
    note = (
        "<p>B is the pile's width. Downward displacement and load are positive, so uplift is "
        "negative.</p>"
    )
    worth = ratio_note(results.summary["results"])
    return cards_html(results) + warning + report_tables.headline_table(results) + note + worth


def cards_html(results: Results) -> str:
    """Return the figures that a reader looks for first."""
    figures = results.summary["results"]
    installation = figures["installation"]
    depth = shown(installation["tip_depth_m"], "m", 3)
    force = shown(installation["crowd_force_N"], "N", 4, results.case.kinematics)
    cards = [(force, f"installation force at {depth} tip depth")]
    for name, programme in figures["service"].items():
        ratio = programme.get("ratio", {}).get("capacity")
        if ratio is not None:
            deviation = programme.get("ratio_range", {}).get("capacity")
            change = _percent(ratio - 1.0, deviation)
            spaced = escape(report_tables.spaced(name))
            cards.append((change, f"capacity in {spaced} against wished in place"))
    for shares in figures["continuity"].values():
        for share in list(shares.values())[-1:]:
            cards.append((significant(share, 3), "resistance pushed on over installation force"))
    html = (f'<div class="card"><b>{value}</b><span>{text}</span></div>' for value, text in cards)
    return f'<div class="cards">{"".join(html)}</div>'


def _percent(change: float, deviation: float | None) -> str:
    """Return a change in per cent, with its range if it has one."""
    text = f"{100.0 * change:+.1f}".replace("-", "−")
    return f"{text} %" if deviation is None else f"{text} ± {100.0 * deviation:.1f} %"


def case_html(results: Results) -> str:
    """Return the case as a table, and as text to run it again."""
    return report_tables.case_tables(results.case) + details(
        "Case file, complete and in SI units", code(results.case_text)
    )


def caption(name: str) -> str:
    """Return the caption of a figure as one line of text."""
    return " ".join(CAPTIONS[name].split())


def captioned(name: str, picture: Figure) -> str:
    """Return a picture with the caption of its name."""
    return figure(name, picture, caption(name))


def installation_html(results: Results) -> str:
    """Return the pictures of the installation; a pile that was not moved has no force."""
    case, installed = results.case, results.installed
    parts = []
    if float(installed.pile.penetration) > 0.0:
        force = report_installation.force_against_depth(case, installed.history)
        plot = interactive_curves.force_against_depth(case, installed.history)
        parts.append(interactive("force", force, plot, caption("force")))
    parts.append(captioned("points", report_installation.mesh_and_points(case, installed)))
    parts.append(captioned("stress", report_installation.stresses(case, installed)))
    return "\n".join(parts)


def convergence_html(results: Results) -> str:
    """Return the history of Newton's method and what was irregular."""
    history = results.installed.history
    return "\n".join(
        [
            captioned("newton", report_installation.convergence(history)),
            report_tables.convergence_table(results.summary["convergence"]),
            captioned("irregular", report_installation.irregularities(history)),
        ]
    )


def handoff_html(results: Results) -> str:
    """Return the pictures of the hand-over and the certificate."""
    case, installed, handed_off = results.case, results.installed, results.handed_off
    certificate, kinematics = results.certificate, case.kinematics
    return "\n".join(
        [
            captioned("handed_off", report_handoff.stress_handed_over(case, installed, handed_off)),
            captioned("tractions", report_handoff.tractions(installed, handed_off)),
            "<h3>Certificate</h3>",
            report_tables.certificate_table(certificate, kinematics, with_limit=True),
            details(
                "Figures for information",
                report_tables.certificate_table(certificate, kinematics, with_limit=False),
            ),
        ]
    )


def service_html(results: Results) -> str:
    """Return curves, continuity and mechanisms."""
    case, service, wished = results.case, results.service, results.wished
    picture = report_service.curves(case, service, wished)
    plot = interactive_curves.service_curves(case, service, wished)
    parts = [interactive("curves", picture, plot, caption("curves"))]
    continuity = report_service.continuity(case, results.installed, service)
    if continuity is not None:
        parts.append(captioned("continuity", continuity))
    for number, result in enumerate(service.programmes):
        name, start = result.programme.name, getattr(result.programme, "start", None)
        if start == "released":
            picture = report_service.mechanism(case, service, wished, name)
            text = caption("mechanism").format(report_tables.spaced(name))
            parts.append(figure(f"mechanism_{number}", picture, text))
    return "\n".join(parts)


def limits_html(case: Case) -> str:
    """Return what limits the answer, the shape of the pile first."""
    return LIMITS.format(shape=SHAPE_LIMITS[case.kinematics])


def provenance_html(results: Results) -> str:
    """Return timings, versions, hashes and seeds."""
    summary = results.summary
    return "\n".join(
        [
            report_tables.timing_table(summary["timings_s"]),
            report_tables.version_table(summary["versions"]),
            report_tables.hash_table(summary),
        ]
    )
