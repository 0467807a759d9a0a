"""Source files that a module of the project is made of: its own and all that it imports."""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from workflows.manifest import PACKAGES, ROOT


def sources_hash(module: str) -> str:
    """Return a hash of what ``module`` and all that it imports of the project do.

    Parameters
    ----------
    module
        Name with dots, e.g. ``workflows.verification.annulus``.

    Returns
    -------
    str
        Comments, docstrings and layout do not count.
    """
    digest = hashlib.sha256()
    for path in sources_of(module):
        digest.update(f"{path.relative_to(ROOT).as_posix()}\n{_statements(path)}\n".encode())
    return digest.hexdigest()


def sources_of(module: str) -> list[Path]:
    """Return the files of ``module`` and of what it imports of the project, sorted.

    Imports inside functions count; what is imported by a computed name is not seen.
    """
    found: set[Path] = set()
    waiting = {module}
    while waiting:
        new = {path for name in waiting for path in _files(name)} - found
        found |= new
        waiting = {name for path in new for name in _imports(path)}
    return sorted(found)


def _files(module: str) -> Iterator[Path]:
    """Yield the file of a module of the project and those of the packages it lies in."""
    parts = module.split(".")
    if parts[0] not in PACKAGES:
        return
    for length in range(1, len(parts) + 1):
        path = ROOT.joinpath(*parts[:length])
        for file in (path.with_suffix(".py"), path / "__init__.py"):
            if file.is_file():
                yield file


@cache
def _imports(path: Path) -> frozenset[str]:
    """Return the names that a file imports; of ``from a import b`` both a and a.b."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return frozenset(names)


@cache
def _statements(path: Path) -> str:
    """Return the syntax tree of a file as text, without docstrings."""
    tree = ast.parse(path.read_bytes())
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            node.body = [entry for entry in node.body if not _is_docstring(entry)]
    return ast.dump(tree)


def _is_docstring(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)
