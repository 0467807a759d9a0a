"""Every reference problem runs with other values than its defaults, and refuses meaningless ones.

Where a problem takes long its numerical parameters are reduced; its checks then need not hold, but
it has to be solved.
"""

import sys

import numpy as np
import pytest

from workflows import cli
from workflows.verification.parameters import parameters_of
from workflows.verification.ranges import ANY, range_of_values
from workflows.verification.registry import problems
from workflows.verification.runner import run_problem

PROBLEMS = problems()

CHANGED = {
    "AMPLE-BEAM": {"P": 80e3, "l": 20.0},
    "AMPLE-COLLAPSE": {"rho": 900.0, "cells": 8},
    "AMPLE-COLUMN": {"L0": 20.0, "rho": 200.0},
    "DISC-CLAY": {"t": 0.15, "su": 20e3},
    "FIG6": {"E": 20e3, "h": 1.0, "penetration": 0.2},
    "FIG6-DEFAULT": {"E": 20e3, "h": 1.0, "penetration": 0.2},
    "FIG6-FRICTION": {"phi": 0.3, "h_coarse": 1.0, "h_fine": 0.5, "penetration": 0.2},
    "FIG6-HENCKY": {"E": 20e3, "h": 1.0, "penetration": 0.2},
    "FIG6-SMOOTHING": {"phi": 0.3, "h_coarse": 1.0, "h_fine": 0.5, "penetration": 0.2},
    "FIG7": {"nu": 0.2},
    "FIG7-HENCKY": {"q": 1.2},
    "FIG8": {"E": 20e3, "h": 1.0, "penetration": 0.2},
    "KRATOS-BLOCK": {"phi": np.radians(25.0), "nu": 0.25},
    "KRATOS-BLOCK-3D": {"phi": np.radians(25.0), "nu": 0.25, "n": 8},
    "KRATOS-BLOCK-ROUND": {"phi": np.radians(25.0), "nu": 0.25},
    "OPENSEES-DP": {"phi": np.radians(35.0), "psi": np.radians(5.0), "nu": 0.2},
    "PA1": {"rho": 60.0},
    "PA2": {"P": 50e3, "nu": 0.3},
    "PA3": {"nu": 0.2},
    "PA4": {"nu": 0.45},
    "PA4-3D": {"nu": 0.45, "steps": 36},
    "PA5": {"tau_xy": -50e3, "nu": 0.2},
    "PA5-3D": {"tau": -30e3, "nu": 0.2},
    "PA6": {"sigma_xx": 50e3},
    "PA6-3D": {"sigma_h": -90e3, "advance_ratio": 0.5},
    "PA7": {"b": 3.0, "nu": 0.2},
    "PA7-3D": {"b": 3.0, "nu": 0.2},
    "PA8": {"b": 3.0},
    "PA8-3D": {"b": 3.0},
    "PA9": {"b": 3.0},
    "PA9-3D": {"b": 3.0},
    "PA10": {"p": 1.5, "nu": 0.2},
    "PA11": {"c": 50.0},
    "PA12": {"p": 2e3},
    "PA13": {"c": 400.0},
    "PA14": {"delta": 0.3},
    "PA15": {"psi": 0.0},
    "PA16": {"G_over_su": 50.0},
    "PA16-PLANE": {"G_over_su": 50.0, "outer_ratio": 10.0, "steps": 25, "size": 0.3},
    "PA16-SPHERE": {"G_over_su": 50.0, "outer_ratio": 10.0, "steps": 25, "size": 0.3},
    "PA18": {"phi": np.radians(35.0), "psi": np.radians(10.0)},
    "PA18-SPHERE": {"phi": np.radians(35.0), "E_over_p0": 500.0},
    "PB1": {"B": 2.0, "E_over_su": 10e3},
    "PB1-FE": {"B": 2.0, "E_over_su": 2000.0},
    "PB1-FE-TRESCA": {"B": 2.0, "E_over_su": 2000.0},
    "PB2": {"R": 2.0, "E_over_su": 10e3},
    "PB2-3D": {"R": 2.0, "E_over_su": 10e3},
    "PB2-FE": {"R": 2.0, "E_over_su": 2000.0},
    "PB3": {"phi": np.radians(25.0)},
    "PB4-ROUGH": {"phi": np.radians(25.0)},
    "PB4-SMOOTH": {"phi": np.radians(25.0)},
    "PB5": {"phi": np.radians(25.0)},
    "PB6": {"su": 5e3, "size": 0.3, "steps": 8},
    "PB6-FE": {"su": 5e3, "size": 0.3, "steps": 8},
    "PB7": {"alpha_2": 0.5, "penetration": 1.0, "size": 0.5, "step": 0.2},
    "PB9": {"alpha": 0.3, "size": 0.5, "penetration": 0.1},
    "PC1": {"p": 0.2, "alpha": 0.5},
    "PC1-PLATE": {"alpha": 0.5},
    "PC2": {"alpha": 0.3},
    "PC2-PLATE": {"alpha": 0.3},
    "PC3": {"p": 0.3, "alpha": 0.5},
    "PC7": {"H": 1.2, "phi": np.radians(35.0)},
    "PD1": {"nu": 0.2},
    "PD1-V": {"nu": 0.2},
    "PD3": {"L": 10.0, "Ep": 10e9, "extent": 60.0, "depth": 70.0},
    "PD5": {"G": 20e6, "nu": 0.4},
    "PD6": {"L": 8.0, "e": 2.0},
    "PD7": {"nu": 0.4},
    "PD8": {"nu": 0.2, "c": 3.0},
    "PD9": {"tau_y": 20e3, "cycles": 3},
    "PD10": {"b": 3.0, "nu": 0.2},
    "PE1": {"phi": np.radians(25.0), "psi": np.radians(25.0), "nu": 0.2},
    "PE2": {"psi": np.radians(10.0), "c": 5e3},
    "PE3": {"phi": np.radians(25.0), "nu": 0.2},
    "PE4": {"M": 1.0, "ocr": 2.0},
    "PE6": {"psi": 0.0, "K0": 0.5},
    "PE7": {"nu": 0.2},
    "PE8": {"phi": np.radians(25.0), "c": 20e3, "seed": 2},
    "PF1": {"neighbours": 40, "seed": 3},
    "PF2": {"gamma": 18e3, "K0": 0.8},
    "PF4": {"alpha": 0.8, "penetration": 0.2},
    "PF5": {"alpha": 0.8, "penetration": 0.2},
    "PF6": {"su": 20e3, "B": 2.0},
    "SCHEMES": {"K0": 0.7, "rows": 8, "steps": 10},
    "SHAFT-CLAY": {"a": 0.4, "su": 20e3},
    "SHAFT-SAND": {"delta": np.radians(15.0), "turned": np.radians(90.0)},
    "SLAB": {"phi": np.radians(25.0), "shear": 0.2},
    "SLAB-SHEAR": {"nu": 0.1, "shear": 0.2},
    "UNITS": {"length": 0.01, "mass": 1.0, "alpha": 1.0},
}
"""Physical parameters, and the numerical ones that make a slow problem short."""

REDUCED = {"AMPLE-COLLAPSE", "PB6", "PB6-FE", "PB7"}
"""Problems that are too coarse here, or end too early, for their checks."""

WITHOUT_ITERATIONS = {"OPENSEES-DP", "PA4", "PA4-3D", "PC1", "PE1", "PE7", "PE8", "PF1", "PF2"}
"""Problems whose motion is given at every node or component: nothing is left to iterate."""


def test_every_problem_is_changed_in_parameters_that_it_has():
    assert set(CHANGED) == set(PROBLEMS)
    for name, values in CHANGED.items():
        parameters = parameters_of(PROBLEMS[name])
        assert all(parameters[key].default != value for key, value in values.items()), name


@pytest.mark.slow
@pytest.mark.gmsh
@pytest.mark.dolfinx
@pytest.mark.parametrize("name", [name for name, one in PROBLEMS.items() if one.is_available])
def test_problem_with_other_values(name):
    result = run_problem(PROBLEMS[name], CHANGED[name])
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
