"""PB3-PB5: rigid strips and circles on Mohr-Coulomb sand with associated flow, finite elements.

Claimed: the load reaches a flat plateau, from above; its error falls with the element size at the
edge of the footing, and lies within 3 % (N_q, N_c up to 35 deg) and 5 % of the exact factor.
Newton's method is quadratic, without cohesion too.
"""

import numpy as np
import pytest

from install_mpm.conventions import Kinematics
from install_mpm.newton import ROUND_OFF
from workflows.errors import CaseError
from workflows.verification.references.bearing_capacity import (
    CIRCLE_WEIGHT,
    STRIP_WEIGHT,
    strip_factors,
)
from workflows.verification.registry import problem
from workflows.verification.runner import newton_statement, run_problem
from workflows.verification.sand_footing import Strength, sand_footing

pytestmark = [pytest.mark.dolfinx, pytest.mark.gmsh]

PHI = np.deg2rad(30.0)
N_Q, N_C = strip_factors(friction_angle=PHI)


@pytest.fixture(scope="module")
def surcharged():
    return [
        sand_footing(size, Strength.SURCHARGE, N_Q, friction_angle=PHI, is_rough=True)
        for size in (0.1, 0.025)
    ]


def test_factor_is_approached_from_above(surcharged):
    coarse, fine = (result.plateau / N_Q - 1.0 for result in surcharged)
    assert 0.0 < fine < 0.05
    assert fine < 0.7 * coarse
    assert all(abs(result.slope) < 2e-3 for result in surcharged)


def test_cohesion_is_a_shift_of_the_stress(surcharged):
    """Caquot: c cot(phi) acts as an isotropic stress, so N_c = (N_q - 1) cot(phi) on any mesh."""
    cohesive = sand_footing(0.1, Strength.COHESION, N_C, friction_angle=PHI, is_rough=True)
    shifted = (surcharged[0].plateau - 1.0) / np.tan(PHI)
    assert cohesive.plateau == pytest.approx(shifted, rel=2e-3)


@pytest.mark.parametrize("cohesion", [0.0, 1.0])
def test_weight_carries_without_cohesion(cohesion):
    """1 Pa of cohesion, a ten-thousandth of gamma B / 2, does not show: none is needed."""
    exact = STRIP_WEIGHT["smooth"][30]
    footing = sand_footing(
        0.1, Strength.WEIGHT, exact, friction_angle=PHI, is_rough=False, cohesion=cohesion
    )
    assert 0.0 < footing.plateau / exact - 1.0 < 0.2
    assert abs(footing.slope) < 2e-3


def test_newton_is_quadratic_without_cohesion():
    """Although a point or two at the edge of the footing is at the apex, where no stiffness is."""
    footing = sand_footing(
        0.025, Strength.WEIGHT, STRIP_WEIGHT["smooth"][30], friction_angle=PHI, is_rough=False
    )
    assert newton_statement(footing.residuals, ROUND_OFF).check.is_met


def test_circle():
    circle = sand_footing(
        0.05, Strength.SURCHARGE, 37.21, friction_angle=PHI, is_rough=True,
        kinematics=Kinematics.AXISYMMETRIC,
    )  # fmt: skip
    assert 37.21 < circle.plateau < 1.1 * 37.21


@pytest.mark.parametrize("identifier", ["PB4-SMOOTH", "PB4-ROUGH", "PB5"])
def test_angle_without_reference_is_refused(identifier):
    with pytest.raises(CaseError, match=r"phi: .* known for phi = 20 deg"):
        problem(identifier).run(phi=float(np.deg2rad(33.0)))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("identifier", "degrees"),
    [
        *[("PB3", degrees) for degrees in (20, 30, 40)],
        *[("PB4-SMOOTH", degrees) for degrees in STRIP_WEIGHT["smooth"]],
        *[("PB4-ROUGH", degrees) for degrees in STRIP_WEIGHT["rough"]],
        *[("PB5", degrees) for degrees in CIRCLE_WEIGHT["smooth"]],
    ],
)
def test_factors_of_the_reference(identifier, degrees):
    result = run_problem(problem(identifier), {"phi": float(np.deg2rad(degrees))})
    assert not [check for check in result.checks if not check.is_met]
