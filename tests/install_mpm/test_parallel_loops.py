"""Parallel loops of compiled code: what numba would get wrong without a word."""

import ast
from pathlib import Path

import pytest

import install_mpm

ROOT = Path(install_mpm.__file__).resolve().parent.parent
SOURCES = sorted(
    file
    for package in ("install_mpm", "handoff", "service_fe")
    for file in (ROOT / package).rglob("*.py")
    if "parallel_jit" in file.read_text()
)


def parallel_loops(source):
    """Loops over ``prange`` in the text of a module."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.For) and isinstance(node.iter, ast.Call):
            function = node.iter.func
            if isinstance(function, ast.Name) and function.id == "prange":
                yield node


def written(loop):
    """Targets of all assignments in a loop, those of nested loops too."""
    for node in ast.walk(loop):
        targets = getattr(node, "targets", None) or [getattr(node, "target", None)]
        for target in targets if isinstance(node, ast.Assign | ast.AugAssign) else []:
            yield from target.elts if isinstance(target, ast.Tuple) else [target]


def fields_written(source):
    """Fields of records that a parallel loop writes to: numba compiles this and loses them."""
    return [
        ast.unparse(target)
        for loop in parallel_loops(source)
        for target in written(loop)
        if any(isinstance(part, ast.Attribute) for part in ast.walk(target))
    ]


def reductions(source):
    """Scalars that a parallel loop adds to: their sum depends on the number of threads."""
    found = []
    for loop in parallel_loops(source):
        own = {
            target.id
            for node in ast.walk(loop)
            if isinstance(node, ast.Assign)
            for target in node.targets
            if isinstance(target, ast.Name)
        }
        found += [
            ast.unparse(node)
            for node in ast.walk(loop)
            if isinstance(node, ast.AugAssign)
            and isinstance(node.target, ast.Name)
            and node.target.id not in own
        ]
    return found


def test_parallel_loops_are_found():
    assert "evaluate_cells" in "".join(file.read_text() for file in SOURCES)
    assert sum(len(list(parallel_loops(file.read_text()))) for file in SOURCES) >= 5


@pytest.mark.parametrize("file", SOURCES, ids=lambda file: file.stem)
def test_no_parallel_loop_writes_to_a_field_of_a_record(file):
    """In a called function it works; directly in the loop the writes go to a copy."""
    assert fields_written(file.read_text()) == []


@pytest.mark.parametrize("file", SOURCES, ids=lambda file: file.stem)
def test_no_parallel_loop_adds_up_a_scalar(file):
    assert reductions(file.read_text()) == []


def test_the_checks_find_what_they_look_for():
    loop = "for p in prange(n):\n    total = 0\n    {}\n"
    assert fields_written(loop.format("trial.stress[p, 0] = 1.0")) == ["trial.stress[p, 0]"]
    assert fields_written(loop.format("a, trial.status[p] = 1, 2")) == ["trial.status[p]"]
    assert fields_written(loop.format("stress[p] = trial.stress[p]")) == []
    assert reductions(loop.format("force += 1.0")) == ["force += 1.0"]
    assert reductions(loop.format("total += 1.0")) == []
