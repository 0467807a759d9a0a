"""Ground, pile, its surface on the mesh, seeding, and the conventions behind them."""

import numpy as np
import pytest

from install_mpm.cells import CellType, reference_cell
from install_mpm.constitutive import dispatch
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic, VonMises
from install_mpm.conventions import GRAVITY, Kinematics, dimension, vertical_axis
from install_mpm.geostatic import elastic_strain_of, geostatic_gradient
from install_mpm.ground import Ground, geostatic_stress, undrained_shear_strength
from install_mpm.interface import global_traction, reaction
from install_mpm.mesh_generation import generate_background_mesh
from install_mpm.mesh_motion import translate
from install_mpm.pile import (
    WHOLE_PILE,
    Pile,
    PilePart,
    buried_weight,
    surface_normals,
    tangent_of,
)
from install_mpm.pile_surface import (
    follow,
    geostatic_traction,
    initial_interface,
    pile_elements,
    place_points,
)
from install_mpm.seeding import seed_points

LAW = CoulombInterface(2e8, 2e7, cohesion=1e3, adhesion_factor=0.5)


@pytest.fixture(scope="module")
def mesh(pile, box, mesh_options):
    return generate_background_mesh(pile, box, mesh_options)


@pytest.fixture(scope="module")
def stiffening_ground():
    """Strength grows with depth."""
    return Ground(18e3, 0.6, VonMises(4e6, 0.49, 20e3, 2e3))


def test_vertical_axis_and_dimension():
    assert [vertical_axis(k) for k in Kinematics] == [1, 1, 2]
    assert [dimension(k) for k in Kinematics] == [2, 2, 3]


def test_geostatic_stress_is_pressure_of_the_soil_above():
    """Compression is negative; above the surface there is none; the vertical axis is named."""
    ground = Ground(18e3, 0.5, HenckyElastic(1e6, 0.3))
    stress = geostatic_stress(ground, np.array([-2.0, 0.0, 1.0]), 1)
    np.testing.assert_allclose(stress[0], np.diag([-18e3, -36e3, -18e3]))
    assert not stress[1:].any()
    np.testing.assert_allclose(
        geostatic_stress(ground, np.array([-2.0]), 2)[0], np.diag([-18e3, -18e3, -36e3])
    )


def test_strength_grows_with_depth_and_elastic_soil_has_none(stiffening_ground, elastic_ground):
    height = np.array([1.0, 0.0, -3.0])
    np.testing.assert_allclose(
        undrained_shear_strength(stiffening_ground, height), [20e3, 20e3, 26e3]
    )
    assert not undrained_shear_strength(elastic_ground, height).any()


def test_geostatic_gradient_is_the_slope_of_stress_and_strain(stiffening_ground):
    """Stress grows upward, because it is negative; strains belong to stresses."""
    gradient = geostatic_gradient(stiffening_ground, 1)
    heights = np.array([-1.0, -3.5])
    stress = geostatic_stress(stiffening_ground, heights, 1)
    np.testing.assert_allclose(gradient.stress[0], (stress[0] - stress[1]) / 2.5, rtol=1e-13)
    state = dispatch.initial_state(stiffening_ground.soil, -heights, stress)
    strain = elastic_strain_of(stiffening_ground.soil, stress, state)
    np.testing.assert_allclose(gradient.strain[0], (strain[0] - strain[1]) / 2.5, atol=1e-16)
    assert gradient.stress[0, 1, 1] == pytest.approx(18e3)


def test_elastic_strain_obeys_hooke(rng, elastic_ground):
    """Young's modulus and Poisson's ratio, with a full stress tensor."""
    stress = rng.normal(size=(5, 3, 3))
    stress = stress + stress.transpose(0, 2, 1)
    modulus, ratio = 5e6, 0.3
    trace = np.trace(stress, axis1=1, axis2=2)[:, None, None]
    expected = ((1.0 + ratio) * stress - ratio * trace * np.eye(3)) / modulus
    strain = elastic_strain_of(elastic_ground.soil, stress, np.zeros((5, 0)))
    np.testing.assert_allclose(strain, expected, atol=1e-20, rtol=1e-10)


