"""The report: one self-contained HTML page made from the files of a results directory."""

from __future__ import annotations

from html import escape
from pathlib import Path
from string import Template

from install_mpm.conventions import Kinematics
from workflows.directory import REPORT, write_text
from workflows.interactive import TEMPLATES, scripts
from workflows.manifest import created_by
from workflows.report_data import Results, read_results
from workflows.report_sections import Section, sections
from workflows.report_style import styled
from workflows.report_units import PER_LENGTH, shown


def write_report(directory: Path) -> Path:
    """Write ``report.html`` into ``directory`` from the results in it; return its path.

    The page opens without network: pictures, styles, text and scripts are all inside.

    Raises
    ------
    DirectoryError
        If the directory or one of its JSON files is missing or damaged, or a file belongs to
        another case.
    StateFileError
        If a state file is missing or damaged.
    """
    results = read_results(directory)
    with styled():
        page = page_html(results, sections(results))
    path = directory / REPORT
    write_text(path, page)
    return path


def page_html(results: Results, parts: list[Section]) -> str:
    """Return the whole page."""
    kinematics = results.case.kinematics
    name = kinematics.name.lower().replace("_", " ")
    forces = "forces for the w" + PER_LENGTH[kinematics][1:-1]
    heading = f"Pile installation and service · {name} · {forces}"
    return filled_page(results.case.title, heading, _subtitle(results), parts)


def filled_page(title: str, heading: str, subtitle: str, parts: list[Section]) -> str:
    """Return a page with ``parts``; title, heading and subtitle are plain text."""
    template = Template((TEMPLATES / "report.html").read_text(encoding="utf-8"))
    content = "\n".join(
        f'<section id="{part.name}"><h2>{escape(part.title)}</h2>\n{part.html}\n</section>'
        for part in parts
    )
    return template.substitute(
        title=escape(title),
        heading=escape(heading),
        subtitle=escape(subtitle),
        css=(TEMPLATES / "report.css").read_text(encoding="utf-8"),
        contents=" ".join(f'<a href="#{part.name}">{escape(part.title)}</a>' for part in parts),
        sections=content,
        scripts=scripts(content),
        created_by=escape(created_by()),
    )


def _subtitle(results: Results) -> str:
    """Return the installation in one sentence."""
    pile, tip_depth = results.case.pile, float(results.installed.pile.tip_depth)
    width, depth = shown(pile.width, "m", 3), shown(tip_depth, "m", 3)
    is_round = results.case.kinematics == Kinematics.AXISYMMETRIC
    what = f"A round pile {width} in diameter" if is_round else f"A pile {width} wide"
    if float(results.installed.pile.penetration) == 0.0:
        return f"{what} at {depth} depth, not moved."
    return f"{what}, jacked from {shown(pile.embedment, 'm', 3)} to {depth} depth."
