"""One element of soil under driven stresses and strains, against closed forms."""

from itertools import pairwise

import numpy as np
import pytest

from install_mpm.constitutive.element_driver import ElementTestError, Loading, drive, element
from install_mpm.constitutive.parameters import HenckyElastic, MohrCoulomb, Tresca

NO = np.zeros((3, 3), dtype=bool)
ZERO = np.zeros((3, 3))
LATERAL = np.diag([True, False, True])
STRAINS = pytest.mark.parametrize("is_finite_strain", [False, True], ids=["small", "finite"])
SAND = MohrCoulomb(20e6, 0.3, 0.0, np.radians(30.0))


def isotropic(pressure):
    return -pressure * np.eye(3)


def axial(shortening, cell_pressure, **options):
    """Triaxial loading along axis 1 at constant cell pressure."""
    return Loading(LATERAL, np.diag([0.0, -shortening, 0.0]), isotropic(cell_pressure), **options)


@STRAINS
def test_uniaxial_stress_of_an_elastic_element(is_finite_strain):
    soil = HenckyElastic(1e6, 0.3)
    loading = axial(0.2, 0.0, steps=2)
    end = drive(soil, element(soil, ZERO), [loading], is_finite_strain=is_finite_strain)[-1]
    if is_finite_strain:
        strain = np.log(0.8)
        lateral = np.exp(-0.3 * strain)
        assert end.stress[1, 1] == pytest.approx(1e6 * strain / (0.8 * lateral**2), rel=1e-9)
        assert end.gradient[0, 0] == pytest.approx(lateral, rel=1e-9)
    else:
        assert end.stress[1, 1] == pytest.approx(-0.2e6, rel=1e-9)
        assert end.gradient[0, 0] == pytest.approx(1.06, rel=1e-9)


@STRAINS
def test_undrained_triaxial_loading_keeps_the_volume(is_finite_strain):
    """Total cell pressure stays: an elastic element has a pore pressure of a third of q."""
    soil = HenckyElastic(20e6, 0.3)
    loading = axial(0.05, 100e3, steps=3, is_undrained=True)
    start = element(soil, isotropic(100e3))
    end = drive(soil, start, [loading], is_finite_strain=is_finite_strain)[-1]
    volume = np.linalg.det(end.gradient) if is_finite_strain else np.trace(end.gradient) - 2.0
    assert volume == pytest.approx(1.0, abs=1e-10)
    total = end.stress - end.pore_pressure * np.eye(3)
    deviator = end.stress[0, 0] - end.stress[1, 1]
    assert total[0, 0] == pytest.approx(-100e3, rel=1e-9)
    assert end.pore_pressure == pytest.approx(deviator / 3.0, rel=1e-6)


def test_drained_triaxial_compression_of_sand():
    """With two equal stresses on an edge of the pyramid; q = 200 kPa at 100 kPa."""
    path = drive(SAND, element(SAND, isotropic(100e3)), [axial(0.03, 100e3, steps=30)])
    assert path[-1].stress[0, 0] - path[-1].stress[1, 1] == pytest.approx(200e3, rel=1e-9)
    assert path[-1].stress[0, 0] == pytest.approx(-100e3, rel=1e-9)
    assert path[-1].gradient[0, 0] == pytest.approx(path[-1].gradient[2, 2], rel=1e-9)


def test_stress_paths_go_on_from_each_other():
    """Isotropic compression, shear to failure, unloading: each part starts where the last ends."""
    everywhere = np.eye(3, dtype=bool)
    loadings = [
        Loading(everywhere, ZERO, isotropic(200e3), 2),
        axial(0.05, 200e3, steps=20),
        Loading(everywhere, ZERO, isotropic(200e3), 5),
    ]
    path = drive(SAND, element(SAND, isotropic(100e3)), loadings)
    assert path[22].stress[0, 0] - path[22].stress[1, 1] == pytest.approx(400e3, rel=1e-9)
    np.testing.assert_allclose(path[-1].stress, isotropic(200e3), atol=1e-4)


def test_shear_stress_drives_the_shear_strain():
    soil = HenckyElastic(1e6, 0.25)
    is_stress = NO.copy()
    is_stress[0, 1] = is_stress[1, 0] = True
    stress = ZERO.copy()
    stress[0, 1] = 10e3
    end = drive(soil, element(soil, ZERO), [Loading(is_stress, ZERO, stress, 1)])[-1]
    assert end.gradient[0, 1] == pytest.approx(10e3 / 0.4e6, rel=1e-9)
    assert end.gradient[1, 0] == 0.0


def test_stress_beyond_the_strength_is_told():
    soil = Tresca(4e6, 0.3, 20e3)
    loading = Loading(np.eye(3, dtype=bool), ZERO, np.diag([0.0, -50e3, 0.0]), 4)
    with pytest.raises(ElementTestError, match="beyond the strength"):
        drive(soil, element(soil, ZERO), [loading])


def test_loading_that_makes_no_sense_is_told():
    start = element(SAND, isotropic(100e3))
    one_sided = NO.copy()
    one_sided[0, 1] = True
    with pytest.raises(ValueError, match="symmetric"):
        drive(SAND, start, [Loading(one_sided, ZERO, ZERO, 1)])
    with pytest.raises(ValueError, match="pore pressure"):
        drive(SAND, start, [Loading(NO, ZERO, ZERO, 1, is_undrained=True)])


@STRAINS
def test_newton_is_quadratic(is_finite_strain):
    soil = MohrCoulomb(20e6, 0.3, 5e3, np.radians(35.0), np.radians(10.0), 0.6, 0.8)
    path = drive(
        soil, element(soil, isotropic(100e3)), [axial(0.2, 100e3, steps=10)],
        is_finite_strain=is_finite_strain,
    )  # fmt: skip
    for step in path[1:]:
        assert len(step.residuals) <= 8
        for before, after in pairwise(step.residuals):
            assert before > 1e-3 or after < 20.0 * before**2 + 1e-10
