"""Every reference problem runs with other values than its defaults, and refuses meaningless ones.

Where a problem takes long its numerical parameters are reduced; its checks then need not hold, but
it has to be solved.
"""

import sys

import pytest

from workflows import cli
from workflows.verification.parameters import parameters_of
from workflows.verification.ranges import ANY, range_of_values
from workflows.verification.registry import problems
from workflows.verification.runner import run_problem

PROBLEMS = problems()

CHANGED = {
    "AMPLE-BEAM": {"P": 80e3, "cells": 1},
    "AMPLE-COLLAPSE": {"rho": 900.0, "cells": 8},
    "FIG6": {"E": 20e3, "h": 1.0, "penetration": 0.2},
    "FIG6-DEFAULT": {"E": 20e3, "h": 1.0, "penetration": 0.2},
    "FIG6-FRICTION": {"phi": 0.3, "h_coarse": 1.0, "h_fine": 0.5, "penetration": 0.2},
    "FIG6-HENCKY": {"E": 20e3, "h": 1.0, "penetration": 0.2},
    "FIG6-SMOOTHING": {"phi": 0.3, "h_coarse": 1.0, "h_fine": 0.5, "penetration": 0.2},
    "FIG7": {"nu": 0.2},
    "FIG7-HENCKY": {"q": 1.2},
    "FIG8": {"E": 20e3, "h": 1.0, "penetration": 0.2},
    "PA1": {"rho": 60.0, "rows": 4, "steps": 10},
    "PA2": {"P": 50e3, "cells": 1, "steps": 20},
    "PA3": {"nu": 0.2},
    "PA6": {"sigma_xx": 50e3},
    "PA7": {"b": 3.0, "nu": 0.2},
    "PA8": {"b": 3.0},
    "PA9": {"b": 3.0},
    "PA11": {"c": 50.0},
    "PA12": {"p": 2e3},
    "PA13": {"c": 400.0},
    "PA14": {"delta": 0.3},
    "PA15": {"psi": 0.0},
    "PA16": {"G_over_su": 50.0},
    "PA16-PLANE": {"G_over_su": 50.0, "outer_ratio": 10.0, "steps": 25, "size": 0.3},
    "PA16-SPHERE": {"G_over_su": 50.0, "outer_ratio": 10.0, "steps": 25, "size": 0.3},
    "PB6": {"su": 5e3, "size": 0.3, "steps": 8},
    "PB7": {"alpha_2": 0.5, "penetration": 1.0, "size": 0.5, "step": 0.2},
    "PB9": {"alpha": 0.3, "size": 0.5, "penetration": 0.1},
    "SCHEMES": {"K0": 0.7, "rows": 8, "steps": 10},
}
"""One physical parameter, and the numerical ones that make a slow problem short.

Of a problem that is not named here the first parameter that is a number grows by a tenth.
"""

REDUCED = {
    "AMPLE-BEAM", "AMPLE-COLLAPSE", "FIG6-FRICTION", "PA1", "PA2", "PA16-PLANE", "PA16-SPHERE",
    "PB6", "PB7", "PB9", "SCHEMES",
}  # fmt: skip
"""Problems that are too coarse here for their checks."""


WITHOUT_ITERATIONS = {"PA4", "PA4-3D", "PC1", "PE1", "PE7", "PE8"}
"""Problems whose motion is given at every node or component: nothing is left to iterate."""


def other_values(name):
    if name in CHANGED:
        return CHANGED[name]
    numbers = (one for one in parameters_of(PROBLEMS[name]).values() if one.kind is float)
    first = next(one for one in numbers if one.default)
    return {first.name: 1.1 * first.default}


def test_changed_parameters_exist():
    for name in PROBLEMS:
        assert set(other_values(name)) <= set(parameters_of(PROBLEMS[name])), name


@pytest.mark.slow
@pytest.mark.gmsh
@pytest.mark.dolfinx
@pytest.mark.parametrize("name", PROBLEMS)
def test_problem_with_other_values(name):
    result = run_problem(PROBLEMS[name], other_values(name))
    assert result.outcome is not None, result.failure
    assert (result.newton is None) == (name in WITHOUT_ITERATIONS)
    if name not in REDUCED:
        assert not [check for check in result.checks if not check.is_met]


def meaningless():
    """Yield for each parameter with a range the problem, the parameter and a value below it."""
    for name, problem in PROBLEMS.items():
        for parameter in parameters_of(problem).values():
            symbol = parameter.unit.symbol if parameter.unit else ""
            if range_of_values(parameter.name, symbol, parameter.default) is not ANY:
                yield pytest.param(name, parameter, id=f"{name}-{parameter.name}")


@pytest.mark.parametrize(("name", "parameter"), meaningless())
def test_meaningless_value_is_refused_in_one_sentence(name, parameter, monkeypatch, capsys):
    value = "-2" if parameter.kind in (int, float) else parameter.default
    monkeypatch.setattr(
        sys, "argv", ["screwpile", "verify", name, "--set", f"{parameter.name}={value}"]
    )
    with pytest.raises(SystemExit) as stopped:
        cli.main()
    assert stopped.value.code == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    (line,) = captured.err.splitlines()
    assert f"{name}: {parameter.name}: -2" in line
    assert "has no meaning; it has to be" in line


def test_every_modulus_and_length_has_a_range():
    free = {
        (name, one.name)
        for name, problem in PROBLEMS.items()
        for one in parameters_of(problem).values()
        if one.unit is not None and range_of_values(one.name, one.unit.symbol, one.default) is ANY
    }
    stresses = {"sigma_xx", "sigma_yy", "tau_xy", "sigma_h", "sigma_v"}
    assert {parameter for _, parameter in free} == stresses
