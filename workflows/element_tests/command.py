"""``screwpile element-test``: which soil, which tests, and what is written."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from install_mpm.constitutive.element_driver import Element, ElementTestError
from install_mpm.conventions import Unit
from install_mpm.ground import GroundProfile, Stratum, geostatic_stress, strata
from workflows.directory import write_text
from workflows.element_tests.figures import curves_of, key_figures, table_of
from workflows.element_tests.paths import TESTS, Sample, run_test, skeleton_of
from workflows.element_tests.picture import picture, table_csv
from workflows.errors import CaseError
from workflows.overrides import apply_overrides
from workflows.quantities import parse_quantity
from workflows.report_style import png_of, styled
from workflows.report_units import shown
from workflows.schema import build, suggestion
from workflows.soil_template import soil_example
from workflows.soil_typical import TYPICAL

VERTICAL = 1
LARGEST_SHEAR = 100.0
"""Shear strain up to which remoulding can be followed; axial strains end at 1."""
DEPTH_OF_SAMPLE = 5.0
"""Depth in m of the sample of a layer that has no lower end, or its middle if that is higher."""


def run(
    source: str,
    output: Path,
    layer: str | None = None,
    names: Sequence[str] = (),
    pressures: Sequence[str] = (),
    strain: float | None = None,
    overrides: Sequence[str] = (),
) -> str:
    """Run the tests ``names`` (all if none) of a soil; return the key figures as text.

    Raises
    ------
    CaseError
        If the soil, a test or a quantity is not known, or the soil cannot follow a test; nothing is
        written then.
    """
    stratum, ground = _stratum(source, layer, overrides)
    samples = _samples(ground, stratum, pressures)
    for name in names:
        if name not in TESTS:
            raise CaseError(f"--test {name}: no such test; {suggestion(name, TESTS)}")
    most = LARGEST_SHEAR if all(TESTS[name].is_shear for name in names or TESTS) else 1.0
    if strain is not None and not 0.0 < strain < most:
        raise CaseError(f"--strain {strain:g} must be > 0 and < {most:g} in these tests")
    results = {
        name: [_tested(stratum, name, sample, strain) for sample in samples]
        for name in names or TESTS
    }
    output.mkdir(parents=True, exist_ok=True)
    text = ""
    for name, paths in results.items():
        text += _written(stratum, name, samples, paths, output)
    return text


def _stratum(
    source: str, layer: str | None, overrides: Sequence[str]
) -> tuple[Stratum, GroundProfile]:
    """Return the stratum that is tested, and its ground."""
    table = {"ground": soil_example(source)} if source in TYPICAL else _read(Path(source))
    apply_overrides(table, overrides)
    if "ground" not in table:
        raise CaseError(f"{source}: no [ground] section; see `screwpile template --soil LAW`")
    try:
        ground = build(GroundProfile, table["ground"], "ground")
    except CaseError as error:
        raise CaseError(f"{source}: {error}") from error
    rows = {row.layer.name: row for row in reversed(strata(ground))}
    if layer is not None and layer not in rows:
        raise CaseError(f"--soil {layer}: no such layer in {source}; {suggestion(layer, rows)}")
    return (strata(ground)[0] if layer is None else rows[layer]), ground


def _read(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise CaseError(
            f"{path}: no such file; give a case file or a soil law ({', '.join(TYPICAL)})"
        ) from error
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise CaseError(f"{path}: cannot be read as TOML ({error}); correct it") from error


def _samples(ground: GroundProfile, stratum: Stratum, pressures: Sequence[str]) -> list[Sample]:
    """Return where the tests start: at ``pressures``, or at the vertical stress in the ground."""
    below = stratum.top + DEPTH_OF_SAMPLE
    depth = below if np.isinf(stratum.bottom) else min(0.5 * (stratum.top + stratum.bottom), below)
    if pressures:
        stresses = [parse_quantity(text, Unit("Pa")) for text in pressures]
    else:
        stress = geostatic_stress(ground, np.array([-depth]), VERTICAL)
        stresses = [-float(stress[0, VERTICAL, VERTICAL])]
    for stress in stresses:
        if stress <= 0.0:
            raise CaseError(f"--pressure {stress:g} Pa must be > 0 Pa")
    return [Sample(stress, stratum.k0, depth, 0.0) for stress in stresses]


def _tested(stratum: Stratum, name: str, sample: Sample, strain: float | None) -> list[Element]:
    """Return the path of one test."""
    soil = skeleton_of(stratum.layer.soil)
    asked = Sample(
        sample.pressure, sample.k0, sample.depth,
        TESTS[name].strain if strain is None else strain,
    )  # fmt: skip
    try:
        return run_test(soil, name, asked)
    except ElementTestError as error:
        raise CaseError(
            f"{name} of {stratum.layer.name!r} ({soil.model}) from "
            f"{sample.pressure / 1e3:g} kPa: {error}"
        ) from error


def _written(
    stratum: Stratum,
    name: str,
    samples: list[Sample],
    paths: list[list[Element]],
    output: Path,
) -> str:
    """Write table and picture of a test; return its key figures as text."""
    test, soil = TESTS[name], skeleton_of(stratum.layer.soil)
    text = f"{name} of {stratum.layer.name} ({soil.model}): {test.meaning}\n"
    for sample, path in zip(samples, paths, strict=True):
        label = f"{sample.pressure / 1e3:.4g}"
        write_text(output / f"{name}_{label}_kPa.csv", table_csv(table_of(soil, path)))
        text += f"  from {label} kPa\n"
        for figure in key_figures(test, curves_of(path)).values():
            text += f"    {figure.meaning:<48} {shown(figure.value, figure.unit)}\n"
    with styled():
        figure_ = picture(f"{name}: {stratum.layer.name} ({soil.model})", test, samples, paths)
    (output / f"{name}.png").write_bytes(png_of(figure_))
    return text
