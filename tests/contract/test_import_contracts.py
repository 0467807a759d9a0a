"""Who may import whom: the contracts in pyproject.toml, and numba's decorator only through _jit."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

from install_mpm._jit import kernel_sources

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("install_mpm", "handoff", "service_fe", "workflows")


def imports(file: Path) -> list[tuple[str, str]]:
    """Return (module, name) of each import in `file`; the name is empty for ``import module``."""
    found = []
    for node in ast.walk(ast.parse(file.read_bytes())):
        if isinstance(node, ast.Import):
            found += [(alias.name, "") for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            package = list(file.relative_to(ROOT).parent.parts)
            base = package[: len(package) - node.level + 1] if node.level else []
            module = ".".join([*base, *([node.module] if node.module else [])])
            found += [(module, alias.name) for alias in node.names]
    return found


def source_of(module: str) -> Path | None:
    path = ROOT.joinpath(*module.split("."))
    candidates = (path.with_suffix(".py"), path / "__init__.py")
    return next((file for file in candidates if file.is_file()), None)


def test_import_contracts_hold() -> None:
    command = Path(sys.executable).with_name("lint-imports")
    result = subprocess.run(
        [command, "--no-cache"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stdout + result.stderr


def test_decorator_of_numba_only_in_jit() -> None:
    decorators = {"jit", "njit", "vectorize", "guvectorize", "cfunc", "stencil", "jitclass"}
    offenders = [
        f"{file.relative_to(ROOT)}: {module} {name}"
        for package in PACKAGES
        for file in (ROOT / package).rglob("*.py")
        if file.name != "_jit.py"
        for module, name in imports(file)
        if module.split(".")[0] == "numba" and name in decorators
    ]
    assert not offenders


@pytest.mark.parametrize("file", kernel_sources(ROOT), ids=lambda file: str(file.relative_to(ROOT)))
def test_constants_of_kernels_stand_in_hashed_files(file: Path) -> None:
    """A constant that a kernel takes from a file outside the hash would go stale in the cache.

    Types (CamelCase) may come from anywhere: numba's own key holds the types of the arguments.
    """
    hashed = set(kernel_sources(ROOT))
    outside = []
    for module, name in imports(file):
        if module.split(".")[0] not in PACKAGES:
            continue
        source = source_of(f"{module}.{name}") or source_of(module)
        is_type = name[:1].isupper() and not name.isupper()
        if source not in hashed and not is_type:
            outside.append(f"{module} {name}")
    if any(
        module == "numba" or "_jit" in (module.split(".")[-1], name)
        for module, name in imports(file)
    ):
        assert not outside
