"""PC1, PC3 and PC7: helix, shaft and plate; published values, traction integral, power balance."""

import numpy as np
import pytest
from scipy.integrate import quad

from workflows.verification.references.screw_pile import (
    helix_resistance,
    plate_uplift_slip_cone,
    plate_uplift_upper_bound,
    shaft_resistance,
    shaft_slip_angle,
)

HELIX = {"helix_diameter": 0.4, "shaft_diameter": 0.1, "shear_strength": 50e3}


def test_helix():
    resistance = helix_resistance(**HELIX, pitch=0.1)
    assert resistance.torque == pytest.approx(1.6493e3, abs=5e-2)
    assert resistance.force == pytest.approx(1.500e3, rel=1e-12)
    assert helix_resistance(**HELIX, pitch=0.3).torque == pytest.approx(resistance.torque)


@pytest.mark.parametrize("pitch", [0.1, 0.5])
def test_power_of_the_helix_is_that_of_its_slip(pitch):
    def dissipated(r):  # one turn of the pile, both faces: stress, slip and area of a ring
        helix_length = np.hypot(2.0 * np.pi * r, pitch)
        return 2.0 * 50e3 * helix_length * helix_length

    resistance = helix_resistance(**HELIX, pitch=pitch)
    supplied = 2.0 * np.pi * resistance.torque + pitch * resistance.force
    assert supplied == pytest.approx(quad(dissipated, 0.05, 0.2)[0], rel=1e-10)


@pytest.mark.parametrize(("ratio", "sine"), [(1.0, 0.19853), (0.5, 0.10076)])
def test_shaft(ratio, sine):
    beta = shaft_slip_angle(radius=0.44, pitch=0.56, advancement_ratio=ratio)
    assert np.sin(beta) == pytest.approx(sine, abs=5.1e-6)
    if ratio == 1.0:
        assert np.rad2deg(beta) == pytest.approx(11.451, abs=5e-4)
    shaft = {"radius": 0.44, "length": 3.0, "pitch": 0.56, "shear_strength": 20e3}
    resistance = shaft_resistance(**shaft, advancement_ratio=ratio)
    combined = np.hypot(resistance.torque / 0.44, resistance.force)
    assert combined == pytest.approx(2.0 * np.pi * 0.44 * 3.0 * 20e3)
    assert resistance.force / combined == pytest.approx(sine, abs=5.1e-6)


@pytest.mark.parametrize(("depth", "factor"), [(2.0, 5.087), (4.0, 12.730)])
def test_uplift_upper_bound(depth, factor):
    bound = plate_uplift_upper_bound(depth=depth, diameter=1.0, friction_angle=np.deg2rad(30.0))
    assert bound == pytest.approx(factor, abs=5e-4)


@pytest.mark.parametrize(("depth", "factor"), [(1.0, 1.956), (3.0, 4.471), (5.0, 7.791)])
def test_uplift_slip_cone(depth, factor):
    sand = {"depth": depth, "diameter": 1.0, "friction_angle": np.deg2rad(40.0)}
    cone = plate_uplift_slip_cone(**sand, dilation_angle=np.deg2rad(10.0), k0=0.36)
    assert cone == pytest.approx(factor, abs=5e-4)
    associated = plate_uplift_slip_cone(**sand, dilation_angle=np.deg2rad(40.0), k0=0.36)
    assert associated == pytest.approx(plate_uplift_upper_bound(**sand))
