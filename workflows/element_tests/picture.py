"""Table and picture of a laboratory test."""

from __future__ import annotations

import csv
import io
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from install_mpm.constitutive.element_driver import Element
from workflows.element_tests.figures import Curves, curves_of
from workflows.element_tests.paths import LaboratoryTest, Sample
from workflows.report_style import SEQUENTIAL, grid, panels

Axis = tuple[str, np.ndarray]
"""Label, and values in display units."""


def table_csv(columns: dict[str, np.ndarray]) -> str:
    """Return the table of a test as CSV text, in SI units."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(
        [repr(float(value)) for value in row] for row in np.column_stack(list(columns.values()))
    )
    return text.getvalue()


def picture(
    title: str, test: LaboratoryTest, samples: list[Sample], paths: list[list[Element]]
) -> Figure:
    """Return the three diagrams of a test, one line for each sample."""
    figure, axes = panels(1, 3, 10.0, 3.4)
    colours = mpl.colormaps[SEQUENTIAL](np.linspace(0.15, 0.75, len(paths)))
    for sample, path, colour in zip(samples, paths, colours, strict=True):
        label = f"{sample.pressure / 1e3:.4g} kPa"
        for here, (across, up) in zip(axes[0], diagrams(test, curves_of(path)), strict=True):
            here.plot(across[1], up[1], color=colour, label=label, linewidth=1.3)
            _finish(here, across[0], up[0])
    axes[0, 0].legend(title="consolidated under")
    axes[0, 0].set_title(title)
    return figure


def diagrams(test: LaboratoryTest, curves: Curves) -> list[tuple[Axis, Axis]]:
    """Return what is plotted: stress by strain, volume or pressure by strain, stress path."""
    axial = ("axial strain (%)", 100.0 * curves.axial_strain)
    gamma = ("shear strain (%)", 100.0 * curves.shear_strain)
    volume = ("volumetric strain (%)", 100.0 * curves.volumetric_strain)
    excess = ("excess pore pressure (kPa)", curves.pore_pressure / 1e3)
    vertical = ("effective vertical stress (kPa)", curves.vertical_stress / 1e3)
    q = ("deviatoric stress q (kPa)", curves.deviatoric_stress / 1e3)
    tau = ("shear stress (kPa)", curves.shear_stress / 1e3)
    pressure = ("effective mean pressure (kPa)", curves.mean_pressure / 1e3)
    if test.is_shear:
        return [(gamma, tau), (gamma, vertical if test.is_undrained else volume), (vertical, tau)]
    if test.is_isotropic:
        return [(axial, q), (axial, excess if test.is_undrained else volume), (pressure, q)]
    horizontal = ("horizontal stress (kPa)", curves.horizontal_stress / 1e3)
    return [(axial, vertical), (vertical, horizontal), (pressure, q)]


def _finish(axes: Any, across: str, up: str) -> None:
    axes.set_xlabel(across)
    axes.set_ylabel(up)
    grid(axes)
