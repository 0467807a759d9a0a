"""The synthetic field balances gravity, and its error falls with the number of points."""

import numpy as np
import pytest

from handoff.options import HandoffOptions
from handoff.state_transfer import map_errors, state_map
from handoff.synthetic import airy_stress, distance_to_pile
from install_mpm.conventions import Kinematics


def test_airy_field_is_free_of_divergence(site):
    positions = np.random.default_rng(0).uniform((0.0, -4.0), (2.0, -1.0), size=(50, 2))
    step = 1e-4

    def derivative(axis):
        offset = step * np.eye(2)[axis]
        ahead, behind = (
            airy_stress(site.ground, site.pile, 2.0, positions + s * offset) for s in (1, -1)
        )
        return (ahead - behind) / (2.0 * step)

    along_x, along_z = derivative(0), derivative(1)
    divergence = along_x[:, 0, :2] + along_z[:, 1, :2]
    assert np.abs(divergence).max() < 1e-6 * np.abs(along_x).max()


def test_airy_field_is_symmetric_about_the_axis_and_several_times_the_strength(site):
    axis = np.column_stack([np.zeros(20), np.linspace(-4.0, -2.0, 20)])
    stress = airy_stress(site.ground, site.pile, 2.0, axis)
    assert np.abs(stress[:, 0, 1]).max() < 1e-9
    assert np.abs(stress).max() > 2.0 * 20e3


@pytest.mark.gmsh
@pytest.mark.parametrize(("transfer", "limit"), [("least_squares", 0.01), ("nearest", 0.1)])
def test_error_falls_with_the_density_of_points(site, build, transfer, limit):
    """With second order by least squares, with first order by the nearest point."""
    mesh = site.mesh(0.1)
    targets, volumes = build.integration_points(mesh)
    options = HandoffOptions(0.1, 1.0, neighbours=32, transfer=transfer)
    errors = []
    for size in (0.2, 0.1, 0.05):
        points = build.points(site.mesh(size), site.ground)
        chart = state_map(points, site.placed, targets, options)
        fields = (site.placed.synthetic_stress(site.ground, x) for x in (points.position, targets))
        is_near = site.placed.distance(targets) <= site.placed.near
        errors.append(map_errors(*fields, chart, volumes, is_near))
    everywhere, near = np.transpose(errors)
    assert (np.diff(everywhere) < 0.0).all()
    assert (np.diff(near) < 0.0).all()
    assert everywhere[0] > (3.0 if transfer == "least_squares" else 1.7) * everywhere[-1]
    assert everywhere[-1] < limit


def test_distance_to_the_pile_is_zero_on_it_and_diagonal_at_the_corner(site):
    places = np.array([[0.5, -1.0], [0.2, -2.0], [0.8, -2.4], [1.5, -1.0]])
    assert distance_to_pile(site.pile, 2.0, places) == pytest.approx([0.0, 0.0, 0.5, 1.0])


def test_axisymmetric_field_balances_and_is_regular_on_the_axis(site):
    """d s_rr/dr + d s_rz/dz + (s_rr - s_hoop)/r = 0, d s_rz/dr + d s_zz/dz + s_rz/r = 0."""
    positions = np.random.default_rng(0).uniform((0.1, -4.0), (2.0, -1.0), size=(50, 2))
    step = 1e-4

    def field(places):
        return airy_stress(site.ground, site.pile, 2.0, places, Kinematics.AXISYMMETRIC)

    along_r, along_z = (
        (field(positions + offset) - field(positions - offset)) / (2.0 * step)
        for offset in step * np.eye(2)
    )
    stress, radius = field(positions), positions[:, 0]
    radial = along_r[:, 0, 0] + along_z[:, 0, 1] + (stress[:, 0, 0] - stress[:, 2, 2]) / radius
    axial = along_r[:, 0, 1] + along_z[:, 1, 1] + stress[:, 0, 1] / radius
    scale = np.abs(along_r).max()
    assert np.abs(radial).max() < 1e-6 * scale
    assert np.abs(axial).max() < 1e-6 * scale
    near, nearer = field(np.array([[1e-3, -2.5], [1e-4, -2.5]]))
    np.testing.assert_allclose(near, nearer, atol=1e-4 * 20e3)
