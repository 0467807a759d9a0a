"""The case file: units, ranges, cross checks, overrides, canonical text."""

import re
from pathlib import Path

import pytest

from install_mpm.constitutive.parameters import HenckyElastic, VonMises
from service_fe.options import DeformablePile
from workflows.case import case_text, parse_case, read_case, sections_text
from workflows.errors import CaseError
from workflows.overrides import parse_value
from workflows.template import template_text

CASES = Path(__file__).parents[2] / "cases"
MAIN = CASES / "jacked_pile_clay.toml"


@pytest.mark.parametrize("path", sorted(CASES.glob("*.toml")), ids=lambda path: path.stem)
def test_every_case_is_valid(path):
    case, text = read_case(path)
    assert parse_case(text, "canonical") == case


def test_quantities_are_converted_to_si():
    case, _ = read_case(MAIN)
    assert case.ground.unit_weight == 18000.0
    assert case.installation.step == 0.02
    assert case.interface.normal_stiffness == 2e8
    assert isinstance(case.ground.soil, VonMises)
    assert case.final_tip_depth == 5.0
    assert case.interface.friction_angle == 0.0
    case, _ = read_case(MAIN, ["interface.friction_angle=30 deg"])
    assert case.interface.friction_angle == pytest.approx(0.5235987755982988, rel=1e-15)


def test_canonical_text_does_not_depend_on_the_spelling():
    _, text = read_case(MAIN)
    spellings = ["pile.half_width=50 cm", "numerics.max_cuts=6", "box.depth='12000 mm'"]
    assert read_case(MAIN, spellings)[1] == text
    assert read_case(MAIN, ["pile.half_width=51 cm"])[1] != text


def test_canonical_text_keeps_every_digit():
    case, text = read_case(MAIN, ["interface.friction_angle=24 deg", "pile.embedment=3.9999999 m"])
    assert parse_case(text, "canonical") == case
    assert case_text(parse_case(text, "canonical")) == text


def test_sections_text_tells_what_changed():
    case, _ = read_case(MAIN)
    changed, _ = read_case(MAIN, ["service.programmes.uplift.step=5 mm"])
    assert sections_text(case, ["pile", "handoff"]) == sections_text(changed, ["pile", "handoff"])
    assert sections_text(case, ["service"]) != sections_text(changed, ["service"])
    numerics = ["service.numerics"]
    assert sections_text(case, numerics) == sections_text(changed, numerics)


def test_template_is_a_valid_case_that_names_every_key():
    text = template_text()
    case = parse_case(text, "template")
    keys = [line.split(" = ")[0] for line in case_text(case).splitlines() if " = " in line]
    assert len(keys) > 40
    for key in keys:
        assert f"{key} = " in text, key
    assert "Pa, > 0" in text
    assert "default" in text
    assert '"hencky_elastic"' in text
    assert max(map(len, text.splitlines())) <= 100


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.5 m", "0.5 m"),
        ('"0.5 m"', "0.5 m"),
        ("3", 3),
        ("1e-8", 1e-8),
        ("true", True),
        ("von_mises", "von_mises"),
        ("[]", []),
    ],
)
def test_override_values_are_typed_as_in_toml(text, value):
    assert parse_value(text) == value
    assert type(parse_value(text)) is type(value)


def test_overrides_reach_tables_alternatives_and_list_entries():
    case, _ = read_case(
        MAIN,
        [
            "ground.soil.undrained_shear_strength=30 kPa",
            "service.programmes.uplift.displacement=-5 cm",
            "service.programmes.1.steps=7",
            "title=Stiffer",
        ],
    )
    assert case.ground.soil.undrained_shear_strength == 30e3
    assert case.service.programmes[2].displacement == -0.05
    assert case.service.programmes[0].steps == 7
    assert case.title == "Stiffer"


def test_a_deformable_pile_is_a_table_of_the_service_stage():
    case, _ = read_case(MAIN)
    assert case.service.pile is None
    steel, _ = read_case(
        MAIN, ["service.pile.youngs_modulus=210 GPa", "service.pile.contact=bonded"]
    )
    assert steel.service.pile == DeformablePile(210e9, 0.3, "bonded")
    for wrong, words in (
        ("service.pile.contact=glued", 'must be one of "interface", "bonded"'),
        ("service.pile.youngs_modulus=0 GPa", "must be > 0"),
        ("service.pile.youngs_modulus=2e16 Pa", "<= 1e+13"),
        ("service.pile.poissons_ratio=0.5", ">= 0 and < 0.5"),
    ):
        with pytest.raises(CaseError, match=re.escape(words)):
            read_case(MAIN, ["service.pile.youngs_modulus=210 GPa", wrong])


