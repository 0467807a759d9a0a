"""PA4 and PA5: stress carried by a rotation; published values, matrix product, full turn."""

import numpy as np
import pytest

from workflows.verification.references.rotated_stress import rotated_stress


@pytest.mark.parametrize(("degrees", "expected"), [(45, (-95, -55, -25)), (90, (-50, -100, -20))])
def test_published_digits(degrees, expected):
    rotated = rotated_stress(-100.0, -50.0, 20.0, angle=np.deg2rad(degrees))
    np.testing.assert_allclose(rotated, expected, rtol=0, atol=1e-12)


def test_equals_the_matrix_product_and_turns_back():
    angle = 0.7
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    stress = np.array([[3.0, -2.0], [-2.0, 5.0]])
    product = turn @ stress @ turn.T
    rotated = rotated_stress(3.0, 5.0, -2.0, angle=angle)
    np.testing.assert_allclose(rotated, [product[0, 0], product[1, 1], product[0, 1]])
    np.testing.assert_allclose(rotated_stress(*rotated, angle=-angle), [3.0, 5.0, -2.0])
    np.testing.assert_allclose(rotated_stress(0.0, 0.0, 0.0, angle=angle), 0.0)
