"""The hand-over with the finite-element problem of the service stage."""

import numpy as np
import pytest

from handoff.hand_over import hand_over
from handoff.synthetic import airy_stress
from install_mpm.pile import tangent_of

pytestmark = [pytest.mark.dolfinx, pytest.mark.gmsh]


@pytest.fixture
def run(site):
    from service_fe.problem import ServiceProblem

    def run(installed):
        return hand_over(
            installed,
            site.ground,
            site.placed,
            site.box,
            site.interface,
            site.options,
            lambda mesh: ServiceProblem(mesh, site.ground, site.interface),
            lambda phase: None,
        )

    return run


def test_undisturbed_ground_is_in_equilibrium_and_stays(run, undisturbed):
    """PF2: residual over weight at round-off without equilibration, no displacement."""
    _, certificate = run(undisturbed)
    value = {name: figure.value for name, figure in certificate.figures.items()}
    assert value["out_of_balance_geostatic"] < 1e-13
    assert value["out_of_balance_before"] < 1e-13
    assert value["equilibration_displacement"] == 0.0


def test_balanced_stress_needs_little_equilibration(run, undisturbed, site):
    """A steep field that is balanced in truth: what is released is the error of mesh and map."""
    points, interface = undisturbed.material_points, undisturbed.interface
    extra, on_pile = (
        0.3 * airy_stress(site.ground, site.pile, 2.0, places)
        for places in (points.position, interface.position)
    )
    traction = np.einsum("nij,nj->ni", on_pile[:, :2, :2], interface.normal)
    local = [
        np.einsum("ni,ni->n", traction, axes)
        for axes in (tangent_of(interface.normal), interface.normal)
    ]
    extra_traction = np.column_stack(local) * interface.covered[:, None]
    _, certificate = run(
        undisturbed._replace(
            material_points=points._replace(kirchhoff_stress=points.kirchhoff_stress + extra),
            interface=interface._replace(traction=interface.traction + extra_traction),
        )
    )
    value = {name: figure.value for name, figure in certificate.figures.items()}
    assert 1e-5 < value["out_of_balance_before"] < 0.01
    assert value["out_of_balance_after"] <= 1e-8
    assert value["equilibration_stress_change"] < 0.01
    assert certificate.figures["pile_reaction_change"].is_met
