"""Records and the file of the installed state: round trip, history, and all kinds of faults."""

from typing import Annotated, NamedTuple

import h5py
import numpy as np
import pytest

from install_mpm import state_file
from install_mpm.cells import CellType, reference_cell
from install_mpm.constitutive import coulomb_interface
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.conventions import Kinematics, conventions_hash
from install_mpm.history import History, append, empty_history
from install_mpm.interface import InterfacePoints
from install_mpm.record import Field, StateFileError, describe, fields_of, read_record, write_record
from install_mpm.seal import MARK, USER_BLOCK, open_state_file, seal
from install_mpm.seeding import seed_points
from install_mpm.state_file import (
    FORMAT,
    RECORDS,
    VERSION,
    InstalledState,
    PileState,
    StepControl,
    case_hash,
    read_installed_state,
    write_installed_state,
)

CASE_TEXT = 'title = "Pfahl in weichem Ton, φ = 0"\n'


def history_row(residuals, **values):
    integers = {name for name, field in fields_of(History).items() if field.dtype == "int64"}
    row = {name: 1 if name in integers else 0.5 for name in History._fields}
    return row | {"residual_history": np.array(residuals), **values}


@pytest.fixture(scope="module")
def state(make_grid, clay_ground):
    """A state of two steps, made by hand."""
    mesh = make_grid(2, 2)
    n = 4
    history = append(empty_history(History), history_row([1e-3], convergence_order=np.nan))
    history = append(history, history_row([1.0, 0.1, 1e-9], penetration=0.02))
    interface = InterfacePoints(
        position=np.zeros((n, 2)),
        normal=np.tile([0.0, 1.0], (n, 1)),
        area=np.full(n, 0.25),
        traction=np.tile([0.0, -3e3], (n, 1)),
        parameters=coulomb_interface.pack(CoulombInterface(2e8, 2e7, 1e3), np.zeros(n)),
        part=np.zeros(n, dtype=np.int64),
        covered=np.ones(n),
    )
    return InstalledState(
        material_points=seed_points(mesh, reference_cell(CellType.TRI6), clay_ground, 2),
        background_mesh=mesh,
        interface=interface,
        pile=PileState(np.array(0.02), np.array(0.0), np.array(2.02), np.array([0.0, 3e3])),
        history=history,
        control=StepControl(
            np.array(0.02), np.array(0), np.array(2), np.array(8), np.full(mesh.nodes.shape, 1e-3)
        ),
        case_text=CASE_TEXT,
        kinematics=Kinematics.PLANE_STRAIN,
    )


@pytest.fixture
def path(tmp_path, state):
    write_installed_state(tmp_path / "installed.h5", state, "tests")
    return tmp_path / "installed.h5"


def test_state_comes_back_bit_for_bit(path, state):
    result = read_installed_state(path)
    assert result.case_text == CASE_TEXT
    assert result.kinematics is Kinematics.PLANE_STRAIN
    for group in RECORDS:
        for name, array in getattr(state, group)._asdict().items():
            read = getattr(getattr(result, group), name)
            assert (read.dtype, read.shape) == (array.dtype, array.shape)
            np.testing.assert_array_equal(read, array)
            assert read.flags.c_contiguous


def test_file_says_what_it_is(path, state):
    with h5py.File(path) as file:
        assert file.attrs["format"] == FORMAT == "screwpile-installed-state"
        assert file.attrs["version"] == VERSION
        assert file.attrs["created_by"] == "tests"
        assert file.attrs["kinematics"] == "PLANE_STRAIN"
        assert file.attrs["case_sha256"] == case_hash(CASE_TEXT)
        assert file.attrs["conventions"] == conventions_hash()
        stress = file["material_points/kirchhoff_stress"]
        assert stress.attrs["unit"] == "Pa"
        assert "Kirchhoff" in stress.attrs["doc"]
        assert stress.shape == (len(state.material_points.mass), 3, 3)


