"""What a step does to the material points, against plain arithmetic; which pile facets count."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from install_mpm.carriers import give_state, take_state
from install_mpm.cell_fill import cell_geometry, fill_cells
from install_mpm.cells import CellType, reference_cell
from install_mpm.constitutive import dispatch
from install_mpm.constitutive.frictional import OPENING
from install_mpm.constitutive.parameters import CoulombInterface, CriticalStateSand, MohrCoulomb
from install_mpm.conventions import Kinematics
from install_mpm.ground import Ground
from install_mpm.location import locate
from install_mpm.material_points import MaterialPoints
from install_mpm.mesh_generation import generate_background_mesh
from install_mpm.pile_surface import initial_interface, pile_elements
from install_mpm.point_volumes import share_openings
from install_mpm.seeding import seed_points
from install_mpm.soft_terms import cell_options, opening_share, volumetric_strain_under
from install_mpm.step import LEVEL_FILL, switch_on

DENSE_SAND = MohrCoulomb(
    youngs_modulus=30e6, poissons_ratio=0.25, cohesion=1e3, friction_angle=0.6,
    dilation_angle=0.2, initial_void_ratio=0.55, critical_void_ratio=0.75,
)  # fmt: skip


def with_log_of(tensor):
    values, vectors = np.linalg.eigh(tensor)
    return vectors @ np.diag(np.log(values)) @ vectors.T


def with_exp_of(tensor):
    values, vectors = np.linalg.eigh(tensor)
    return vectors @ np.diag(np.exp(values)) @ vectors.T


def reference_trial_strains(points, mesh, displacement, ratio, slope):
    """Trial strains: own dF with the cell's volume change, then one pressure per cell."""
    strains, volume = np.empty_like(points.elastic_log_strain), points.volume * ratio[points.cell]
    position = np.empty_like(points.position)
    for p, c in enumerate(points.cell):
        nodes = mesh.cell_nodes[c]
        corners = mesh.nodes[nodes[:3]]
        affine = np.column_stack([corners[1] - corners[0], corners[2] - corners[0]])
        x, y = points.reference_coordinates[p]
        z = 1.0 - x - y
        values = [
            z * (2 * z - 1),
            x * (2 * x - 1),
            y * (2 * y - 1),
            4 * z * x,
            4 * x * y,
            4 * y * z,
        ]
        by_x = [1 - 4 * z, 4 * x - 1, 0.0, 4 * (z - x), 4 * y, -4 * y]
        by_y = [1 - 4 * z, 0.0, 4 * y - 1, -4 * x, 4 * x, 4 * (z - y)]
        gradients = np.column_stack([by_x, by_y]) @ np.linalg.inv(affine)
        increment = np.eye(3)
        increment[:2, :2] += displacement[nodes].T @ gradients
        increment[:2] *= np.sqrt(ratio[c] / np.linalg.det(increment))
        pushed = increment @ with_exp_of(2.0 * points.elastic_log_strain[p]) @ increment.T
        strains[p] = with_log_of(pushed) / 2.0
        position[p] = points.position[p] + np.array(values) @ displacement[nodes]
    for c in np.unique(points.cell):
        own = points.cell == c
        weight = volume[own] / volume[own].sum()
        trace = np.trace(strains[own], axis1=1, axis2=2)
        rise = position[own, 1] - weight @ position[own, 1]
        correction = weight @ trace + slope * rise - trace
        strains[own] += correction[:, None, None] * np.eye(3) / 3.0
    return strains, position, volume


def test_points_take_the_displacement_of_their_cell(make_column, elastic_ground, rng):
    """Against plain arithmetic, for an arbitrary displacement of all nodes."""
    column = make_column(elastic_ground)
    mesh = column.mesh
    points = column.scattered_points(rng)
    n_cells = len(mesh.cell_nodes)
    displacement = 0.01 * rng.normal(size=mesh.nodes.shape)
    ratio = rng.uniform(0.95, 1.05, n_cells)
    geometry = cell_geometry(mesh, column.cell, Kinematics.PLANE_STRAIN)
    fill = fill_cells(points, mesh, column.cell, geometry, 0.3)
    equilibrium = SimpleNamespace(
        displacement=displacement, trial=SimpleNamespace(cell_volume_ratio=ratio)
    )
    updated, is_sound = take_state(points, mesh, fill, equilibrium, column.model, column.gradient)
    assert is_sound
    slope = np.trace(column.gradient.strain[0])
    strain, position, volume = reference_trial_strains(points, mesh, displacement, ratio, slope)
    np.testing.assert_allclose(updated.elastic_log_strain, strain, atol=1e-14)
    np.testing.assert_allclose(updated.position, position, atol=1e-15)
    np.testing.assert_allclose(updated.displacement, position - points.position, atol=1e-15)
    np.testing.assert_allclose(updated.volume, volume, rtol=1e-14)
    np.testing.assert_allclose(updated.volume_ratio, ratio[points.cell], rtol=1e-14)
    np.testing.assert_array_equal(updated.mass, points.mass)
    bulk = 5e6 / (3.0 * 0.4)
    pressure = bulk * np.trace(strain, axis1=1, axis2=2)
    mean_stress = np.trace(updated.kirchhoff_stress, axis1=1, axis2=2) / 3.0
    np.testing.assert_allclose(mean_stress, pressure, atol=1e-7)


