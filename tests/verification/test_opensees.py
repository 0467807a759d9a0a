"""Drucker-Prager beside OpenSees, a drained triaxial test step by step: extra `opensees`.

Claimed: q and the volumetric strain of every step are those of OpenSees' law to its tolerance; with
the cone that matches Mohr-Coulomb in compression q ends at (N - 1) p0 + 2 c sqrt(N).
"""

import numpy as np
import pytest

from install_mpm.constitutive.element_driver import Loading, drive, element
from install_mpm.constitutive.parameters import DruckerPrager

ops = pytest.importorskip("openseespy.opensees", reason="the extra 'opensees' is not installed")

CELL_PRESSURE = 100e3
SHORTENING, STEPS = 0.03, 30
CORNERS = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
SOILS = {
    "no dilation": DruckerPrager(20e6, 0.3, 0.0, np.radians(30.0), 0.0),
    "dilation and cohesion": DruckerPrager(20e6, 0.3, 5e3, np.radians(30.0), np.radians(10.0)),
    "associated": DruckerPrager(20e6, 0.2, 1e3, np.radians(35.0), np.radians(35.0)),
}


def moduli(soil):
    return (
        soil.youngs_modulus / (3.0 * (1.0 - 2.0 * soil.poissons_ratio)),
        soil.youngs_modulus / (2.0 * (1.0 + soil.poissons_ratio)),
    )


def make_brick(soil):
    """One brick of OpenSees' law, |s| + rho I_1 <= sqrt(2/3) sigma_Y, between three rollers."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 3)
    for tag, corner in enumerate(CORNERS, 1):
        ops.node(tag, *map(float, corner))
        ops.fix(tag, *(int(component == 0) for component in corner))
    rho, rho_bar = (
        2.0 * np.sqrt(2.0) * np.sin(angle) / (np.sqrt(3.0) * (3.0 - np.sin(angle)))
        for angle in (soil.friction_angle, soil.dilation_angle)
    )
    sine, cosine = np.sin(soil.friction_angle), np.cos(soil.friction_angle)
    strength = 6.0 * soil.cohesion * cosine / (3.0 - sine)
    hardening = [0.0] * 7
    ops.nDMaterial("DruckerPrager", 1, *moduli(soil), strength, rho, rho_bar, *hardening)
    ops.element("stdBrick", 1, *range(1, 9), 1)


def load_brick(soil):
    """Cell pressure until time 1, then shortening: SHORTENING at time 2."""
    pressed = -CELL_PRESSURE / (3.0 * moduli(soil)[0])
    times = ("-time", 0.0, 1.0, 3.0, "-values")
    ops.timeSeries("Path", 1, *times, 0.0, 1.0, 1.0)
    ops.timeSeries("Path", 2, *times, 0.0, pressed, pressed - 2.0 * SHORTENING)
    ops.pattern("Plain", 1, 1)
    for tag, (x, y, _) in enumerate(CORNERS, 1):
        ops.load(tag, -0.25 * CELL_PRESSURE * x, -0.25 * CELL_PRESSURE * y, 0.0)
    ops.pattern("Plain", 2, 2)
    for tag, (_, _, z) in enumerate(CORNERS, 1):
        if z:
            ops.sp(tag, 3, 1.0)


def opensees_triaxial(soil):
    """q in Pa and volumetric strain (STEPS,), the end of the cell pressure being the start."""
    make_brick(soil)
    load_brick(soil)
    ops.constraints("Transformation")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.test("NormDispIncr", 1e-12, 50)
    ops.algorithm("Newton")
    rows = []
    for time_step, count in ((1.0, 1), (1.0 / STEPS, STEPS)):
        ops.integrator("LoadControl", time_step)
        ops.analysis("Static")
        for _ in range(count):
            assert ops.analyze(1) == 0
            stress = np.array(ops.eleResponse(1, "stresses")).reshape(8, 6)
            assert np.ptp(stress, axis=0).max() < 1e-6 * CELL_PRESSURE
            volume = sum(ops.nodeDisp(7, axis) for axis in (1, 2, 3))
            rows.append((stress[0, 0] - stress[0, 2], volume))
    q, volume = np.array(rows).T
    return q[1:], volume[1:] - volume[0]


@pytest.mark.parametrize("name", SOILS)
def test_drained_triaxial_test(name):
    soil = SOILS[name]
    start = -CELL_PRESSURE * np.eye(3)
    lateral = np.diag([True, False, True])
    loading = Loading(lateral, np.diag([0.0, -SHORTENING, 0.0]), start, STEPS)
    path = drive(soil, element(soil, start), [loading])[1:]
    q = np.array([state.stress[0, 0] - state.stress[1, 1] for state in path])
    volume = np.array([np.trace(state.gradient) - 3.0 for state in path])
    expected_q, expected_volume = opensees_triaxial(soil)
    np.testing.assert_allclose(q, expected_q, rtol=0.0, atol=1e-8 * expected_q[-1])
    np.testing.assert_allclose(volume, expected_volume, rtol=0.0, atol=1e-8 * SHORTENING)
    n = (1.0 + np.sin(soil.friction_angle)) / (1.0 - np.sin(soil.friction_angle))
    strength = (n - 1.0) * CELL_PRESSURE + 2.0 * soil.cohesion * np.sqrt(n)
    assert expected_q[-1] == pytest.approx(strength, rel=1e-8)
    worst = np.abs(q - expected_q).max() / expected_q[-1]
    worst_volume = np.abs(volume - expected_volume).max() / SHORTENING
    print(f"{name}: q {q[-1] / 1e3:.3f} kPa, OpenSees {expected_q[-1] / 1e3:.3f} kPa,")
    print(f"worst step {worst:.1e} of q, {worst_volume:.1e} of the shortening in volume")
