"""The cases in sand and soft clay run through all stages, with every certificate limit kept."""

import json
from pathlib import Path

import meshio
import numpy as np
import pytest

from install_mpm.conventions import WATER_UNIT_WEIGHT
from install_mpm.state_file import read_installed_state
from workflows import directory as names
from workflows.case import read_case
from workflows.runner import run_case

CASES = Path(__file__).parents[2] / "cases"


@pytest.mark.parametrize("path", sorted(CASES.glob("*.toml")), ids=lambda path: path.stem)
def test_every_case_is_valid(path):
    case, _ = read_case(path)
    assert case.title


@pytest.mark.slow
@pytest.mark.dolfinx
@pytest.mark.parametrize("name", ["jacked_pile_sand_quick", "jacked_pile_soft_clay_quick"])
def test_case_runs_through_all_stages(name, tmp_path):
    case, _ = read_case(CASES / f"{name}.toml")
    run_case(case, tmp_path / "out")
    certificate = json.loads((tmp_path / "out" / names.CERTIFICATE).read_text(encoding="utf-8"))
    assert all(figure["is_met"] for figure in certificate.values())
    state = read_installed_state(tmp_path / "out" / names.INSTALLED)
    ratio = state.material_points.volume_ratio
    assert ratio.min() > 0.5
    assert ratio.max() < 1.5
    report = (tmp_path / "out" / names.REPORT).read_text(encoding="utf-8")
    assert f"{ratio.min():.3f} to {ratio.max():.3f}" in report
    assert state.history.residual_history[0, 0] < 1e-8
    view = meshio.read(tmp_path / "out" / names.VIEW_POINTS)
    depth = np.maximum(-state.material_points.position[:, 1], 0.0)
    weight_of_water = 0.0 if case.ground.water_table is None else WATER_UNIT_WEIGHT
    np.testing.assert_allclose(view.point_data["hydrostatic_pressure"], weight_of_water * depth)
