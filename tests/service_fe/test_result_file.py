"""service.h5: round trip, and a clear refusal of whatever is not it."""

import h5py
import numpy as np
import pytest

from install_mpm.record import StateFileError
from install_mpm.seal import seal
from install_mpm.state_file import case_hash
from service_fe.options import Displace, Release
from service_fe.result_file import read_service_result, write_service_result
from service_fe.results import AlongPile
from service_fe.solve import run

pytestmark = pytest.mark.dolfinx

CASE_TEXT = 'title = "test"\n'


@pytest.fixture(scope="module")
def result(pile_problem, undisturbed):
    programmes = (Release(steps=1), Displace("uplift", -0.02, 0.02, first_step_halvings=1))
    return run(pile_problem, undisturbed, programmes, model="wished_in_place", case_text=CASE_TEXT)


@pytest.fixture
def path(tmp_path, result):
    path = tmp_path / "service.h5"
    write_service_result(path, result, "test")
    return path


def test_round_trip(path, result):
    read = read_service_result(path)
    assert (read.model, read.case_text) == ("wished_in_place", CASE_TEXT)
    assert [item.programme for item in read.programmes] == [
        item.programme for item in result.programmes
    ]
    np.testing.assert_equal(read.mesh._asdict(), result.mesh._asdict())
    np.testing.assert_equal(read.interface._asdict(), result.interface._asdict())
    for mine, its in zip(result.programmes, read.programmes, strict=True):
        for record in ("curve", "soil", "state"):
            np.testing.assert_equal(getattr(its, record)._asdict(), getattr(mine, record)._asdict())


def test_what_a_pile_feels_along_its_axis_comes_back(tmp_path, result):
    levels = np.linspace(-2.0, 0.0, 4)
    lateral = np.arange(24.0).reshape(3, 4, 2)
    along = AlongPile(levels, np.nan * lateral, lateral, lateral[..., 0], -lateral, 2.0 * lateral)
    first = result.programmes[0]._replace(along=along)
    write_service_result(tmp_path / "service.h5", result._replace(programmes=(first,)), "test")
    (read,) = read_service_result(tmp_path / "service.h5").programmes
    np.testing.assert_equal(read.along._asdict(), along._asdict())
    assert result.programmes[0].along is None  # only a pile in space has one


def test_file_carries_format_and_case(path):
    with h5py.File(path) as file:
        assert file.attrs["format"] == "screwpile-service-result"
        assert file.attrs["version"] == 5
        assert file.attrs["case_sha256"] == case_hash(CASE_TEXT)
        assert file["programmes/001/curve/head_load"].attrs["unit"] == "N or N m"


def test_nothing_partial_is_left(path):
    assert [item.name for item in path.parent.iterdir()] == ["service.h5"]


def damage(path, change):
    with h5py.File(path, "r+") as file:
        change(file)
    seal(path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda file: file.attrs.__setitem__("format", "other"), "format is 'other'"),
        (lambda file: file.attrs.__setitem__("version", 99), "version 99"),
        (lambda file: file.attrs.__setitem__("model", "guess"), "model is 'guess'"),
        (lambda file: file.__delitem__("mesh"), "group /mesh is missing"),
        (lambda file: file.__delitem__("programmes"), "group /programmes is missing"),
        (lambda file: file.__delitem__("programmes/000/state"), "/programmes/000/state is missing"),
        (
            lambda file: file["programmes/000"].attrs.__setitem__("programme", "{"),
            "attribute programme of group /programmes/000",
        ),
    ],
)
def test_damaged_file_is_refused(path, change, message):
    damage(path, change)
    with pytest.raises(StateFileError, match=message):
        read_service_result(path)


def test_truncated_file_is_refused(path):
    path.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(StateFileError, match="truncated or not an HDF5 file"):
        read_service_result(path)
