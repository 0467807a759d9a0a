"""PB1: rough rigid strip footing on weightless clay through the installation step, N_c = 2 + pi.

Claimed: quadratic cells with element-mean dilatation reach a flat plateau, from above, with an
error that falls with the size of the cells at the footing's edge and is below 3 % on the finer
mesh.
"""

import numpy as np
import pytest

from install_mpm.newton import convergence_order
from workflows.verification.strip_footing_mpm import strip_footing

pytestmark = [pytest.mark.dolfinx, pytest.mark.gmsh]

COARSE, FINE = 0.05, 0.0125
ROUND_OFF = 1e-9  # relative residual at which the rigidity index of 20,000 leaves nothing to gain


@pytest.fixture(scope="module")
def footings():
    return strip_footing(COARSE), strip_footing(FINE)


def test_plateau_is_close_to_prandtl_and_from_above(footings):
    coarse, fine = footings
    assert 0.0 < fine.error < 0.03
    assert 0.0 < coarse.error < 0.05


def test_error_falls_with_the_cell_size(footings):
    coarse, fine = footings
    assert fine.error < 0.6 * coarse.error


def test_load_has_reached_its_plateau(footings):
    for footing in footings:
        assert abs(footing.slope) < 1e-3


def test_newton_ends_quadratically(footings):
    for footing in footings:
        orders = [
            convergence_order(np.array(residuals), ROUND_OFF) for residuals in footing.residuals
        ]
        assert np.nanmedian(orders) >= 1.8
