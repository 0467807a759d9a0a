"""PD1, PD5-PD8 and PD10: discs, point force, lateral piles, thick cylinder."""

import numpy as np
import pytest

from workflows.verification.references.discs import (
    circular_load_settlement,
    circular_load_stress,
    disc_stiffness,
)
from workflows.verification.references.elasticity import mindlin_displacement
from workflows.verification.references.pile_stiffness import head_stiffness, randolph_wroth
from workflows.verification.references.piles import broms_reaction, broms_short_pile, lateral_head
from workflows.verification.references.thick_cylinder import collapse_pressure, internal_pressure

LOAD = {"pressure": 100e3, "load_radius": 1.0, "youngs_modulus": 10e6, "poissons_ratio": 0.3}
POINT = {"force": 1e6, "force_depth": 5.0, "shear_modulus": 10e6, "poissons_ratio": 0.3}
PILE = {"radius": 0.5, "pile_modulus": 30e9, "shear_modulus": 10e6, "poissons_ratio": 0.3}


def test_disc():
    disc = disc_stiffness(radius=1.0, shear_modulus=1.0, poissons_ratio=0.3)
    computed = [disc.vertical, disc.horizontal, disc.rocking, disc.torsional, disc.vertical_bonded]
    np.testing.assert_allclose(computed, [5.714, 4.706, 3.810, 5.333, 5.878], rtol=0, atol=5e-4)


def test_bonded_disc_is_a_smooth_one_on_incompressible_soil():
    for nu in (0.5, 0.4999999):
        disc = disc_stiffness(radius=2.0, shear_modulus=3.0, poissons_ratio=nu)
        assert disc.vertical_bonded == pytest.approx(disc.vertical, rel=1e-6)


def test_circular_load():
    settlement = circular_load_settlement([0.0, 1.0], **LOAD)
    np.testing.assert_allclose(settlement, [18.20e-3, 11.586e-3], rtol=0, atol=5e-7)
    stress = circular_load_stress([0.5, 1.0, 2.0], pressure=100e3, load_radius=1.0)
    np.testing.assert_allclose(stress, [-91.06e3, -64.64e3, -28.45e3], rtol=0, atol=5.1)


def test_settlement_is_continuous_and_that_of_a_point_force_far_away():
    edge = circular_load_settlement([1.0 - 1e-9, 1.0 + 1e-9], **LOAD)
    assert edge[0] == pytest.approx(edge[1], rel=1e-6)
    far = circular_load_settlement(50.0, **LOAD)
    _, point = mindlin_displacement(
        50.0,
        0.0,
        force=np.pi * 1e5,
        force_depth=0.0,
        shear_modulus=10e6 / 2.6,
        poissons_ratio=0.3,
    )
    assert far == pytest.approx(float(point), rel=1e-3)


def test_point_force():
    _, vertical = mindlin_displacement([1.0, 3.0, 0.0], [5.0, 0.0, 2.0], **POINT)
    np.testing.assert_allclose(vertical, [6.4950e-3, 2.9141e-3, 4.5756e-3], rtol=0, atol=5.1e-8)


def point_force_displacement(x):
    radius = np.hypot(x[0], x[1])
    radial, vertical = mindlin_displacement(radius, x[2], **POINT)
    return np.array([radial * x[0] / radius, radial * x[1] / radius, vertical])


def test_point_force_is_in_equilibrium():
    # Navier: (1 - 2 nu) lap(u) + grad(div(u)) = 0, and no traction on the surface
    step, axes = 1e-3, np.eye(3)
    at = np.array([1.0, 0.7, 3.0])
    second = np.empty((3, 3, 3))  # component, two directions
    for i in range(3):
        for j in range(3):
            moved = [
                point_force_displacement(at + step * (a * axes[i] + b * axes[j]))
                for a in (1, -1)
                for b in (1, -1)
            ]
            second[:, i, j] = (moved[0] - moved[1] - moved[2] + moved[3]) / (4.0 * step**2)
    laplacian = np.einsum("kii->k", second)
    gradient_of_divergence = np.einsum("iik->k", second)
    residual = 0.4 * laplacian + gradient_of_divergence
    assert np.abs(residual).max() < 1e-4 * np.abs(second).max()
    surface = np.array([1.0, 0.7, 0.0])
    gradient = (
        np.array(
            [
                point_force_displacement(surface + 1e-6 * axis)
                - point_force_displacement(surface - 1e-6 * axis)
                for axis in axes
            ]
        )
        / 2e-6
    )  # derivative by axis, component
    strain = 0.5 * (gradient + gradient.T)
    stress = strain + 0.75 * np.trace(strain) * np.eye(3)  # over 2 G, nu / (1 - 2 nu) = 0.75
    assert np.abs(stress[2]).max() < 1e-6 * np.abs(stress).max()