def test_writing_is_atomic(path, state, monkeypatch):
    """A failure while writing leaves the old file as it was."""
    before = path.read_bytes()
    monkeypatch.setattr(state_file, "write_record", lambda group, record: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        write_installed_state(path, state, "again")
    assert path.read_bytes() == before
    read_installed_state(path)


def test_who_reads_while_it_is_written_sees_the_old_file(path, state):
    before = path.read_bytes()
    with path.open("rb") as reader:
        write_installed_state(path, state._replace(case_text="title = 'new'\n"), "tests")
        assert reader.read() == before
    assert read_installed_state(path).case_text == "title = 'new'\n"
    assert list(path.parent.iterdir()) == [path]


def replaced(group, name, array, unit=None):
    """Put another array in the place of a dataset, with its unit or another one."""
    unit = group[name].attrs["unit"] if unit is None else unit
    del group[name]
    group.create_dataset(name, data=array).attrs["unit"] = unit


def missing_dataset(file):
    del file["material_points/volume"]


def wrong_length(file):
    replaced(file["material_points"], "volume", file["material_points/volume"][:-1])


def wrong_rank(file):
    replaced(file["material_points"], "volume", np.array(file["material_points/volume"])[:, None])


def tensor_of_four(file):
    replaced(file["material_points"], "kirchhoff_stress", np.zeros((96, 4, 3)))


def wrong_dtype(file):
    replaced(file["material_points"], "volume", file["material_points/volume"][:].astype("float32"))


def wrong_unit(file):
    replaced(file["material_points"], "volume", file["material_points/volume"][:], "cm^3")


def not_a_number(file):
    file["material_points/volume"][3] = np.nan


def infinite(file):
    file["material_points/volume"][[3, 5]] = np.inf


def group_for_dataset(file):
    del file["material_points/volume"]
    file["material_points"].create_group("volume")


DATASET_FAULTS = {
    missing_dataset: "is missing",
    wrong_length: "has shape",
    wrong_rank: "has shape",
    tensor_of_four: "has shape",
    wrong_dtype: "has type float32, expected float64",
    wrong_unit: "has unit 'cm^3', expected 'm^3'",
    not_a_number: "holds 1 values that are not finite",
    infinite: "holds 2 values that are not finite",
    group_for_dataset: "is missing",
}


@pytest.mark.parametrize("fault", DATASET_FAULTS, ids=lambda fault: fault.__name__)
def test_faulty_dataset_is_an_error_that_names_its_place(fault, path):
    with h5py.File(path, "r+") as file:
        fault(file)
    seal(path)
    with pytest.raises(StateFileError) as error:
        read_installed_state(path)
    message = str(error.value)
    field = "kirchhoff_stress" if fault is tensor_of_four else "volume"
    assert message.startswith(f"{path}: dataset /material_points/{field} ")
    assert DATASET_FAULTS[fault] in message
    assert "write the file again" in message


def set_attribute(name, value):
    def change(file):
        file.attrs[name] = value

    return change


def without_case(file):
    del file["case"]


def other_case(file):
    file["case"].attrs["toml"] = CASE_TEXT + "# changed\n"


def without_group(file):
    del file["interface"]


def without_format(file):
    del file.attrs["format"]


HEADER_FAULTS = {
    "other format": (set_attribute("format", "screwpile-handed-off-state"), "attribute format"),
    "no format": (without_format, "attribute format is None"),
    "newer version": (set_attribute("version", VERSION + 1), f"version {VERSION + 1}"),
    "older version": (set_attribute("version", 0), "version 0"),
    "other conventions": (set_attribute("conventions", "x"), "other conventions"),
    "other hash": (set_attribute("case_sha256", "x"), "/case"),
    "other case": (other_case, "/case"),
    "no case": (without_case, "/case"),
    "no group": (without_group, "group /interface is missing"),
    "other kinematics": (set_attribute("kinematics", "SPHERICAL"), "'SPHERICAL'"),
}


@pytest.mark.parametrize("fault", HEADER_FAULTS)
def test_wrong_header_is_an_error_that_names_it(fault, path):
    change, expected = HEADER_FAULTS[fault]
    with h5py.File(path, "r+") as file:
        change(file)
    seal(path)
    with pytest.raises(StateFileError) as error:
        read_installed_state(path)
    assert str(error.value).startswith(f"{path}: ")
    assert expected in str(error.value)


@pytest.mark.parametrize("share", [0.0, 0.001, 0.3, 0.9, 0.9999])
def test_truncated_file_is_an_error(share, path):
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    with pytest.raises(StateFileError, match="truncated or not an HDF5 file"):
        read_installed_state(path)


def test_foreign_file_is_an_error(tmp_path):
    (tmp_path / "foreign.h5").write_text("not HDF5 at all")
    with pytest.raises(StateFileError, match=r"foreign\.h5: truncated or not an HDF5 file"):
        read_installed_state(tmp_path / "foreign.h5")
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = 1.0
    with pytest.raises(StateFileError, match="give the right file"):
        read_installed_state(tmp_path / "other.h5")


def test_missing_file_is_an_error(tmp_path):
    with pytest.raises(StateFileError, match="no such file; run the stage that writes it first"):
        read_installed_state(tmp_path / "nothing.h5")


def test_unreadable_data_is_an_error(path):
    """A file that is cut within its data while its length is kept."""
    with h5py.File(path, "r+") as file:
        points = file["material_points"]
        data = points["volume"][:]
        del points["volume"]
        dataset = points.create_dataset("volume", data=data, chunks=(32,), fletcher32=True)
        dataset.attrs["unit"] = "m^3"
        offset = dataset.id.get_chunk_info(0).byte_offset + file.userblock_size
    content = bytearray(path.read_bytes())
    content[offset : offset + 8] = b"\xff" * 8
    path.write_bytes(content)
    seal(path)
    with pytest.raises(StateFileError, match="/material_points/volume cannot be read"):
        read_installed_state(path)


class Sample(NamedTuple):
    """A record with every kind of shape."""

    number: Annotated[np.ndarray, Field((), "m", "a scalar")]
    table: Annotated[np.ndarray, Field(("row", 3), "", "a table", "int64")]
    rows: Annotated[np.ndarray, Field(("row",), "Pa", "may be NaN", may_be_nan=True)]


def sample(n_rows=2):
    return Sample(np.array(1.5), np.arange(3 * n_rows).reshape(-1, 3), np.full(n_rows, np.nan))


def test_record_round_trip_with_scalars_nan_and_no_rows(tmp_path):
    for n_rows in (0, 2):
        with h5py.File(tmp_path / f"{n_rows}.h5", "w") as file:
            write_record(file.create_group("sample"), sample(n_rows))
            result = read_record(file["sample"], Sample)
        for array, expected in zip(result, sample(n_rows), strict=True):
            np.testing.assert_array_equal(array, expected)
            assert array.dtype == expected.dtype


def test_named_extents_must_agree_within_a_record(tmp_path):
    with h5py.File(tmp_path / "sample.h5", "w") as file:
        write_record(file.create_group("sample"), sample()._replace(rows=np.zeros(3)))
        with pytest.raises(StateFileError, match=r"/sample/rows has shape \(3,\), expected \(2,\)"):
            read_record(file["sample"], Sample)


def test_table_of_the_documentation():
    assert describe({"sample": Sample}).splitlines() == [
        "| dataset | shape | type | unit | meaning |",
        "|---|---|---|---|---|",
        "| `/sample/number` | scalar | float64 | m | a scalar |",
        "| `/sample/table` | row x 3 | int64 | - | a table |",
        "| `/sample/rows` | row | float64 | Pa | may be NaN |",
    ]


def test_every_field_of_the_state_is_described():
    table = describe(RECORDS)
    for group, record_type in RECORDS.items():
        for name, field in fields_of(record_type).items():
            assert f"`/{group}/{name}`" in table
            assert field.doc
            assert field.dtype in ("float64", "int64")


def test_history_grows_by_rows_and_pads_residuals(state):
    history = state.history
    np.testing.assert_array_equal(history.penetration, [0.5, 0.02])
    assert history.iterations.dtype == np.int64
    assert np.isnan(history.convergence_order[0])
    np.testing.assert_array_equal(
        history.residual_history, [[1e-3, np.nan, np.nan], [1.0, 0.1, 1e-9]]
    )
    longer = append(history, history_row([1.0]))
    assert longer.residual_history.shape == (3, 3)
    assert len(history.penetration) == 2


def test_history_row_must_be_complete(state):
    row = history_row([1.0])
    del row["crowd_force"]
    with pytest.raises(KeyError):
        append(state.history, row)


def test_empty_history_fits_its_description(tmp_path):
    with h5py.File(tmp_path / "history.h5", "w") as file:
        write_record(file.create_group("history"), empty_history(History))
        result = read_record(file["history"], History)
    assert all(len(array) == 0 for array in result)


def test_damaged_bytes_never_raise_anything_but_one_sentence(path, tmp_path):
    """Every byte of the first kilobytes, where the structure is, and others at random."""
    whole = path.read_bytes()
    rng = np.random.default_rng(7)
    places = np.concatenate([np.arange(0, 4000, 13), rng.integers(0, len(whole), 300)])
    damaged = tmp_path / "damaged.h5"
    for place in places[(places < len(MARK)) | (places >= USER_BLOCK)]:
        content = bytearray(whole)
        content[place] ^= int(rng.integers(1, 256))
        damaged.write_bytes(bytes(content))
        if place < len(MARK):  # no checksum any more; the content is whole
            read_installed_state(damaged)
            continue
        with pytest.raises(StateFileError, match="does not match its checksum"):
            read_installed_state(damaged)


def test_other_readers_see_an_ordinary_file_and_files_without_checksum_are_read(path, tmp_path):
    with h5py.File(path) as file:
        assert file.userblock_size == USER_BLOCK
        with h5py.File(tmp_path / "old.h5", "w") as old:
            for name in file:
                file.copy(name, old)
            old.attrs.update(file.attrs)
    read_installed_state(tmp_path / "old.h5")


def test_what_the_library_raises_becomes_one_sentence(path):
    with pytest.raises(StateFileError, match=r"damaged \(KeyError"), open_state_file(path) as file:
        file["no such group"]


def test_file_from_before_a_field_was_added_is_read_with_its_default(path):
    with h5py.File(path, "r+") as file:
        del file["history/remesh_stress_change"]
    seal(path)
    history = read_installed_state(path).history
    assert np.isnan(history.remesh_stress_change).all()
    assert history.remesh_stress_change.shape == history.penetration.shape
