"""PA11 and PA12: two blocks and one interface element (paper, Fig. 9).

The closed form is c L + N tan(phi).  Claimed: the force follows the springs in series and then the
Mohr-Coulomb strength to 1e-8, for the paper's data and for others; Newton needs at most three
iterations after the first slip.
"""

import numpy as np
import pytest

from workflows.verification.interface_shear import interface_shear


@pytest.mark.parametrize("is_held_vertically", [True, False])
def test_flat_curve_of_the_papers_data(is_held_vertically):
    result = interface_shear(is_held_vertically=is_held_vertically)
    np.testing.assert_allclose(result.force, result.exact, rtol=1e-8)
    np.testing.assert_allclose(result.force, 0.1, rtol=1e-8)  # c L = 1.0e-4 kN/m
    expected_slip = 0.49996 if is_held_vertically else 0.49992
    assert result.slip == pytest.approx(expected_slip, rel=1e-6)
    assert max(len(residuals) - 1 for residuals in result.residuals[1:]) <= 3


def test_elastic_branch_and_plateau_under_precompression():
    result = interface_shear(precompression=1e3)
    np.testing.assert_allclose(result.force, result.exact, rtol=1e-8)
    published = 1e3 * np.array([0.124969, 0.249938, 0.374906] + 7 * [0.445329])
    np.testing.assert_allclose(result.force, published, rtol=3e-6)
    assert max(len(residuals) - 1 for residuals in result.residuals) <= 3


def test_other_parameters_follow_the_closed_form():
    result = interface_shear(
        youngs_modulus=3e6,
        shear_stiffness=2e7,
        cohesion=4e3,
        friction_angle=np.deg2rad(31.0),
        precompression=50e3,
        displacement=0.1,
        steps=7,
    )
    np.testing.assert_allclose(result.force, result.exact, rtol=1e-8)
    assert result.force[0] < result.force[-1]
