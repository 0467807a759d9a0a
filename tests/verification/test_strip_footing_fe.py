"""PB1: rough rigid strip footing on weightless clay in plane strain, N_c = 2 + pi (Prandtl).

Claimed: with quadratic triangles the load reaches a flat plateau, from above, with an error that
falls in proportion to the element size at the footing's edge, and below 3 % on the finer mesh.
"""

import numpy as np
import pytest

from install_mpm.newton import convergence_order
from workflows.verification.strip_footing_fe import EXACT, strip_footing

pytestmark = [pytest.mark.dolfinx, pytest.mark.gmsh]

COARSE, FINE = 0.05, 0.0125


@pytest.fixture(scope="module")
def footings():
    return strip_footing(COARSE), strip_footing(FINE)


def test_plateau_is_close_to_prandtl_and_from_above(footings):
    coarse, fine = footings
    assert pytest.approx(5.1416, abs=1e-4) == EXACT
    assert 0.0 < fine.error < 0.03
    assert 0.0 < coarse.error < 0.05


def test_error_falls_with_the_element_size(footings):
    coarse, fine = footings
    assert fine.error < 0.6 * coarse.error


def test_load_has_reached_its_plateau(footings):
    for footing in footings:
        assert abs(footing.slope) < 1e-3


def test_newton_ends_quadratically(footings):
    for footing in footings:
        histories = [np.array(residuals) for residuals in footing.residuals]
        orders = np.array([convergence_order(history) for history in histories])
        assert np.nanmedian(orders) >= 1.8
        assert footing.iterations.max() <= 12
