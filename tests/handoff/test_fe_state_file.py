"""The handed-off state: round trip, and damaged files told in one sentence."""

import json

import h5py
import numpy as np
import pytest

from handoff.fe_mesh import FEMesh
from handoff.fe_state_file import (
    RECORDS,
    FEIntegrationPoints,
    FEInterfacePoints,
    FEState,
    HandedOffPile,
    HandedOffState,
    read_handed_off_state,
    write_handed_off_state,
)
from install_mpm.record import StateFileError
from install_mpm.seal import seal


@pytest.fixture
def handed_off() -> HandedOffState:
    """Two cells, six integration points, two interface points: small, every number different."""
    random = np.random.default_rng(0)
    return HandedOffState(
        mesh=FEMesh(
            random.normal(size=(9, 2)),
            random.integers(0, 9, size=(2, 6)),
            random.integers(0, 9, size=(4, 3)),
            np.arange(4),
        ),
        state=FEState(
            random.normal(size=(6, 3, 3)),
            random.normal(size=(6, 3, 3)),
            random.normal(size=(6, 2)),
            np.zeros(6, dtype=np.int64),
            random.normal(size=(2, 2)),
            np.zeros(2),
        ),
        integration=FEIntegrationPoints(random.normal(size=(6, 2)), random.uniform(size=6)),
        interface=FEInterfacePoints(
            random.normal(size=(2, 2)), random.normal(size=(2, 2)), np.ones(2), np.arange(2)
        ),
        pile=HandedOffPile(*map(np.array, (5.0, 0.0, 120e3, 6e-3, 0.01))),
        certificate=json.dumps({"synthetic_error": {"value": 0.01}}),
        case_text='title = "small"\n',
    )


@pytest.fixture
def path(tmp_path, handed_off):
    path = tmp_path / "handed_off.h5"
    write_handed_off_state(path, handed_off, "test")
    return path


def test_round_trip_is_bit_equal(path, handed_off):
    read = read_handed_off_state(path)
    for group in RECORDS:
        for first, second in zip(getattr(read, group), getattr(handed_off, group), strict=True):
            assert np.array_equal(first, second)
    assert read.case_text == handed_off.case_text
    assert read.certificate == handed_off.certificate
    assert not path.with_suffix(".h5.partial").exists()


def test_state_without_state_variables_is_kept(tmp_path, handed_off):
    state = handed_off.state._replace(state_variables=np.zeros((6, 0)))
    path = tmp_path / "elastic.h5"
    write_handed_off_state(path, handed_off._replace(state=state), "test")
    assert read_handed_off_state(path).state.state_variables.shape == (6, 0)


def set_attribute(name, value):
    def damage(file):
        file.attrs[name] = value

    return damage


def poison(name):
    def damage(file):
        file[name][0] = np.nan

    return damage


def remove(name):
    def damage(file):
        del file[name]

    return damage


def replace(name, value):
    def damage(file):
        attributes = dict(file[name].attrs)
        del file[name]
        file[name] = value
        file[name].attrs.update(attributes)

    return damage


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (set_attribute("version", 99), "version 99 of screwpile-handed-off-state is not version 3"),
        (set_attribute("format", "screwpile-installed-state"), "expected 'screwpile-handed-off"),
        (set_attribute("case_sha256", "0" * 64), "/case is missing or does not match"),
        (set_attribute("conventions", "other"), "other conventions"),
        (remove("state/cauchy_stress"), "/state/cauchy_stress is missing"),
        (remove("interface"), "group /interface is missing"),
        (remove("certificate"), "group /certificate holds no JSON"),
        (poison("state/cauchy_stress"), "not finite"),
        (replace("state/material", np.zeros(6)), "expected int64"),
        (replace("integration/volume", np.ones(7)), "shape"),
        (replace("interface/area", np.ones(3)), "shape"),
        (replace("mesh/cell_nodes", np.full((2, 6), 9)), "names a node that does not exist"),
    ],
)
def test_damaged_file_is_named_in_one_sentence(path, damage, words):
    with h5py.File(path, "r+") as file:
        damage(file)
    seal(path)
    with pytest.raises(StateFileError, match=words) as error:
        read_handed_off_state(path)
    assert str(error.value).startswith(str(path))
    assert "\n" not in str(error.value)


def test_groups_that_do_not_belong_together_are_named(tmp_path, handed_off):
    points = FEIntegrationPoints(np.zeros((5, 2)), np.ones(5))
    path = tmp_path / "mixed.h5"
    write_handed_off_state(path, handed_off._replace(integration=points), "test")
    with pytest.raises(StateFileError, match="/integration has 5 points, /state has 6"):
        read_handed_off_state(path)


def test_truncated_file_is_named(path):
    path.write_bytes(path.read_bytes()[:3000])
    with pytest.raises(StateFileError, match="truncated or not an HDF5 file"):
        read_handed_off_state(path)


def test_missing_file_is_named(tmp_path):
    with pytest.raises(StateFileError, match="no such file"):
        read_handed_off_state(tmp_path / "nothing.h5")
