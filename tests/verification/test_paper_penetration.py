"""FIG6, FIG8: the penetrating pile of the paper.

Claimed: the paper's scheme gives the reactions of an independent prototype within 1 %, with either
condition at the outer side and with elastic interfaces; the default discretisation makes all 40
steps without a cut; no energy is made; Newton ends quadratically.
"""

import numpy as np
import pytest

from install_mpm.discretisation import Scheme
from install_mpm.newton import convergence_order
from workflows.verification.paper_friction import fig6_friction, fig6_smoothing
from workflows.verification.paper_hencky import fig6_hencky
from workflows.verification.paper_penetration import fig6, fig6_default, fig8
from workflows.verification.penetration import Penetration, penetrate, work_and_energy
from workflows.verification.references import prototype

pytestmark = pytest.mark.gmsh


def assert_all_met(outcome):
    assert not [check for check in outcome.checks if not check.is_met]


def median_order(residual_histories):
    return np.nanmedian([convergence_order(np.array(values)) for values in residual_histories])


def test_first_steps_without_slip_agree_with_the_prototype():
    outcome = fig6(penetration=0.3)
    assert_all_met(outcome)
    assert sum("step 1 " in check.quantity for check in outcome.checks) == 2
    assert median_order(outcome.residual_histories) > 1.8


def test_reaction_is_proportional_to_the_modulus():
    outcome = fig6(penetration=0.1, E=25e3)
    first = next(check for check in outcome.checks if "step 1 " in check.quantity)
    assert first.reference == pytest.approx(2.5 * prototype.NO_SLIP[0.5, False][1])
    assert_all_met(outcome)


def test_compressible_soil_with_lateral_strain_is_run_without_a_table():
    outcome = fig6(penetration=0.1, nu=0.3)
    assert outcome.series[0].computed[0] == pytest.approx(727.2, rel=1e-3)  # prototype, roller
    assert_all_met(outcome)


def test_first_steps_with_elastic_interfaces_agree_with_the_prototype():
    outcome = fig8(penetration=0.3)
    assert_all_met(outcome)
    assert median_order(outcome.residual_histories) > 1.8


def test_first_steps_of_the_default_discretisation_lose_no_energy():
    problem = Penetration(steps=3, scheme=Scheme.CARRIERS)
    result = penetrate(problem)
    work, energy = work_and_energy(result, problem)
    assert result.cuts == 0
    assert energy == pytest.approx(work, rel=5e-3)


def test_first_steps_with_friction():
    outcome = fig6_friction(penetration=0.2, h_coarse=1.0, h_fine=0.5)
    checks = {check.quantity: check for check in outcome.checks}
    coarse = checks.pop("reaction on the coarse mesh against the fine, N/m")
    assert abs(coarse.error) < 0.1
    assert all(check.is_met for check in checks.values())


def test_smoothing_vanishes_in_the_first_steps():
    assert_all_met(fig6_smoothing(penetration=0.2, h_coarse=1.0, h_fine=0.5))


def test_first_steps_in_hencky_soil_are_elliptic():
    outcome = fig6_hencky(penetration=0.2, h=1.0)
    assert_all_met(outcome)
    assert all("all soil is elliptic" in remark for remark in outcome.remarks)


def test_the_two_discretisations_agree_while_cells_are_little_deformed():
    default = penetrate(Penetration(steps=3, scheme=Scheme.CARRIERS)).reaction
    paper = penetrate(Penetration(steps=3)).reaction
    np.testing.assert_allclose(default, paper, rtol=0.01)


@pytest.mark.slow
@pytest.mark.parametrize(
    "run", [fig6, fig6_default, fig8, fig6_friction, fig6_smoothing, fig6_hencky]
)
def test_four_metres(run):
    assert_all_met(run())


@pytest.mark.slow
def test_four_metres_without_slip_on_the_finer_mesh():
    result = penetrate(Penetration(size=0.25))
    for step, force in prototype.NO_SLIP[0.25, False].items():
        assert result.reaction_at(0.1 * step) == pytest.approx(force, rel=0.01)
