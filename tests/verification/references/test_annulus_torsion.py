"""PA7, PA8 and PA9: torsion of the annulus; published torques, limits, loss of the solution."""

import numpy as np
import pytest

from workflows.verification.references.annulus_energy import (
    energy_derivatives,
    hencky,
    neo_hookean,
)
from workflows.verification.references.annulus_incompressible import (
    incompressible_hencky_torsion,
    largest_incompressible_rotation,
)
from workflows.verification.references.annulus_torsion import (
    annulus_torsion,
    largest_rotation,
    small_strain_torque,
)

RADII = {"inner_radius": 1.0, "outer_radius": 4.0}
ANNULUS = RADII | {"youngs_modulus": 10.0}


@pytest.mark.parametrize(("nu", "stiffness"), [(0.0, 67.0206), (0.3, 51.5543)])
def test_published_small_strain_stiffness(nu, stiffness):
    assert small_strain_torque(1.0, **ANNULUS, poissons_ratio=nu) == pytest.approx(
        stiffness, abs=5e-5
    )
    for energy in (hencky, neo_hookean):
        finite = annulus_torsion(1e-3, energy=energy, **ANNULUS, poissons_ratio=nu)
        assert finite.torque == pytest.approx(1e-3 * stiffness, rel=3e-6)


@pytest.mark.parametrize(
    ("nu", "degrees", "torque"),
    [
        (0.0, 5.0, 5.8329),
        (0.0, 10.0, 11.5707),
        (0.0, 15.0, 17.1145),
        (0.0, 20.0, 22.3552),
        (0.0, 25.0, 27.155),
        (0.3, 5.0, 4.4881),
        (0.3, 10.0, 8.9106),
        (0.3, 15.0, 13.2006),
        (0.3, 20.0, 17.2871),
        (0.3, 25.0, 21.089),
    ],
)
def test_published_hencky_torque(nu, degrees, torque):
    result = annulus_torsion(np.deg2rad(degrees), energy=hencky, **ANNULUS, poissons_ratio=nu)
    assert result.torque == pytest.approx(torque, abs=5e-5 if degrees < 25.0 else 5e-4)


@pytest.mark.parametrize(
    ("nu", "degrees", "torque"),
    [(0.0, 45.0, 50.1583), (0.0, 90.0, 89.9288), (0.3, 45.0, 39.3980), (0.3, 90.0, 73.9318)],
)
def test_published_neo_hookean_torque(nu, degrees, torque):
    # The table is of linear elements that agree to 1e-5; an energy minimum errs upwards.
    result = annulus_torsion(np.deg2rad(degrees), energy=neo_hookean, **ANNULUS, poissons_ratio=nu)
    assert result.torque == pytest.approx(torque, rel=1e-5)
    if (nu, degrees) == (0.0, 90.0):
        assert result.radial_displacement.min() == pytest.approx(-0.1777, abs=5e-5)


@pytest.mark.parametrize(("energy", "degrees"), [(hencky, 25.0), (neo_hookean, 90.0)])
def test_converged_in_the_number_of_functions(energy, degrees):
    data = ANNULUS | {"energy": energy, "poissons_ratio": 0.3}
    torques = [annulus_torsion(np.deg2rad(degrees), **data, degree=n).torque for n in (16, 24, 40)]
    assert torques[1] == pytest.approx(torques[2], rel=1e-8)
    assert abs(torques[1] - torques[2]) < abs(torques[0] - torques[2])


def test_nearly_incompressible_material_approaches_the_closed_forms():
    data = RADII | {"youngs_modulus": 30.0, "poissons_ratio": 0.4999}
    neo = annulus_torsion(np.pi / 2.0, energy=neo_hookean, **data)
    assert neo.torque == pytest.approx(small_strain_torque(np.pi / 2.0, **data), rel=1e-3)
    rotation, torque = incompressible_hencky_torsion(1.5, **RADII, shear_modulus=30.0 / 2.9998)
    near = annulus_torsion(rotation, energy=hencky, **data)
    assert near.torque == pytest.approx(torque, rel=1e-3)
    assert np.abs(near.radial_displacement).max() < 1e-3


def test_hencky_solution_is_lost_at_a_finite_angle():
    # The published 29.5 and 33.5 degrees are the last converged of steps of half a degree.
    lost = [
        np.rad2deg(largest_rotation(energy=hencky, **ANNULUS, poissons_ratio=nu))
        for nu in (0.0, 0.3, 0.4999)
    ]
    assert 29.5 <= lost[0] < 30.0
    assert 33.5 <= lost[1] < 34.0
    incompressible = np.rad2deg(largest_incompressible_rotation(**RADII))
    assert incompressible == pytest.approx(42.1, abs=5e-2)
    assert lost[2] == pytest.approx(incompressible, abs=0.03)
    with pytest.raises(ArithmeticError, match=r"no stable solution beyond 29\.7"):
        annulus_torsion(np.deg2rad(40.0), energy=hencky, **ANNULUS, poissons_ratio=0.0)


def test_turned_back_it_is_the_mirror_image():
    data = ANNULUS | {"energy": neo_hookean, "poissons_ratio": 0.3}
    there, back = annulus_torsion(0.5, **data), annulus_torsion(-0.5, **data)
    assert back.torque == -there.torque
    np.testing.assert_array_equal(back.twist, -there.twist)
    np.testing.assert_array_equal(back.radial_displacement, there.radial_displacement)


@pytest.mark.parametrize(("outer_radius", "degrees"), [(1.1, 5.0), (60.0, 20.0)])
def test_thin_and_thick_annulus_are_converged(outer_radius, degrees):
    data = ANNULUS | {"outer_radius": outer_radius, "energy": hencky, "poissons_ratio": 0.2}
    torques = [annulus_torsion(np.deg2rad(degrees), **data, degree=n).torque for n in (24, 40)]
    assert torques[0] == pytest.approx(torques[1], rel=1e-6)


@pytest.mark.parametrize("energy", [hencky, neo_hookean])
def test_derivatives_of_the_energies(energy):
    # Both laws are tested with their Hessians against differences, near and far from no shear.
    for q in (np.array([0.8, 1.7, 0.9]), np.array([1.001, 1.5 * 1.001, 1e-4])):
        radius, moduli, step = np.array([1.5]), (4.0, 3.0), 1e-6
        _, hessian = energy_derivatives(q[:, None], radius, energy, moduli)
        for k in range(3):
            shift = step * np.eye(3)[k]
            forward, _ = energy_derivatives((q + shift)[:, None], radius, energy, moduli)
            backward, _ = energy_derivatives((q - shift)[:, None], radius, energy, moduli)
            difference = (forward - backward)[:, 0] / (2.0 * step)
            np.testing.assert_allclose(hessian[:, k, 0], difference, rtol=1e-6, atol=1e-6)
