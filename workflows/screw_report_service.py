"""Sections of the report of a screw pile in service: results, hand-over, curves, pictures."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from handoff.fe_state_file import FEIntegrationPoints, FEState
from install_mpm.conventions import Kinematics
from install_mpm.ground import soils_of
from install_mpm.state_file import InstalledState
from service_fe.results import ServiceResult, without_pile
from workflows import directory as names
from workflows.interactive import interactive
from workflows.interactive_curves import service_curves
from workflows.report_data import read_json
from workflows.report_fields import colour_bar, symmetric_norm
from workflows.report_html import Cell, details, figure, number, table
from workflows.report_service import curves
from workflows.report_style import DIVERGING, INK, panels
from workflows.report_tables import (
    MODELS,
    certificate_table,
    convergence_table,
    group_row,
    hash_table,
    spaced,
    timing_table,
    version_table,
)
from workflows.report_units import significant, value_and_range
from workflows.screw_along import along_pile, lateral_programmes
from workflows.screw_case import ScrewCase
from workflows.screw_continuity import continuity, continuity_table
from workflows.screw_cycles import cycles_picture, cycles_plot, cyclic_programmes
from workflows.screw_frames import PointCloud
from workflows.screw_report_ground import pose_of
from workflows.screw_report_text import SERVICE_CAPTIONS, SERVICE_LIMITS
from workflows.screw_shaft import shaft_tractions
from workflows.screw_slices import (
    draw_slice,
    mean_pressure_change,
    soil_pixels,
    vertical_slice,
)
from workflows.state_files import read_checked

SPACE = Kinematics.THREE_D

UNIT_NAMES = {"N/m": "kN/mm", "N": "kN", "N m/rad": "kN m/rad", "N m": "kN m"}
SCALES = {"N/m": 1e-6, "N": 1e-3, "N m/rad": 1e-3, "N m": 1e-3}


class ServiceFiles(NamedTuple):
    """What the stages after the installation left in a results directory."""

    handed_off: Any
    service: ServiceResult
    wished: ServiceResult
    certificate: dict[str, dict[str, Any]]
    summary: dict[str, Any]


def read_service_files(directory: Path, case: ScrewCase) -> ServiceFiles:
    """Return the results of the stages after the installation.

    Raises
    ------
    StateFileError, DirectoryError
        If a file is missing or damaged, or belongs to another case.
    """
    n_soils = len(soils_of(case.ground))
    return ServiceFiles(
        handed_off=read_checked(directory, names.HANDED_OFF, case),
        service=without_pile(read_checked(directory, names.SERVICE, case), n_soils),
        wished=without_pile(read_checked(directory, names.WISHED_SERVICE, case), n_soils),
        certificate=read_json(directory / names.CERTIFICATE, "screwpile handoff"),
        summary=read_json(directory / names.SUMMARY, "screwpile compare"),
    )


def comparison_table(files: ServiceFiles) -> str:
    """Return stiffness and capacities of both models in every programme, and their ratio.

    Below it stands what the ratio is worth.
    """
    head: list[str | Cell] = ["", *map(number, ("installed", "wished in place", "ratio"))]
    rows: list[list[str | Cell]] = []
    for name, programme in files.summary["results"]["service"].items():
        if "ratio" not in programme:
            continue
        rows.append(group_row(spaced(name)))
        deviations = programme.get("ratio_range", {})
        for key, ratio in programme["ratio"].items():
            unit = next(k for k in programme["installed"] if k.startswith(f"{key}_"))
            unit = unit.removeprefix(f"{key}_")
            values = [programme[model][f"{key}_{unit}"] for model in MODELS]
            rows.append(
                [
                    f"{spaced(key)} ({UNIT_NAMES[unit]})",
                    *(number(_scaled(value, unit)) for value in values),
                    number(value_and_range(ratio, deviations.get(key))),
                ]
            )
    return table(head, rows)


def _scaled(value: float | None, unit: str) -> str:
    return "–" if value is None else significant(SCALES[unit] * value, 4)


def caption(name: str) -> str:
    """Return the caption of a figure as one line of text."""
    return " ".join(SERVICE_CAPTIONS[name].split())


def captioned(name: str, picture: Figure) -> str:
    """Return a picture with the caption of its name."""
    return figure(name, picture, caption(name))


def handoff_html(case: ScrewCase, installed: InstalledState, files: ServiceFiles) -> str:
    """Return the stress and the tractions handed over, and the certificate."""
    return "\n".join(
        [
            captioned("handed_off", stress_picture(case, installed, files)),
            captioned("shaft", shaft_tractions(case, installed, files.handed_off)),
            "<h3>Certificate</h3>",
            certificate_table(files.certificate, SPACE, with_limit=True),
            details(
                "Figures for information",
                certificate_table(files.certificate, SPACE, with_limit=False),
            ),
        ]
    )


def stress_picture(case: ScrewCase, installed: InstalledState, files: ServiceFiles) -> Figure:
    """Return the change of mean pressure in both models of the ground, in a vertical plane."""
    plane = vertical_slice(
        case.pile, float(installed.pile.tip_depth), case.box.headroom, case.box.width
    )
    left, right, bottom, top = plane.extent
    figure_, axes = panels(1, 2, 10.0, 4.6 * (top - bottom) / (right - left) + 1.0, sharey=True)
    handed_off = files.handed_off
    clouds = (
        fe_cloud(handed_off.integration, handed_off.state),
        fe_cloud(files.wished.integration, files.wished.programmes[-1].state),
    )
    last = files.wished.programmes[-1].programme.name
    titles = ("installed, handed over", f"wished in place, after {spaced(last)}")
    norm = None
    for here, cloud, title in zip(axes[0], clouds, titles, strict=True):
        soil = soil_pixels(plane, cloud, case.pile, pose_of(installed))
        change = mean_pressure_change(case.ground, cloud)
        if norm is None:
            norm = symmetric_norm(change[np.unique(soil.index[soil.index >= 0])])
        drawn = draw_slice(here, plane, soil, change, norm, DIVERGING)
        here.plot([left, right], [0.0, 0.0], color=INK, linewidth=0.7, dashes=(6, 4))
        here.set(xlabel="x (m)", title=title)
    axes[0, 0].set(ylabel="z (m)")
    colour_bar(figure_, drawn, axes[0], "change of mean pressure (kPa)", "both")
    return figure_


def fe_cloud(integration: FEIntegrationPoints, state: FEState) -> PointCloud:
    """Return the integration points of a finite-element model as points that pictures show."""
    pressure = -np.trace(state.cauchy_stress, axis1=1, axis2=2) / 3.0
    still = np.zeros_like(integration.position)
    return PointCloud(integration.position, still, pressure, integration.volume)


def cycles_html(files: ServiceFiles, name: str) -> str:
    """Return what the cycles of a programme leave behind."""
    return interactive(
        f"cycles-{name}",
        cycles_picture(files.service, files.wished, name),
        cycles_plot(files.service, files.wished, name),
        f"{spaced(name)}: {caption('cycles')}",
    )


def continuity_html(case: ScrewCase, installed: InstalledState, files: ServiceFiles) -> str:
    """Return how the pile that is moved on takes up the installation's loads; nothing if it is not.

    Loads of a pile without installation cannot be continued.
    """
    results = files.summary["results"]
    if not results["continuity"]:
        return ""
    picture = captioned("continuity", continuity(case, installed, files.service))
    return f"<h3>Continuity</h3>{picture}{continuity_table(results)}"


def service_html(case: ScrewCase, installed: InstalledState, files: ServiceFiles) -> str:
    """Return curves, figures, convergence and what limits them."""
    return "\n".join(
        [
            interactive(
                "curves",
                curves(case, files.service, files.wished),
                service_curves(case, files.service, files.wished),
                caption("curves"),
            ),
            comparison_table(files),
            *(
                figure(
                    f"along-{name}",
                    along_pile(files.service, files.wished, name),
                    f"{spaced(name)}: {caption('along')}",
                )
                for name in lateral_programmes(files.service)
            ),
            *(cycles_html(files, name) for name in cyclic_programmes(files.service)),
            continuity_html(case, installed, files),
            "<h3>Convergence</h3>",
            convergence_table(files.summary["convergence"]),
            SERVICE_LIMITS,
        ]
    )


def provenance_html(files: ServiceFiles) -> str:
    """Return timings, versions, hashes and seeds."""
    summary = files.summary
    return "\n".join(
        [
            timing_table(summary["timings_s"]),
            version_table(summary["versions"]),
            hash_table(summary),
        ]
    )