@pytest.mark.gmsh
@pytest.mark.parametrize("per_direction", [1, 2, 3])
def test_seeded_ground_weighs_what_it_should(mesh, pile, box, stiffening_ground, per_direction):
    points = seed_points(mesh, reference_cell(CellType.TRI6), stiffening_ground, per_direction)
    volume = box.width * box.depth - pile.half_width * pile.embedment
    assert points.volume.sum() == pytest.approx(volume, rel=1e-12)
    assert points.mass.sum() == pytest.approx(18e3 / GRAVITY * volume, rel=1e-12)
    assert (points.position[:, 1] < 0.0).all()
    assert len(np.unique(points.cell)) * 3 * per_direction**2 == len(points.mass)
    depth = -points.position[:, 1]
    moment = box.width * box.depth**2 / 2.0 - pile.half_width * pile.embedment**2 / 2.0
    if per_direction > 1:
        assert points.volume @ depth == pytest.approx(moment, rel=1e-12)
    np.testing.assert_allclose(points.state_variables[:, 0], 20e3 + 2e3 * depth)
    assert not points.state_variables[:, 1].any()


@pytest.mark.gmsh
def test_seeded_points_are_where_they_say_and_in_their_geostatic_state(mesh, stiffening_ground):
    points = seed_points(mesh, reference_cell(CellType.TRI6), stiffening_ground, 2)
    xi = points.reference_coordinates
    shares = np.column_stack([1.0 - xi.sum(axis=1), xi])
    corners = mesh.nodes[mesh.cell_nodes[points.cell, :3]]
    np.testing.assert_allclose(
        np.einsum("pv,pvi->pi", shares, corners), points.position, atol=1e-14
    )
    stress = geostatic_stress(stiffening_ground, points.position[:, 1], 1)
    np.testing.assert_array_equal(points.kirchhoff_stress, stress)
    expected = elastic_strain_of(stiffening_ground.soil, stress, points.state_variables)
    np.testing.assert_array_equal(points.elastic_log_strain, expected)
    assert (points.volume_ratio == 1.0).all()
    assert not points.displacement.any()


def test_normals_point_from_soil_to_pile_and_tangents_are_turned_left():
    part = np.array([PilePart.BASE, PilePart.SHAFT])
    normals = surface_normals(part)
    np.testing.assert_array_equal(normals, [[0.0, 1.0], [-1.0, 0.0]])
    np.testing.assert_array_equal(tangent_of(normals), [[-1.0, 0.0], [0.0, -1.0]])


def test_weight_of_the_modelled_half():
    pile = Pile(half_width=0.5, embedment=2.0, unit_weight=20e3)
    assert buried_weight(pile, 3.0) == pytest.approx(30e3)
    assert WHOLE_PILE[Kinematics.PLANE_STRAIN] == 2.0


def test_weight_of_a_round_pile():
    pile = Pile(half_width=0.5, embedment=2.0, unit_weight=20e3)
    weight = buried_weight(pile, 3.0, Kinematics.AXISYMMETRIC)
    assert weight == pytest.approx(20e3 * np.pi * 0.25 * 3.0)
    assert WHOLE_PILE[Kinematics.AXISYMMETRIC] == 1.0


@pytest.mark.gmsh
def test_pile_surface_is_found_completely(mesh, pile, box):
    """Base first, then the shaft up to the top of the mesh; facets belong to the cells beside."""
    elements, parts = pile_elements(mesh, pile)
    assert (np.diff(parts) >= 0).all()
    assert set(parts) == {PilePart.BASE, PilePart.SHAFT}
    ends, middle = mesh.nodes[elements.nodes[:, :2]], mesh.nodes[elements.nodes[:, 2]]
    np.testing.assert_allclose(middle, ends.mean(axis=1), atol=1e-14)
    for nodes, cell in zip(elements.nodes, elements.cell, strict=True):
        assert set(nodes) <= set(mesh.cell_nodes[cell])
    on_base = parts == PilePart.BASE
    assert np.abs(ends[on_base, :, 1] + pile.embedment).max() < 1e-9
    assert np.abs(ends[~on_base, :, 0] - pile.half_width).max() < 1e-9
    centre = mesh.nodes[mesh.cell_nodes[elements.cell, :3]].mean(axis=1)
    towards_pile = np.einsum("ei,ei->e", middle - centre, surface_normals(parts))
    assert (towards_pile > 0.0).all()


