"""PD7: uniform pressure on a circle on a half space: settlement and stress on the axis, to 1 %."""

import numpy as np
import pytest

from workflows.verification.flexible_load import PROBLEM
from workflows.verification.revolution import half_space_mesh, pressure_force

pytestmark = [pytest.mark.dolfinx, pytest.mark.gmsh]


@pytest.mark.parametrize(
    "values", [{}, {"R": 0.4, "q": 20e3, "E": 3e6, "nu": 0.45}], ids=["default", "other"]
)
def test_settlement_and_stress_are_those_of_the_half_space(values):
    outcome = PROBLEM.run(**values)
    assert [check.quantity for check in outcome.checks if not check.is_met] == []
    curve = outcome.series[0]
    np.testing.assert_allclose(
        curve.computed, curve.reference, rtol=0, atol=0.01 * max(curve.reference)
    )


def test_references_are_those_of_the_table():
    checks = PROBLEM.run().checks
    assert checks[0].reference == pytest.approx(18.20e-3, rel=1e-3)
    assert checks[1].reference == pytest.approx(11.586e-3, rel=1e-3)
    assert [check.reference for check in checks[2:5]] == pytest.approx(
        [-91.06e3, -64.64e3, -28.45e3], rel=1e-3
    )


def test_pressure_acts_on_the_whole_circle():
    mesh = half_space_mesh(1.0, 5.0, 0.5, 0.3)
    is_loaded = mesh.nodes[mesh.facet_nodes[:, 2], 1] > -1e-9
    force = pressure_force(mesh, is_loaded)
    np.testing.assert_allclose(force.sum(axis=0), [0.0, -np.pi * 25.0], atol=1e-12)
    side = pressure_force(mesh, mesh.nodes[mesh.facet_nodes[:, 2], 0] > 5.0 - 1e-9)
    np.testing.assert_allclose(side.sum(axis=0), [-2.0 * np.pi * 25.0, 0.0], atol=1e-12)