def test_void_ratio_follows_the_volume_of_the_point(make_column, rng):
    """Dilatant sand whose points yield by different amounts and share one pressure in a cell."""
    column = make_column(Ground(unit_weight=18e3, k0=0.5, soil=DENSE_SAND))
    mesh, points = column.mesh, column.scattered_points(rng)
    geometry = cell_geometry(mesh, column.cell, Kinematics.PLANE_STRAIN)
    start = specific_volume(points)
    for _ in range(3):
        equilibrium = SimpleNamespace(
            displacement=0.01 * rng.normal(size=mesh.nodes.shape),
            trial=SimpleNamespace(cell_volume_ratio=rng.uniform(0.99, 1.01, len(mesh.cell_nodes))),
        )
        fill = fill_cells(points, mesh, column.cell, geometry, 0.3)
        points, is_sound = take_state(
            points, mesh, fill, equilibrium, column.model, column.gradient
        )
        assert is_sound
    assert points.state_variables[:, 2].max() > 0.01  # plastic shear strain
    expected = start + np.log(points.volume_ratio)
    np.testing.assert_allclose(specific_volume(points), expected, atol=1e-13)


def test_pressure_evens_out_by_volume(make_column, rng):
    """Loose sand without pressure beside sand under pressure, at rest: one shrinks, others expand.

    If it kept its volume it would grow in a flow of sand under pressure that expands in its cell.
    """
    column = make_column(Ground(unit_weight=18e3, k0=0.5, soil=DENSE_SAND))
    mesh, points = column.mesh, column.scattered_points(rng)
    geometry = cell_geometry(mesh, column.cell, Kinematics.PLANE_STRAIN)
    fill = fill_cells(points, mesh, column.cell, geometry, 0.3)
    slack = np.flatnonzero(points.cell == 4)[0]
    strain, state = points.elastic_log_strain.copy(), points.state_variables.copy()
    taken = -np.trace(strain[slack])
    state[slack, 0] -= taken  # its specific volume stays
    strain[slack] = 0.0
    points = points._replace(elastic_log_strain=strain, state_variables=state)
    rest = SimpleNamespace(
        displacement=np.zeros_like(mesh.nodes),
        trial=SimpleNamespace(cell_volume_ratio=np.ones(len(mesh.cell_nodes))),
    )
    updated, _ = take_state(points, mesh, fill, rest, column.model, column.gradient)
    of_cell, before = (np.bincount(points.cell, each.volume) for each in (updated, points))
    np.testing.assert_allclose(of_cell, before, rtol=1e-14)
    change = np.log(updated.volume / points.volume)
    beside = (points.cell == 4) & (np.arange(len(change)) != slack)
    assert 0.5 * taken < -change[slack] < taken
    assert (change[beside] > 0.0).all()
    np.testing.assert_allclose(change[points.cell != 4], 0.0, atol=1e-12)
    np.testing.assert_allclose(updated.volume_ratio / points.volume_ratio, np.exp(change))
    expected = specific_volume(points) + change
    np.testing.assert_allclose(specific_volume(updated), expected, atol=1e-14)
    again, _ = take_state(updated, mesh, fill, rest, column.model, column.gradient)
    np.testing.assert_allclose(again.volume, updated.volume, rtol=1e-12)


def specific_volume(points):
    """Its logarithm, elastic and plastic part."""
    return points.state_variables[:, 0] + np.trace(points.elastic_log_strain, axis1=1, axis2=2)