@pytest.mark.gmsh
def test_areas_add_up_to_the_perimeter(mesh, pile, box):
    elements, parts = pile_elements(mesh, pile)
    position, area = place_points(elements, mesh)
    part = np.repeat(parts, 3)
    assert area[part == PilePart.BASE].sum() == pytest.approx(pile.half_width, rel=1e-12)
    shaft = pile.embedment + box.headroom
    assert area[part == PilePart.SHAFT].sum() == pytest.approx(shaft, rel=1e-12)
    buried = (part == PilePart.SHAFT) & (position[:, 1] < 0.0)
    assert area[buried].sum() == pytest.approx(pile.embedment, rel=1e-12)
    centroid = area[buried] @ position[buried, 1] / area[buried].sum()
    assert centroid == pytest.approx(-pile.embedment / 2.0, rel=1e-12)


@pytest.mark.gmsh
def test_areas_of_a_round_pile_go_around_it(mesh, pile, box):
    elements, parts = pile_elements(mesh, pile)
    _, area = place_points(elements, mesh, Kinematics.AXISYMMETRIC)
    part = np.repeat(parts, 3)
    base, circumference = np.pi * pile.half_width**2, 2.0 * np.pi * pile.half_width
    assert area[part == PilePart.BASE].sum() == pytest.approx(base, rel=1e-12)
    shaft = circumference * (pile.embedment + box.headroom)
    assert area[part == PilePart.SHAFT].sum() == pytest.approx(shaft, rel=1e-12)


@pytest.mark.gmsh
def test_geostatic_traction_is_that_of_the_ground(mesh, pile, stiffening_ground):
    """Its resultant on base and shaft is that of the trapezes of pressure; no shear anywhere."""
    elements, parts = pile_elements(mesh, pile)
    points = initial_interface(elements, parts, mesh, stiffening_ground, LAW)
    np.testing.assert_array_equal(points.covered, points.position[:, 1] < 0.0)
    assert np.abs(points.traction[:, 0]).max() < 1e-9
    assert (points.traction[points.covered > 0.0, 1] < 0.0).all()
    force = reaction(points)
    depth = pile.embedment
    assert force[1] == pytest.approx(18e3 * depth * pile.half_width, rel=1e-12)
    assert force[0] == pytest.approx(-0.6 * 18e3 * depth**2 / 2.0, rel=1e-12)
    stress = geostatic_stress(stiffening_ground, points.position[:, 1], 1)[:, :2, :2]
    expected = np.einsum("pij,pj->pi", stress, points.normal)
    np.testing.assert_allclose(global_traction(points), expected, atol=1e-9)


def test_geostatic_traction_on_an_inclined_surface(elastic_ground):
    """sigma n in local axes, tangent first."""
    angle = np.radians(30.0)
    normal = np.array([[np.cos(angle), np.sin(angle)]])
    traction = geostatic_traction(elastic_ground, np.array([[0.0, -2.0]]), normal)
    horizontal, vertical = -0.6 * 36e3, -36e3
    on_plane = horizontal * np.cos(angle) ** 2 + vertical * np.sin(angle) ** 2
    along = (vertical - horizontal) * np.sin(angle) * np.cos(angle)
    np.testing.assert_allclose(traction, [[along, on_plane]], rtol=1e-12)


@pytest.mark.gmsh
def test_interface_follows_the_mesh_and_takes_the_adhesion_of_its_level(
    mesh, pile, box, stiffening_ground
):
    elements, parts = pile_elements(mesh, pile)
    start = initial_interface(elements, parts, mesh, stiffening_ground, LAW)
    moved = translate(mesh, 0.4, -pile.embedment, (-box.depth, box.headroom))
    points = follow(start, elements, moved, stiffening_ground, LAW)
    on_base = points.part == PilePart.BASE
    np.testing.assert_allclose(points.position[on_base, 1], -pile.embedment - 0.4, atol=1e-12)
    assert points.area[~on_base].sum() == pytest.approx(pile.embedment + box.headroom + 0.4)
    depth = np.maximum(-points.position[:, 1], 0.0)
    np.testing.assert_allclose(points.parameters[:, 2], 1e3 + 0.5 * (20e3 + 2e3 * depth))
    for name in ("normal", "traction", "part", "covered"):
        np.testing.assert_array_equal(getattr(points, name), getattr(start, name))
