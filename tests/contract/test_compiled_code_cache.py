"""The folder of compiled code changes with the sources of the kernels, so no stale code is run."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from install_mpm._jit import _remove_unused_folders, cache_folder, kernel_sources, source_hash

ROOT = Path(__file__).resolve().parents[2]

CALLEE = """
from install_mpm._jit import jit

@jit
def modulus(x):
    return {factor} * x
"""

CALLER = """
from install_mpm._jit import jit
from install_mpm.kernels.callee import modulus

@jit
def stress(x):
    return modulus(x) + 1.0
"""

RUN = """
from install_mpm._jit import cache_folder
from install_mpm.kernels.caller import stress
print(stress(2.0), sum(stress.stats.cache_hits.values()), cache_folder())
"""


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A copy of _jit.py with a kernel that calls another one in a second file."""
    kernels = tmp_path / "tree" / "install_mpm" / "kernels"
    kernels.mkdir(parents=True)
    (kernels / "__init__.py").touch()
    (kernels.parent / "__init__.py").touch()
    (kernels.parent / "_jit.py").write_bytes((ROOT / "install_mpm" / "_jit.py").read_bytes())
    (kernels / "callee.py").write_text(CALLEE.format(factor=3.0))
    (kernels / "caller.py").write_text(CALLER)
    return tmp_path / "tree"


def run(tree: Path, **environment: str) -> list[str]:
    kept = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_")}
    result = subprocess.run(
        [sys.executable, "-c", RUN],
        cwd=tree,
        env={**kept, "XDG_CACHE_HOME": str(tree.parent / "cache"), **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stderr
    return result.stdout.split()


def test_edit_of_a_callee_in_another_file_is_noticed(tree: Path) -> None:
    value, hits, folder = run(tree)
    assert (value, hits) == ("7.0", "0")
    assert run(tree) == ["7.0", "1", folder]  # a second process finds the compiled code
    (tree / "install_mpm" / "kernels" / "callee.py").write_text(CALLEE.format(factor=5.0))
    value, hits, new_folder = run(tree)
    assert (value, hits) == ("11.0", "0")
    assert new_folder != folder
    assert Path(folder).parent == Path(new_folder).parent


def test_cache_folder_of_the_environment_is_used(tree: Path) -> None:
    base = tree.parent / "elsewhere"
    folder = Path(run(tree, NUMBA_CACHE_DIR=str(base))[2])
    assert folder == base / source_hash(tree)
    assert list(folder.rglob("*.nbi"))


def test_nothing_is_cached_where_the_folder_cannot_be_made(tree: Path) -> None:
    (tree.parent / "file").touch()
    value, hits, folder = run(tree, XDG_CACHE_HOME=str(tree.parent / "file"))
    assert (value, hits, folder) == ("7.0", "0", "None")
    assert not list(tree.rglob("*.nbi"))


@pytest.mark.parametrize("file", ["callee.py", "caller.py"])
def test_hash_depends_on_each_kernel_source(tree: Path, file: str) -> None:
    before = source_hash(tree)
    with (tree / "install_mpm" / "kernels" / file).open("a") as source:
        source.write("\n")
    assert source_hash(tree) != before


def test_hash_covers_the_files_with_kernels() -> None:
    names = {str(file.relative_to(ROOT)) for file in kernel_sources(ROOT)}
    assert "install_mpm/_jit.py" in names
    assert any(name.startswith("install_mpm/constitutive/") for name in names)
    assert any(name.startswith("install_mpm/kernels/") for name in names)
    assert "install_mpm/state_file.py" not in names


def test_this_process_uses_the_folder_of_its_sources() -> None:
    folder = cache_folder()
    assert folder is not None
    assert folder.name == source_hash(ROOT)


def test_only_old_hash_folders_are_removed(tmp_path: Path) -> None:
    old, recent, foreign = (tmp_path / name for name in ("a" * 32, "b" * 32, "other"))
    for folder in (old, recent, foreign):
        (folder / "inner").mkdir(parents=True)
    month_ago = time.time() - 31 * 24 * 3600
    os.utime(old, (month_ago, month_ago))
    os.utime(foreign, (month_ago, month_ago))
    _remove_unused_folders(tmp_path)
    assert sorted(folder.name for folder in tmp_path.iterdir()) == ["b" * 32, "other"]