def test_cells_that_may_open_are_held_and_firm_ones_are_not(make_column, rng):
    """The stiffness of a step: modulus times volume times what the points lack of 10 kPa."""
    column = make_column(Ground(unit_weight=18e3, k0=0.5, soil=DENSE_SAND))
    given = give_state(column.scattered_points(rng), column.mesh, column.model, column.gradient)
    bulk = DENSE_SAND.youngs_modulus / 3.0 / (1.0 - 2.0 * DENSE_SAND.poissons_ratio)
    pressure = np.full(len(given.quadrature.volume), 50e3)
    pressure[:9] = [-1e3, 0.0, 0.0, 2.5e3, 5e3, 7.5e3, 10e3, 10e3, 4e3]  # three points a cell
    strain = -pressure[:, None, None] / (3.0 * bulk) * np.eye(3)
    points = given.quadrature._replace(elastic_log_strain=strain)
    share = opening_share(points, column.model.materials)
    np.testing.assert_allclose(share[:3], [1.0, 0.5, 0.2])
    assert not share[3:].any()
    numerics = replace(column.model.numerics, open_stiffness=1e-3)
    free = cell_options(given.fill, points, column.model)
    held = cell_options(given.fill, points, column.model._replace(numerics=numerics))
    added = held.soft_stiffness - free.soft_stiffness
    youngs_modulus = 1e-3 * DENSE_SAND.youngs_modulus * share
    expected = 0.5 * youngs_modulus * given.fill.cell_volume / 3.0  # that in shear
    np.testing.assert_allclose(added, expected, rtol=1e-9, atol=1e-6)


def test_pressure_under_which_sand_may_open_is_that_of_its_law():
    soils = [DENSE_SAND, CriticalStateSand(0.7, 0.92, 0.83, 0.02, 11e6)]
    strain = np.zeros((2, 6))
    stress, state = np.zeros((2, 6)), np.zeros((2, 3))
    stress[:, :3], state[:, 2] = -10e3, 1e6  # the shear modulus does not matter
    materials = dispatch.pack(soils)
    dispatch.elastic_strain_from_stress_all(materials, np.arange(2), stress, state, strain)
    expected = strain[:, :3].sum(axis=1)
    np.testing.assert_allclose(volumetric_strain_under(10e3, materials), expected, rtol=1e-12)


def test_soil_without_an_apex_never_opens(make_column, clay_ground):
    column = make_column(clay_ground)
    given = give_state(column.points(), column.mesh, column.model, column.gradient)
    assert not opening_share(given.quadrature, column.model.materials).any()


def with_openings(points, rng):
    """Sand that has opened in three cells, in the third of them beside a point that has not."""
    state = points.state_variables.copy()
    is_open = points.cell < 3
    state[is_open, OPENING] = rng.uniform(0.001, 0.02, is_open.sum())
    state[np.flatnonzero(points.cell == 2)[0], OPENING] = 0.0
    return points._replace(state_variables=state)


def test_openings_of_a_cell_are_shared_or_closed(make_column, rng):
    """Sand that has opened and sand under pressure in one cell: at rest no pressure is lost."""
    column = make_column(Ground(unit_weight=18e3, k0=0.5, soil=DENSE_SAND))
    points = with_openings(column.scattered_points(rng), rng)
    given = give_state(points, column.mesh, column.model, column.gradient)
    opening, before = given.points.state_variables[:, OPENING], points.state_variables[:, OPENING]
    for cell in (0, 1):
        of_cell = opening[given.points.cell == cell]
        assert np.ptp(of_cell) == 0.0
        assert before[points.cell == cell].min() < of_cell[0] < before[points.cell == cell].max()
    assert not opening[given.points.cell > 1].any()
    per_cell = given.quadrature.state_variables[:, OPENING].reshape(len(column.mesh.cell_nodes), -1)
    assert not per_cell[2:].any()


def test_what_was_open_goes_with_the_opening_and_sharing_conserves_volume(make_column, rng):
    """Passing points under pressure would make sand in a dead corner grow without end."""
    column = make_column(Ground(unit_weight=18e3, k0=0.5, soil=DENSE_SAND))
    points = with_openings(column.scattered_points(rng), rng)
    shared, closed_volume = share_openings(points, column.model.materials)
    opening = points.state_variables[:, OPENING]
    volume = np.where(points.cell == 2, points.volume * np.exp(-opening), points.volume)
    of_cell, expected = (np.bincount(points.cell, each) for each in (shared.volume, volume))
    np.testing.assert_allclose(of_cell, expected, rtol=1e-14)
    assert closed_volume == pytest.approx(points.volume.sum() - volume.sum(), rel=1e-9)
    assert closed_volume > 0.0
    initial_volume = points.volume / points.volume_ratio
    np.testing.assert_allclose(shared.volume / shared.volume_ratio, initial_volume, rtol=1e-14)
    change = specific_volume(shared) - specific_volume(points)
    np.testing.assert_allclose(change, np.log(shared.volume / points.volume), atol=1e-14)
    assert np.array_equal(shared.mass, points.mass)