def test_another_soil_is_chosen_by_its_tag():
    soil = '{ model = "hencky_elastic", youngs_modulus = "1 GPa", poissons_ratio = 0.3 }'
    case, _ = read_case(MAIN, [f"ground.soil={soil}", "interface.adhesion_factor=0"])
    assert case.ground.soil == HenckyElastic(1e9, 0.3)


@pytest.mark.parametrize(
    ("override", "key", "words"),
    [
        ("pile.half_widht=1 m", "pile.half_widht", 'did you mean "half_width"?'),
        ("pile.half_width=1", "pile.half_width", 'write it with one, e.g. "1 m"'),
        ("pile.half_width=1 kPa", "pile.half_width", "a pressure or stress, but a length is"),
        ("pile.half_width=1 bananas", "pile.half_width", "'bananas' is not a unit"),
        ("pile.half_width=wide", "pile.half_width", "is not a quantity"),
        ("pile.half_width=9 m", "pile.half_width", "does not fit into box.width"),
        ("pile.embedment=-4 m", "pile.embedment", "is -4 m, but it must be > 0 m"),
        ("pile=3", "pile", "a table is needed"),
        ("installation.penetration=8 m", "installation.penetration", "box.depth at least 13 m"),
        ("installation.step=10 cm", "installation.step", "half the smallest cell"),
        ("background_mesh.size_at_pile=2 m", "background_mesh.size_far", "exchange the two"),
        ("background_mesh.size_far=9 m", "background_mesh.size_far", "larger than the box"),
        ("handoff.size_at_pile=0.6 m", "handoff.size_at_pile", "larger than half the pile width"),
        ("box.headroom=1 cm", "box.headroom", "make it at least"),
        ("ground.soil.poissons_ratio=0.5", "ground.soil.poissons_ratio", ">= 0 and < 0.5"),
        (
            "ground.soil.model=mohr",
            "ground.soil.model",
            "use one of hencky_elastic, neo_hookean, von_mises",
        ),
        ("ground.k0=true", "ground.k0", "valid number"),
        ("ground.k0=inf", "ground.k0", "finite number"),
        ("ground.k0=Jaky", "ground.k0", '> 0 or one of "jaky"'),
        ("ground.k0=jaky", "ground", "has no friction angle"),
        ("ground.k0=0.1", "K0 stress of 'ground'", "exceeds the strength"),
        ("ground.water_table=-1 m", "ground.water_table", "must be >= 0 m"),
        ("ground.layers=[]", "ground", "not a known key"),
        (
            'ground.soil={model="hencky_elastic", youngs_modulus = "1 GPa", poissons_ratio = 0.3}',
            "interface.adhesion_factor",
            "has no undrained shear strength",
        ),
        ("numerics.max_iterations=2.5", "numerics.max_iterations", "valid integer"),
        ("numerics.tolerance=1e-3", "numerics.tolerance", "<= 1e-06"),
        ("interface.tensile_strength=0 kPa", "interface.tensile_strength", "set it, e.g."),
        ("service.programmes=[]", "service.programmes", "add at least one"),
        ("service.numerics={damping=0.1, viscosity=0.01}", "damping and viscosity", "set one"),
        ("service.programmes.uplift.name=push_on", "service.programmes", "are named 'push_on'"),
        ("service.programmes.uplift.start=later", "start", "which is not before it; use one of"),
        ("service.programmes.nobody.start=later", "--set", "use one of release, compression"),
        ("service.programmes=3", "service.programmes", "a list is needed"),
        ("titel=x", "titel", 'did you mean "title"?'),
        ("title", "--set", "write --set section.key=value"),
    ],
)
def test_errors_name_the_key_and_the_remedy(override, key, words):
    with pytest.raises(CaseError) as caught:
        read_case(MAIN, [override])
    message = str(caught.value)
    assert key in message
    assert words in message
    assert "\n" not in message


def test_missing_keys_and_sections_are_named():
    text = MAIN.read_text(encoding="utf-8")
    with pytest.raises(CaseError, match=r"x.toml: pile.embedment is missing; add it, e.g. embed"):
        parse_case(text.replace('embedment = "4 m"', ""), "x.toml")
    with pytest.raises(CaseError, match=r"x.toml: box is missing; add it, e.g. a \[box\] table"):
        parse_case(text.replace("[box]", "[numerics.box]"), "x.toml")


def test_broken_toml_is_located():
    with pytest.raises(CaseError, match=r"x.toml: not valid TOML: .*line 2, column"):
        parse_case('title = "a"\n[pile\n', "x.toml")


def test_unreadable_files_are_named(tmp_path):
    with pytest.raises(CaseError, match=r"nowhere[.]toml: no such file"):
        read_case(tmp_path / "nowhere.toml")
    with pytest.raises(CaseError, match="cannot be read as text"):
        read_case(tmp_path)
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(CaseError, match="cannot be read as text"):
        read_case(tmp_path / "binary.toml")
