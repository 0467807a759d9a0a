"""A screw pile in sand: all stages, and how little the viscosity of the service stage decides."""

from pathlib import Path

import numpy as np
import pytest

from service_fe.result_file import read_service_result
from workflows.case import read_case
from workflows.directory import SERVICE, WISHED_SERVICE
from workflows.runner import run_case, run_from_case

pytestmark = [pytest.mark.dolfinx, pytest.mark.gmsh, pytest.mark.slow]

CASE = Path(__file__).parent / "tiny_screw.toml"
SAND = (
    "ground.k0=0.47",
    "ground.soil={model='critical_state_sand', void_ratio=0.7, critical_stress_ratio=0.92,"
    " critical_void_ratio=0.83, critical_state_slope=0.02, reference_shear_modulus='11 MPa'}",
    "interface={normal_stiffness='100 MPa/m', shear_stiffness='10 MPa/m', friction_angle='24 deg',"
    " smoothing_stress='2 kPa'}",
    "numerics={tolerance=1e-4, open_stiffness=1e-3, largest_correction=0.1, second_start=true}",
)
LOADED = ("compression", "uplift", "lateral")


def sand_case(viscosity):
    numerics = f"service.numerics={{tolerance=1e-4, max_iterations=30, viscosity={viscosity}}}"
    return read_case(CASE, [*SAND, numerics])[0]


def curves_in(path):
    result = read_service_result(path)
    return {entry.programme.name: entry.curve for entry in result.programmes}


@pytest.fixture(scope="module")
def directory(tmp_path_factory):
    directory = tmp_path_factory.mktemp("sand") / "results"
    run_case(sand_case(0.01), directory, accept_uncertified=True)  # the mesh is coarse
    return directory


@pytest.mark.parametrize("file", [SERVICE, WISHED_SERVICE])
def test_every_programme_ends_and_viscosity_carries_little(directory, file):
    curves = curves_in(directory / file)
    for name in LOADED:
        curve = curves[name]
        assert curve.residual.max() <= 1e-4
        assert 0.0 < curve.viscous_share.max() < 0.1
        assert curve.viscous_share[-1] < 0.02
    assert (
        np.diff(curves["compression"].head_load) > 0.0
    ).all()  # uplift is at its plateau at once


def test_viscous_share_tells_what_half_the_viscosity_changes(directory, tmp_path):
    run_from_case("wished", sand_case(0.005), tmp_path / "results")
    thick = curves_in(directory / WISHED_SERVICE)
    thin = curves_in(tmp_path / "results" / WISHED_SERVICE)
    for name in LOADED:
        shares = [curves[name].viscous_share[-1] for curves in (thick, thin)]
        change = 1.0 - thin[name].head_load[-1] / thick[name].head_load[-1]
        assert shares[1] < 0.7 * shares[0]
        assert change == pytest.approx(shares[0] - shares[1], abs=0.005)
