"""Tables of the report: headline, case, certificate, convergence, provenance."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from typing import Any, get_args, get_type_hints

from install_mpm.conventions import Kinematics, Unit
from service_fe.options import Displace, Programme, Release
from service_fe.results import LINEAR_WORK
from workflows.case import Case
from workflows.report_data import Results
from workflows.report_html import Cell, badge, cell, number, table
from workflows.report_units import plain, shown, significant, value_and_range

MODELS = ("installed", "wished_in_place")

CURVE_FIGURES = {
    "initial_stiffness": ("initial stiffness", "N/m"),
    "capacity": ("capacity at 0.1 B", "N"),
    "tangent_capacity": ("capacity where the tangents meet", "N"),
}

SECTIONS = (
    "ground", "pile", "interface", "box", "background_mesh", "discretisation", "installation",
    "handoff",
)  # fmt: skip
"""Sections of the case that the table shows; the rest stands in the text of the case."""

NAMES = {
    "k0": "K₀", "youngs_modulus": "Young's modulus", "poissons_ratio": "Poisson's ratio",
    "helices": "helix", "phases": "phase", "layers": "layer", "programmes": "programme",
}  # fmt: skip
"""Words for names of the code that do not read as such."""

Row = list[str | Cell]


def headline_table(results: Results) -> str:
    """Return the table of headline results: installation, service of both models, continuity."""
    figures, kinematics = results.summary["results"], results.case.kinematics
    head: Row = ["", *(number(text) for text in ("installed", "wished in place", "ratio"))]
    rows: list[Row] = [group_row("installation")]
    installation = figures["installation"]
    for key, text in (
        ("crowd_force_N", "installation force at the end"),
        ("base_force_N", "soil reaction on the base"),
        ("shaft_force_N", "soil reaction on the shaft"),
    ):
        rows.append([text, number(shown(installation[key], "N", 4, kinematics)), "", ""])
    low, high = installation["smallest_volume_ratio"], installation["largest_volume_ratio"]
    volume = number(f"{low:.3f} to {high:.3f}")
    rows.append(["volume over initial volume of the material points", volume, "", ""])
    for name, programme in figures["service"].items():
        rows.extend(_programme_rows(name, programme, kinematics))
    for name, shares in figures["continuity"].items():
        rows.append(group_row(f"continuity: {spaced(name)}"))
        for key, share in shares.items():
            text = f"resistance at {key.split('_at_')[1].replace('_', ' ')} over installation force"
            rows.append([text, number(significant(share, 3)), "", ""])
    return table(head, rows)


def _programme_rows(
    name: str, programme: dict[str, dict[str, Any]], kinematics: Kinematics
) -> Iterator[Row]:
    """Yield the rows of one programme of the service stage."""
    if "head_load_before_N" in programme["installed"]:
        yield group_row(spaced(name))
        for key, text, unit in (
            ("head_load_before_N", "head load before", "N"),
            ("displacement_m", "displacement, downward", "mm"),
        ):
            scale = 1e3 if unit == "mm" else 1.0
            values = [scale * programme[model][key] for model in MODELS]
            yield [text, *(number(shown(value, unit, 3, kinematics)) for value in values), ""]
    elif "ratio" in programme:
        yield group_row(spaced(name))
        for key, (text, unit) in CURVE_FIGURES.items():
            values = [programme[model][f"{key}_{unit}"] for model in MODELS]
            ratio, deviation = programme["ratio"][key], programme.get("ratio_range", {}).get(key)
            yield [
                text,
                *(number(shown(value, unit, 4, kinematics)) for value in values),
                number(value_and_range(ratio, deviation)),
            ]


def group_row(title: str) -> Row:
    """Return a row that opens a group of a table."""
    return [Cell(cell(title).html, "group"), "", "", ""]


def spaced(name: str) -> str:
    """Return a name of the code as words."""
    return name.replace("_", " ")


def case_tables(case: Case) -> str:
    """Return what the case describes, a table for each section, in display units."""
    titles = {section: list(option_rows(getattr(case, section))) for section in SECTIONS}
    titles["service"] = [_programme_row(programme) for programme in case.service.programmes]
    tables = "".join(
        f"<div><h3>{cell(spaced(section)).html}</h3>{table([], rows)}</div>"
        for section, rows in titles.items()
    )
    return f'<div class="columns">{tables}</div>'


def _programme_row(programme: Programme) -> Row:
    """Return what a programme of the service stage does to the pile."""
    if isinstance(programme, Release):
        return [spaced(programme.name), f"head load to zero in {programme.steps} steps"]
    if not isinstance(programme, Displace):
        rows = [(cell(row[0]).html, cell(row[1]).html) for row in option_rows(programme)]
        options = ", ".join(f"{name} {value}" for name, value in rows if name != "name")
        return [spaced(programme.name), Cell(options)]
    direction = "down" if programme.displacement > 0.0 else "up"
    distance = f"{1e3 * abs(programme.displacement):g} mm {direction}"
    return [spaced(programme.name), f"{distance}, from the {programme.start} pile"]


def option_rows(options: Any) -> Iterator[Row]:
    """Yield name and value of each field of an option dataclass, with those of nested ones.

    An option that is not given has no row.
    """
    hints = get_type_hints(type(options), include_extras=True)
    for field in fields(options):
        value = getattr(options, field.name)
        if hasattr(value, "__dataclass_fields__"):
            yield from option_rows(value)
            continue
        if isinstance(value, tuple) and value and hasattr(value[0], "__dataclass_fields__"):
            for position, entry in enumerate(value, 1):
                yield [Cell(cell(f"{NAMES[field.name]} {position}").html, "group"), ""]
                yield from option_rows(entry)
            continue
        if value is None:
            continue
        metadata = get_args(hints[field.name])[1:]
        unit = next((entry.symbol for entry in metadata if isinstance(entry, Unit)), "")
        yield [NAMES.get(field.name, spaced(field.name)), number(plain(value, unit))]


def certificate_table(
    certificate: dict[str, dict[str, Any]], kinematics: Kinematics, *, with_limit: bool
) -> str:
    """Return the figures of the certificate that have a limit, or those that have none."""
    rows: list[Row] = []
    for name, figure in certificate.items():
        limit, unit = figure["limit"], figure["unit"]
        if (limit is not None) != with_limit:
            continue
        row: Row = [
            figure["meaning"],
            number(shown(figure["value"], unit, 3, kinematics)),
        ]
        if with_limit:
            row += [number(plain(limit, unit)), badge(figure["is_met"])]
        rows.append([*row, Cell(f"<code>{cell(name).html}</code>")])
    head: Row = ["figure", number("value"), "name"]
    if with_limit:
        head[2:2] = [number("limit"), ""]
    return table(head, rows)


def convergence_table(convergence: dict[str, Any]) -> str:
    """Return the statistics of Newton's method in the installation and in every programme."""
    head: Row = ["", *map(number, ("steps", "iterations, mean", "halvings", "largest residual",
                                   "order, median", "order ≥ 1.8", "viscous", "factorisations",
                                   "GMRES", "fallbacks to MUMPS"))]  # fmt: skip
    rows = [_convergence_row("installation", convergence["installation"])]
    for model in MODELS:
        for name, figures in convergence.get(model, {}).items():
            rows.append(_convergence_row(f"{spaced(name)}, {spaced(model)}", figures))
    return table(head, rows)