def test_undrained_sand_keeps_its_volume(make_column, rng):
    """It is that of its pore water: only the opening is shared."""
    soil = replace(DENSE_SAND, pore_fluid_bulk_modulus=2e9)
    column = make_column(Ground(unit_weight=18e3, k0=0.5, soil=soil))
    points = column.scattered_points(rng)
    state = points.state_variables.copy()
    (opening,) = dispatch.state_columns(column.model.materials, "opening")
    state[points.cell < 2, opening] = 0.01
    state[0, opening] = 0.02
    points = points._replace(state_variables=state)
    shared, closed_volume = share_openings(points, column.model.materials)
    assert closed_volume == 0.0
    assert np.array_equal(shared.volume, points.volume)
    same = np.delete(shared.state_variables == points.state_variables, opening, axis=1)
    assert same.all()
    assert shared.state_variables[0, opening] < 0.02


def test_collapsed_points_are_not_sound(make_column, elastic_ground, rng):
    column = make_column(elastic_ground)
    mesh = column.mesh
    points = column.scattered_points(rng)
    fill = fill_cells(
        points, mesh, column.cell, cell_geometry(mesh, column.cell, Kinematics.PLANE_STRAIN), 0.3
    )
    displacement = np.zeros_like(mesh.nodes)
    displacement[mesh.cell_nodes[4, 0]] = 3.0
    trial = SimpleNamespace(cell_volume_ratio=np.ones(len(mesh.cell_nodes)))
    equilibrium = SimpleNamespace(displacement=displacement, trial=trial)
    assert not take_state(points, mesh, fill, equilibrium, column.model, column.gradient)[1]


def test_displacement_leads_from_the_start_to_the_place_of_a_point(
    make_column, elastic_ground, rng
):
    """Also where a point was brought back from outside: the hand-over finds its start by it."""
    column = make_column(elastic_ground)
    mesh = column.mesh
    points = column.scattered_points(rng)
    start = points.position - points.displacement
    lowered = mesh._replace(nodes=mesh.nodes * [1.0, 1.1] - [0.0, 0.05])
    n_projected = locate(points, lowered)
    is_outside = start[:, 1] > -0.05
    assert n_projected == is_outside.sum() > 0
    np.testing.assert_allclose(points.position - points.displacement, start, atol=1e-15)


@pytest.fixture(scope="module")
def beside_pile(pile, box, mesh_options, clay_ground):
    """Mesh, points, interface elements and interface of a pile wished in place."""
    mesh = generate_background_mesh(pile, box, mesh_options)
    elements, parts = pile_elements(mesh, pile)
    law = CoulombInterface(2e8, 2e7, adhesion_factor=0.5)
    return SimpleNamespace(
        mesh=mesh,
        elements=elements,
        interface=initial_interface(elements, parts, mesh, clay_ground, law),
        points=seed_points(mesh, reference_cell(CellType.TRI6), clay_ground, 2),
    )


def switched(site, points):
    cell = reference_cell(CellType.TRI6)
    fill = fill_cells(
        points, site.mesh, cell, cell_geometry(site.mesh, cell, Kinematics.PLANE_STRAIN), 0.3
    )
    result = switch_on(site.interface, fill, SimpleNamespace(elements=site.elements))
    return result, fill


@pytest.mark.gmsh
def test_level_ground_covers_the_whole_buried_pile(beside_pile):
    result, _ = switched(beside_pile, beside_pile.points)
    for name, expected in beside_pile.interface._asdict().items():
        np.testing.assert_array_equal(getattr(result, name), expected)
    is_buried = beside_pile.interface.position[:, 1] < 0.0
    np.testing.assert_array_equal(result.covered, is_buried)


@pytest.mark.gmsh
def test_facets_count_with_the_share_that_soil_covers(beside_pile):
    """Soil taken away above -0.55 m: facets above drop out, one at the level counts less."""
    points = beside_pile.points
    is_left = points.position[:, 1] < -0.55
    points = MaterialPoints(*(field[is_left] for field in points))
    result, fill = switched(beside_pile, points)
    ends = beside_pile.elements.nodes[:, :2]
    for e, cell in enumerate(beside_pile.elements.cell):
        own = slice(3 * e, 3 * e + 3)
        covered = min(1.0, fill.vertex_fill[ends[e]].min() / LEVEL_FILL)
        is_active = covered > 0.0 and (points.cell == cell).any()
        assert ((result.covered[own] > 0.0) == is_active).all()
        np.testing.assert_allclose(result.covered[own], covered * is_active, rtol=1e-14)
        traction = beside_pile.interface.traction[own] * is_active
        np.testing.assert_array_equal(result.traction[own], traction)
    height = beside_pile.interface.position[:, 1]
    assert (result.covered > 0.0)[height < -0.8].all()
    assert not result.covered[height > -0.2].any()
    np.testing.assert_array_equal(result.area, beside_pile.interface.area)
    assert ((result.covered > 0.0) & (result.covered < 1.0)).any()