def test_lateral_pile():
    head = lateral_head(force=100e3, **PILE)
    assert head.displacement == pytest.approx(1.446e-3, abs=5e-7)
    assert head.rotation == pytest.approx(3.456e-4, abs=5e-8)
    assert head.displacement_fixed == pytest.approx(0.857e-3, abs=5e-7)
    assert head.critical_length == pytest.approx(9.30, abs=5e-3)
    # reciprocity: displacement of a moment equals rotation of a force
    by_moment = lateral_head(force=0.0, moment=100e3, **PILE)
    assert by_moment.displacement == pytest.approx(head.rotation)


@pytest.mark.parametrize(("height", "capacity"), [(0.0, 1260e3), (5.0, 729e3)])
def test_short_pile(height, capacity):
    clay = {"undrained_shear_strength": 50e3, "diameter": 1.0, "length": 10.0}
    force = broms_short_pile(**clay, load_height=height)
    assert force == pytest.approx(capacity, abs=500.0)
    f = force / (9.0 * 50e3)
    moment = force * (height + 1.5 + 0.5 * f)
    assert moment == pytest.approx(2.25 * 50e3 * (10.0 - 1.5 - f) ** 2)


@pytest.mark.parametrize("height", [0.0, 3.0])
def test_reaction_on_a_short_pile_balances_the_load(height):
    clay = {"undrained_shear_strength": 40e3, "diameter": 0.8, "length": 9.0}
    depth = (np.arange(90_000) + 0.5) * 1e-4
    reaction = broms_reaction(depth, **clay, load_height=height) * 1e-4
    force = broms_short_pile(**clay, load_height=height)
    assert reaction.sum() == pytest.approx(force, rel=1e-3)
    assert abs(reaction @ (depth + height)) < 1e-3 * force * (clay["length"] + height)
    assert (reaction[depth < 1.2] == 0.0).all()


def test_pile_within_the_dead_zone_is_refused():
    with pytest.raises(ValueError, match=r"more than 1\.5 times"):
        broms_short_pile(undrained_shear_strength=50e3, diameter=1.0, length=1.2)


def test_thick_cylinder():
    data = {"inner_radius": 1.0, "outer_radius": 5.0, "undrained_shear_strength": 30.0}
    pressure = internal_pressure([1.0, 2.0, 3.0, 5.0], **data)
    np.testing.assert_allclose(pressure, [28.80, 66.79, 85.12, 96.566], rtol=0, atol=5e-3)
    assert collapse_pressure(**data) == pytest.approx(96.566, abs=5e-4)
    assert pressure[-1] == pytest.approx(collapse_pressure(**data))


AXIAL = {
    "length": 20.0, "radius": 0.5, "pile_modulus": 30e9, "shear_modulus": 10e6,
    "poissons_ratio": 0.3,
}  # fmt: skip


def test_head_stiffness_of_a_pile():
    """298.5 MN/m in the stated box; a finer grid changes it by less than 0.05 %."""
    coarse, fine = (
        head_stiffness(**AXIAL, extent=100.5, depth=120.0, first=first) for first in (0.25, 0.125)
    )
    assert fine == pytest.approx(298.5e6, rel=5e-4)
    assert coarse == pytest.approx(fine, rel=5e-4)
    assert randolph_wroth(**AXIAL) == pytest.approx(295.2e6, rel=5e-4)
