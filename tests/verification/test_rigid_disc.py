"""PD1: vertical stiffness of a rigid disc on a half space, smooth and bonded, to 2 %."""

import numpy as np
import pytest

from workflows.verification.rigid_disc import PROBLEM, vertical_stiffness

pytestmark = [pytest.mark.dolfinx, pytest.mark.gmsh]


@pytest.mark.parametrize(
    "values", [{}, {"R": 2.5, "G": 40e6, "nu": 0.45}], ids=["default", "other"]
)
def test_stiffness_is_that_of_the_half_space(values):
    outcome = PROBLEM.run(**values)
    assert [check.quantity for check in outcome.checks if not check.is_met] == []
    for study in outcome.series:
        assert (np.diff(study.computed) < 0.0).all()
    for history in outcome.residual_histories:
        assert len(history) == 2  # linear: one iteration
        assert history[-1] < 1e-9


def test_ground_of_half_the_size_is_stiffer():
    """What is left of the error is the size of the ground: it doubles when that is halved."""
    small, large, larger = (
        vertical_stiffness(
            0.05, is_bonded=False, radius=1.0, shear_modulus=1.0, poissons_ratio=0.3, extent=extent
        )[0]
        for extent in (25.0, 50.0, 100.0)
    )
    assert (small - large) / (large - larger) == pytest.approx(2.0, rel=0.1)