def _convergence_row(name: str, figures: dict[str, Any]) -> Row:
    share, order = figures["share_quadratic"], figures["median_order"]
    texts = (
        str(figures["steps"]),
        significant(figures["mean_iterations"], 2),
        str(figures["cuts"]),
        significant(figures["largest_residual"], 2),
        "–" if order is None else significant(order, 3),
        "–" if share is None
        else f"{100.0 * share:.0f} % of {figures['steps_with_known_order']}",
        "–" if not figures.get("largest_viscous_share")
        else f"{100.0 * figures['largest_viscous_share']:.2f} %",
        *(str(figures.get(name, "–")) for name in LINEAR_WORK),
    )  # fmt: skip
    return [name, *map(number, texts)]


def timing_table(timings: dict[str, float]) -> str:
    """Return the seconds that each stage took."""
    rows: list[Row] = [
        [spaced(name), number(f"{seconds:.1f} s")] for name, seconds in timings.items()
    ]
    rows.append(["sum", number(f"{sum(timings.values()):.1f} s")])
    return table(["stage", number("time")], rows)


def version_table(versions: dict[str, str]) -> str:
    """Return the versions of the program and of the libraries that decide results."""
    return table(["software", "version"], [[name, text] for name, text in versions.items()])


def hash_table(summary: dict[str, Any]) -> str:
    """Return the SHA-256 of the case and of every file of results, and the seeds."""
    rows: list[Row] = [["case", Cell(cell(summary["case_sha256"]).html, "hash")]]
    rows += [
        [name, Cell(cell(value).html, "hash")] for name, value in summary["files_sha256"].items()
    ]
    rows += [[name, str(value)] for name, value in summary["seeds"].items()]
    return table(["file", "SHA-256"], rows)
