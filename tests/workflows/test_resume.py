"""An installation that is killed and resumed gives the same file, bit for bit."""

import importlib.util
import random
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent
QUICK = FOLDER.parents[1] / "cases" / "jacked_pile_clay_quick.toml"

specification = importlib.util.spec_from_file_location("interrupted", FOLDER / "interrupted.py")
interrupted = importlib.util.module_from_spec(specification)
specification.loader.exec_module(interrupted)


@pytest.mark.dolfinx
@pytest.mark.parametrize("kills", [2, pytest.param(5, marks=pytest.mark.slow)])
def test_killed_and_resumed_installation_is_bit_equal(kills, quick_results, tmp_path):
    assert quick_results.exists()  # everything is compiled
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    duration = interrupted.wait_for(interrupted.start_install(QUICK, whole))
    source = random.Random(20 + kills)
    moments = interrupted.install_with_kills(QUICK, broken, kills, duration, source)
    assert len(moments) == kills
    assert interrupted.differences(whole / "installed.h5", broken / "installed.h5") == []
    assert sorted(path.name for path in broken.glob("*.h5*")) == ["installed.h5"]


def test_differences_are_found(tmp_path):
    import h5py

    for name, value in (("a", 1.0), ("b", 1.0 + 2.0**-52)):
        with h5py.File(tmp_path / f"{name}.h5", "w") as file:
            file.create_dataset("group/value", data=value)
    assert interrupted.differences(tmp_path / "a.h5", tmp_path / "a.h5") == []
    assert interrupted.differences(tmp_path / "a.h5", tmp_path / "b.h5") == ["group/value"]
