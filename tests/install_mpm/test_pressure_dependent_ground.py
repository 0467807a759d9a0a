"""Ground of pressure-dependent, undrained soil is in equilibrium, however its points lie."""

import numpy as np
import pytest

from install_mpm.constitutive.parameters import (
    CriticalStateSand,
    ModifiedCamClay,
    MohrCoulomb,
)
from install_mpm.ground import Ground, geostatic_stress

GROUNDS = {
    "clay": ModifiedCamClay(1.0, 0.2, 0.04, 1.0, overconsolidation_ratio=2.0),
    "undrained clay": ModifiedCamClay(
        1.0, 0.2, 0.04, 1.0, pre_overburden_pressure=20e3, pore_fluid_bulk_modulus=500e6
    ),
    "sand": CriticalStateSand(0.65, 1.25, 0.9, 0.025, 40e6),
    "undrained Mohr-Coulomb": MohrCoulomb(20e6, 0.3, 5e3, 0.5, pore_fluid_bulk_modulus=500e6),
}


@pytest.mark.parametrize("soil", GROUNDS.values(), ids=GROUNDS.keys())
def test_ground_is_in_equilibrium_however_its_points_lie(make_column, soil, rng):
    column = make_column(Ground(8e3, 0.7, soil))
    points = column.scattered_points(rng)
    result = column.step(points, column.mesh)
    assert result.is_converged
    assert result.equilibrium.newton.residuals[0] < 1e-9
    assert np.abs(result.equilibrium.displacement).max() < 1e-9
    stress = geostatic_stress(column.ground, points.position[:, 1], 1)
    np.testing.assert_allclose(
        result.points.kirchhoff_stress, stress, atol=1e-8 * np.abs(stress).max()
    )
