"""Bodies, meshes and slabs in motion in space.

Claimed: rigid rotation and a mesh that moves as that of a screw pile leave a uniform stress as it
is, a uniformly deformed slab is in plane strain to round-off, and a sheared one in the limit.
"""

import numpy as np
import pytest

from workflows.verification.moving_solid import (
    moving_mesh,
    stress_free_rotation,
    stressed_rotation,
)
from workflows.verification.slab import sheared_slab, uniform_slab


def assert_met(outcome):
    assert all(check.is_met for check in outcome.checks), outcome.checks


@pytest.mark.parametrize("parameters", [{}, {"R": 3.0, "nu": 0.0, "E": 1e6}])
def test_rotation_without_stress(parameters):
    assert_met(stress_free_rotation(steps=4, **parameters))


@pytest.mark.parametrize("parameters", [{}, {"R": 0.5, "nu": 0.45, "tau": -40e3, "steps": 5}])
def test_rotation_with_stress(parameters):
    assert_met(stressed_rotation(**parameters))


@pytest.mark.parametrize("parameters", [{}, {"R": 0.7, "tau": -40e3, "advance_ratio": -0.3}])
def test_moving_mesh(parameters):
    assert_met(moving_mesh(**parameters))


@pytest.mark.parametrize("advance_ratio", [0.6, -1.0])
def test_moving_mesh_that_would_fold_is_refused(advance_ratio):
    with pytest.raises(ValueError, match=r"folds the mesh: give less than 0\.6"):
        moving_mesh(advance_ratio=advance_ratio)


@pytest.mark.parametrize(
    "parameters",
    [{}, {"nu": 0.45, "su": 3e3, "p0": 50e3, "phi": np.radians(20.0), "shear": -0.2}],
)
def test_uniform_slab(parameters):
    assert_met(uniform_slab(**parameters))


@pytest.mark.parametrize("parameters", [{}, {"E": 5e3, "nu": 0.0, "shear": 0.05}])
def test_sheared_slab(parameters):
    assert_met(sheared_slab(**parameters))
