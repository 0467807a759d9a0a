"""``screwpile element-test`` and ``screwpile template --soil``: figures against closed forms."""

import csv
from typing import get_args

import numpy as np
import pytest

from install_mpm.constitutive.parameters import MohrCoulomb, SoilParameters, Tresca
from workflows.element_tests.command import run
from workflows.element_tests.figures import curves_of, dilation_angle, key_figures, secant_modulus
from workflows.element_tests.paths import TESTS, Sample, run_test
from workflows.errors import CaseError
from workflows.schema import hints_of, is_tag, tag_value
from workflows.soil_template import soil_template_text
from workflows.soil_typical import TYPICAL

SAND = MohrCoulomb(40e6, 0.25, 0.0, np.radians(35.0), np.radians(8.0))
CLAY = Tresca(8e6, 0.49, 20e3)


def figures(soil, name, pressure, k0=1.0, strain=None):
    test = TESTS[name]
    path = run_test(soil, name, Sample(pressure, k0, 0.0, strain or test.strain))
    return key_figures(test, curves_of(path))


def test_drained_triaxial_test_of_sand_gives_back_its_angles():
    found = figures(SAND, "triaxial_drained", 100e3, strain=0.05)
    most = 100e3 * np.tan(np.pi / 4.0 + np.radians(17.5)) ** 2
    assert found["peak_q"].value == pytest.approx(most - 100e3, rel=1e-6)
    assert found["friction_angle"].value == pytest.approx(np.radians(35.0), rel=1e-6)
    # elastic strain goes on: the law has Kirchhoff stress, the cell keeps Cauchy stress
    assert found["dilation_angle"].value == pytest.approx(np.radians(8.0), rel=1e-2)
    assert found["E50"].value == pytest.approx(40e6, rel=0.02)


def test_undrained_tests_of_clay_give_back_its_strength():
    for name in ("triaxial_undrained", "simple_shear_undrained", "cyclic_shear"):
        assert figures(CLAY, name, 50e3)["su"].value == pytest.approx(20e3, rel=1e-6)


def test_oedometer_of_sand_gives_the_constrained_modulus():
    found = figures(SAND, "oedometer", 100e3, k0=1.0 / 3.0, strain=0.01)
    constrained = 40e6 * 0.75 / (1.25 * 0.5)
    assert found["initial_modulus"].value == pytest.approx(constrained, rel=0.01)
    assert found["k0_at_end"].value == pytest.approx(1.0 / 3.0, rel=1e-3)


def test_measures_of_curves():
    strain = np.linspace(0.0, 0.1, 101)
    assert secant_modulus(strain, 50.0 + 200.0 * strain) == pytest.approx(200.0)
    psi = np.radians(12.0)
    assert dilation_angle(-2.0 * np.sin(psi) / (1.0 - np.sin(psi))) == pytest.approx(psi)


@pytest.mark.parametrize("name", [tag_value(law) for law in get_args(SoilParameters)])
def test_every_law_has_a_template_that_the_tests_read(name, tmp_path):
    law = next(law for law in get_args(SoilParameters) if tag_value(law) == name)
    keys = {key for key, hint in hints_of(law).items() if not is_tag(hint)}
    assert set(TYPICAL[name]) == keys
    text = soil_template_text(name)
    for typical in TYPICAL[name].values():
        assert typical.note.split()[0] in text
    assert max(len(line) for line in text.splitlines() if line.startswith("#")) <= 100
    file = tmp_path / "ground.toml"
    file.write_text(text, encoding="utf-8")
    output = tmp_path / "out"
    printed = run(str(file), output, names=["simple_shear"], pressures=["50 kPa"], strain=0.02)
    assert "largest shear stress" in printed
    rows = list(csv.reader((output / "simple_shear_50_kPa.csv").open(encoding="utf-8")))
    assert len(rows) == 202
    assert rows[0][:3] == ["axial_strain", "volumetric_strain", "shear_strain"]
    assert np.isfinite(np.array(rows[1:], dtype=float)).all()
    assert (output / "simple_shear.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"source": "nowhere.toml"}, "no such file"),
        ({"source": "tresca", "names": ["triaxial"]}, "did you mean"),
        ({"source": "tresca", "layer": "peat"}, "no such layer"),
        ({"source": "tresca", "pressures": ["50"]}, "is not a quantity"),
        ({"source": "tresca", "pressures": ["-5 kPa"]}, "must be > 0"),
        ({"source": "tresca", "strain": 2.0}, "must be > 0 and < 1"),
        ({"source": "tresca", "overrides": ["ground.soil.poissons_ratio=0.6"]}, "0.5"),
    ],
)
def test_errors_are_one_sentence_and_write_nothing(options, words, tmp_path):
    with pytest.raises(CaseError) as caught:
        run(output=tmp_path / "out", **options)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "out").exists()


def test_an_unknown_law_is_named():
    with pytest.raises(CaseError, match="'mohr' is not a soil law"):
        soil_template_text("mohr")
