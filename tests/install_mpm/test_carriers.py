"""Material points as carriers: filling of cells, state at the integration points, injection."""

from types import SimpleNamespace

import numpy as np
import pytest

from install_mpm import injection
from install_mpm.carriers import integration_points
from install_mpm.cell_fill import cell_geometry, fill_cells
from install_mpm.cells import CellType, reference_cell, sub_region_points
from install_mpm.constitutive import dispatch
from install_mpm.conventions import GRAVITY, Kinematics
from install_mpm.geostatic import elastic_strain_of, geostatic_gradient
from install_mpm.ground import geostatic_stress
from install_mpm.injection import LEAST_SHARE, inject, merge
from install_mpm.kernels.carry import body_force, nearest_integration_point
from install_mpm.material_points import MaterialPoints
from install_mpm.seeding import seed_points

CELL = reference_cell(CellType.TRI6)
THRESHOLD = 0.3


@pytest.fixture
def mesh(make_grid):
    return make_grid(4, 5, width=2.0, depth=3.0, distortion=0.25)


def points_at(mesh, ground, cells, coordinates, volume):
    """Material points of undisturbed ground at reference coordinates (n, 2) in ``cells``."""
    corners = mesh.nodes[mesh.cell_nodes[cells, :3]]
    shares = np.column_stack([1.0 - coordinates.sum(axis=1), coordinates])
    position = np.einsum("pv,pvi->pi", shares, corners)
    stress = geostatic_stress(ground, position[:, 1], 1)
    state = dispatch.initial_state(ground.soil, -position[:, 1], stress)
    return MaterialPoints(
        position=position,
        displacement=np.zeros_like(position),
        mass=volume * ground.unit_weight / GRAVITY,
        volume=volume,
        volume_ratio=np.ones(len(position)),
        elastic_log_strain=elastic_strain_of(ground.soil, stress, state),
        kirchhoff_stress=stress,
        state_variables=state,
        material=np.zeros(len(position), dtype=np.int64),
        cell=cells,
        reference_coordinates=coordinates,
    )


def scattered(mesh, ground, rng, per_region=2):
    """Points at random places, at least one in every sub-region, of random volumes."""
    coordinates, _ = sub_region_points(CELL, per_region)
    n_cells = len(mesh.cell_nodes)
    jitter = rng.uniform(-0.04, 0.04, size=(n_cells, len(coordinates), 2))
    cells = np.repeat(np.arange(n_cells), len(coordinates))
    share = rng.uniform(0.2, 1.0, size=(n_cells, len(coordinates)))
    volume = (
        share
        / share.sum(axis=1, keepdims=True)
        * cell_geometry(mesh, CELL, Kinematics.PLANE_STRAIN).volume[:, None]
    )
    return points_at(mesh, ground, cells, (coordinates + jitter).reshape(-1, 2), volume.ravel())


def carried(points, mesh, ground):
    """Integration points, fill and geometry."""
    geometry = cell_geometry(mesh, CELL, Kinematics.PLANE_STRAIN)
    fill = fill_cells(points, mesh, CELL, geometry, THRESHOLD)
    gradient = geostatic_gradient(ground, 1)
    quadrature, is_empty = integration_points(points, CELL, geometry, fill, gradient)
    return quadrature, is_empty, fill, geometry


def kept(points, selected):
    return MaterialPoints(*(field[selected] for field in points))


def sub_region_of(points):
    """Index of the largest barycentric coordinate."""
    shares = np.column_stack(
        [1.0 - points.reference_coordinates.sum(axis=1), points.reference_coordinates]
    )
    return shares.argmax(axis=1)


def test_geostatic_ground_is_carried_exactly(mesh, clay_ground, rng):
    points = scattered(mesh, clay_ground, rng)
    quadrature, is_empty, _, geometry = carried(points, mesh, clay_ground)
    assert not is_empty.any()
    height = geometry.integration_height.ravel()
    stress = geostatic_stress(clay_ground, height, 1)
    expected = elastic_strain_of(clay_ground.soil, stress, quadrature.state_variables)
    np.testing.assert_allclose(
        quadrature.elastic_log_strain, expected, atol=1e-14 * np.abs(expected).max()
    )
    np.testing.assert_allclose(quadrature.volume_ratio, 1.0, rtol=1e-14)
    np.testing.assert_allclose(quadrature.density, 18e3 / GRAVITY, rtol=1e-13)
    np.testing.assert_allclose(quadrature.volume.reshape(-1, 3).sum(axis=1), geometry.volume)


def test_constant_fields_are_carried_exactly(mesh, clay_ground, rng):
    """A geostatic gradient of zero, random volumes: every mean of a constant is the constant."""
    points = scattered(mesh, clay_ground, rng)
    strain = rng.normal(size=(3, 3))
    strain = strain + strain.T
    points.elastic_log_strain[:] = strain
    points.state_variables[:] = [12e3, 0.3]
    points.volume_ratio[:] = 0.93
    geometry = cell_geometry(mesh, CELL, Kinematics.PLANE_STRAIN)
    fill = fill_cells(points, mesh, CELL, geometry, THRESHOLD)
    gradient = geostatic_gradient(clay_ground, 1)
    gradient = gradient._replace(strain=0.0 * gradient.strain)
    quadrature, _ = integration_points(points, CELL, geometry, fill, gradient)
    n = len(quadrature.volume)
    np.testing.assert_allclose(
        quadrature.elastic_log_strain, np.tile(strain, (n, 1, 1)), rtol=1e-13
    )
    np.testing.assert_allclose(quadrature.state_variables, np.tile([12e3, 0.3], (n, 1)), rtol=1e-13)
    np.testing.assert_allclose(quadrature.volume_ratio, 0.93, rtol=1e-13)


def test_state_is_the_volume_mean_of_the_sub_region(mesh, clay_ground, rng):
    points = scattered(mesh, clay_ground, rng)
    points.state_variables[:] = rng.uniform(size=points.state_variables.shape)
    points.volume_ratio[:] = rng.uniform(0.8, 1.2, len(points.mass))
    points.mass[:] *= rng.uniform(0.5, 1.5, len(points.mass))
    quadrature, _, _, _ = carried(points, mesh, clay_ground)
    region = points.cell * 3 + sub_region_of(points)
    for q in range(len(quadrature.volume)):
        own = region == q
        weight = points.volume[own] / points.volume[own].sum()
        np.testing.assert_allclose(
            quadrature.state_variables[q], weight @ points.state_variables[own], rtol=1e-12
        )
        log_ratio = weight @ np.log(points.volume_ratio[own])
        assert quadrature.volume_ratio[q] == pytest.approx(np.exp(log_ratio), rel=1e-12)
        density = points.mass[own].sum() / points.volume[own].sum()
        assert quadrature.density[q] == pytest.approx(density, rel=1e-12)


def test_full_mesh_fills_every_vertex(mesh, clay_ground):
    points = seed_points(mesh, CELL, clay_ground, 2)
    _, _, fill, geometry = carried(points, mesh, clay_ground)
    vertices = np.unique(mesh.cell_nodes[:, :3])
    np.testing.assert_allclose(fill.vertex_fill[vertices], 1.0, rtol=1e-13)
    assert not np.delete(fill.vertex_fill, vertices).any()
    np.testing.assert_allclose(fill.share, 1.0, rtol=1e-13)
    assert fill.is_interior.all()
    assert fill.is_active.all()
    np.testing.assert_array_equal(fill.cell_volume, geometry.volume)


def test_order_of_points_is_stable_and_complete(mesh, clay_ground, rng):
    points = scattered(mesh, clay_ground, rng)
    points = kept(points, rng.permutation(len(points.mass)))
    _, _, fill, _ = carried(points, mesh, clay_ground)
    for c in range(len(mesh.cell_nodes)):
        own = fill.point_order[fill.cell_start[c] : fill.cell_start[c + 1]]
        np.testing.assert_array_equal(own, np.flatnonzero(points.cell == c))


def test_upper_half_empty(mesh, clay_ground, rng):
    """Cells without points count nothing, partly filled ones count their points."""
    points = scattered(mesh, clay_ground, rng)
    points = kept(points, points.position[:, 1] < -1.3)
    quadrature, is_empty, fill, geometry = carried(points, mesh, clay_ground)
    volume = quadrature.volume.reshape(-1, 3)
    soil = np.bincount(points.cell, points.volume, minlength=len(mesh.cell_nodes))
    np.testing.assert_array_equal(fill.is_active, soil > 0.0)
    assert (~fill.is_active).any()
    is_partly = fill.is_active & ~fill.is_interior
    assert is_partly.any()
    assert not volume[~fill.is_active].any()
    np.testing.assert_allclose(
        volume[fill.is_interior].sum(axis=1), geometry.volume[fill.is_interior]
    )
    assert (volume[is_partly].sum(axis=1) <= soil[is_partly] * (1.0 + 1e-14)).all()
    assert (volume[is_partly] <= geometry.volume[is_partly][:, None] / 3.0 * (1.0 + 1e-14)).all()
    assert not is_empty[~fill.is_active].any()
    assert np.isfinite(quadrature.elastic_log_strain).all()


def test_interior_cells_have_all_vertices_above_the_threshold(mesh, clay_ground, rng):
    points = scattered(mesh, clay_ground, rng)
    points = kept(points, points.position[:, 1] < -1.3)
    _, _, fill, _ = carried(points, mesh, clay_ground)
    for cell, is_interior in zip(mesh.cell_nodes, fill.is_interior, strict=True):
        assert is_interior == (fill.vertex_fill[cell[:3]] > THRESHOLD).all()


def test_soil_that_has_thinned_out_inside_is_no_void(make_grid, clay_ground):
    """Around one vertex hardly a point is left, and one cell has none: the ground is still full."""
    mesh = make_grid(6, 6, width=3.0, depth=3.0)
    points = seed_points(mesh, CELL, clay_ground, 2)
    inside = np.argmin(np.linalg.norm(mesh.nodes - [1.5, -1.5], axis=1))
    around = np.flatnonzero((mesh.cell_nodes[:, :3] == inside).any(axis=1))
    points.volume[np.isin(points.cell, around)] *= 0.05
    points = kept(points, points.cell != around[0])
    quadrature, _, fill, geometry = carried(points, mesh, clay_ground)
    assert fill.share[around].max() < THRESHOLD / 4.0
    assert fill.is_interior.all()
    volume = quadrature.volume.reshape(-1, 3).sum(axis=1)
    np.testing.assert_allclose(volume[fill.is_active], geometry.volume[fill.is_active])
    refilled = inject(points, mesh, CELL, geometry, fill, geostatic_gradient(clay_ground, 1))
    assert np.bincount(refilled.cell, minlength=len(mesh.cell_nodes)).min() > 0
    assert refilled.volume.sum() == pytest.approx(points.volume.sum(), rel=1e-14)


@pytest.mark.parametrize("most", [3, 5, 11])
def test_merging_conserves_integrals(mesh, clay_ground, rng, most):
    """However many of the twelve points of a cell have to go, some of them more than once."""
    points = scattered(mesh, clay_ground, rng)
    points.volume_ratio[:] = rng.uniform(0.9, 1.1, len(points.mass))
    points.elastic_log_strain[:] = rng.normal(size=points.elastic_log_strain.shape)
    _, _, fill, _ = carried(points, mesh, clay_ground)
    merged = merge(points, CELL, fill, most)
    assert np.bincount(merged.cell).max() == most
    for c in range(len(mesh.cell_nodes)):
        before, after = (kept(of, of.cell == c) for of in (points, merged))
        for of_cell in (
            lambda of: of.mass.sum(),
            lambda of: of.volume.sum(),
            lambda of: (of.volume / of.volume_ratio).sum(),
            lambda of: of.volume @ of.position,
            lambda of: np.tensordot(of.volume, of.elastic_log_strain, axes=1),
            lambda of: np.tensordot(of.volume / of.volume_ratio, of.kirchhoff_stress, axes=1),
        ):
            np.testing.assert_allclose(of_cell(after), of_cell(before), rtol=1e-12, atol=1e-14)


def test_thin_cover_at_the_top_of_the_mesh_is_not_taken_for_full_ground(make_grid, clay_ground):
    """The one row of cells into which soil heaves holds some everywhere, and is not empty."""
    mesh = make_grid(4, 4, width=2.0, depth=2.0)
    points = seed_points(mesh, CELL, clay_ground, 3)
    top = mesh.nodes[mesh.cell_nodes[:, :3], 1].max(axis=1) > -1e-9
    points.volume[top[points.cell]] *= 0.1
    _, _, fill, _ = carried(points, mesh, clay_ground)
    assert fill.is_active.all()
    assert not fill.is_interior[top].any()


def test_empty_sub_region_takes_the_mean_of_its_cell(mesh, clay_ground, rng):
    points = scattered(mesh, clay_ground, rng)
    points.state_variables[:] = rng.uniform(size=points.state_variables.shape)
    is_left_out = (points.cell == 6) & (sub_region_of(points) == 1)
    points = kept(points, ~is_left_out)
    quadrature, is_empty, _, _ = carried(points, mesh, clay_ground)
    np.testing.assert_array_equal(np.argwhere(is_empty), [[6, 1]])
    own = points.cell == 6
    mean = points.volume[own] @ points.state_variables[own] / points.volume[own].sum()
    np.testing.assert_allclose(quadrature.state_variables[3 * 6 + 1], mean, rtol=1e-12)
    assert quadrature.density[3 * 6 + 1] == pytest.approx(18e3 / GRAVITY)


def test_weight_of_the_soil_hangs_on_the_nodes(mesh, clay_ground, rng):
    """The sum is the weight, its moment that of the integration points, and it points downward."""
    points = scattered(mesh, clay_ground, rng)
    quadrature, _, _, geometry = carried(points, mesh, clay_ground)
    force = np.zeros_like(mesh.nodes)
    body_force(mesh.cell_nodes, quadrature, GRAVITY, force)
    assert not force[:, 0].any()
    assert -force[:, 1].sum() == pytest.approx(18e3 * geometry.volume.sum(), rel=1e-13)
    centre = np.einsum("c,cvi->i", geometry.volume, mesh.nodes[mesh.cell_nodes[:, :3]]) / 3.0
    np.testing.assert_allclose(-force[:, 1] @ mesh.nodes, 18e3 * centre, rtol=1e-12)


@pytest.fixture
def with_holes(mesh, clay_ground, rng):
    """Points without those of some sub-regions and of one whole cell inside the ground."""
    points = scattered(mesh, clay_ground, rng)
    centre = mesh.nodes[mesh.cell_nodes[:, :3]].mean(axis=1)
    inside = np.linalg.norm(centre - [1.0, -1.5], axis=1).argsort()[:6]
    region = sub_region_of(points)
    is_left_out = (points.cell == inside[0]) | (np.isin(points.cell, inside[3:]) & (region == 2))
    is_left_out |= (points.cell == inside[3]) & (region > 0)
    return kept(points, ~is_left_out), inside


def injected(points, mesh, ground):
    geometry = cell_geometry(mesh, CELL, Kinematics.PLANE_STRAIN)
    fill = fill_cells(points, mesh, CELL, geometry, THRESHOLD)
    return inject(points, mesh, CELL, geometry, fill, geostatic_gradient(ground, 1))


def test_injection_fills_every_empty_sub_region_of_interior_cells(mesh, clay_ground, with_holes):
    points, inside = with_holes
    enriched = injected(points, mesh, clay_ground)
    assert len(enriched.mass) - len(points.mass) == 3 + 2 + 2
    _, is_empty, fill, _ = carried(enriched, mesh, clay_ground)
    assert not is_empty.any()
    assert fill.is_active.all()
    new = slice(len(points.mass), None)
    assert set(enriched.cell[new]) == set(inside[[0, 3, 4, 5]])
    for c, xi, place in zip(
        enriched.cell[new], enriched.reference_coordinates[new], enriched.position[new], strict=True
    ):
        corners = mesh.nodes[mesh.cell_nodes[c, :3]]
        expected = np.array([1.0 - xi.sum(), *xi]) @ corners
        np.testing.assert_allclose(place, expected, atol=1e-15)
        assert (np.abs(CELL.integration_coordinates - xi) < 1e-15).all(axis=1).any()


def test_injection_conserves_mass_and_volume(mesh, clay_ground, with_holes):
    points, _ = with_holes
    enriched = injected(points, mesh, clay_ground)
    assert enriched.volume.sum() == pytest.approx(points.volume.sum(), rel=1e-15)
    assert enriched.mass.sum() == pytest.approx(points.mass.sum(), rel=1e-15)
    assert (enriched.volume > 0.0).all()
    np.testing.assert_allclose(enriched.mass / enriched.volume, 18e3 / GRAVITY, rtol=1e-13)


def test_injection_moves_the_geostatic_state_exactly(mesh, clay_ground, with_holes):
    points, _ = with_holes
    enriched = injected(points, mesh, clay_ground)
    stress = geostatic_stress(clay_ground, enriched.position[:, 1], 1)
    np.testing.assert_allclose(enriched.kirchhoff_stress, stress, atol=1e-11 * np.abs(stress).max())
    expected = elastic_strain_of(clay_ground.soil, stress, enriched.state_variables)
    np.testing.assert_allclose(
        enriched.elastic_log_strain, expected, atol=1e-14 * np.abs(expected).max()
    )


def test_stress_of_an_injected_point_belongs_to_its_strain(mesh, clay_ground, with_holes):
    """Also where the ground was compressed: the Kirchhoff stress is linear in the log strain."""
    points, _ = with_holes
    points.volume_ratio[:] = 0.8
    enriched = injected(points, mesh, clay_ground)
    expected = elastic_strain_of(
        clay_ground.soil, enriched.kirchhoff_stress, enriched.state_variables
    )
    np.testing.assert_allclose(
        enriched.elastic_log_strain, expected, atol=1e-13 * np.abs(expected).max()
    )


def test_a_point_that_is_split_again_is_halved_again(mesh, clay_ground, rng):
    """The one point of a cell with three sub-regions gives a quarter and another quarter."""
    points = scattered(mesh, clay_ground, rng)
    centre = mesh.nodes[mesh.cell_nodes[:, :3]].mean(axis=1)
    inner = np.linalg.norm(centre - [1.0, -1.5], axis=1).argmin()
    own = np.flatnonzero(points.cell == inner)
    is_left = np.ones(len(points.mass), dtype=bool)
    is_left[own[1:]] = False
    points = kept(points, is_left)
    enriched = injected(points, mesh, clay_ground)
    here = points.cell == inner
    for name in ("volume", "mass"):
        whole = getattr(points, name)[here][0]
        parts = getattr(enriched, name)[enriched.cell == inner]
        np.testing.assert_array_equal(parts, whole * np.array([0.25, 0.5, 0.25]))
        others = getattr(enriched, name)[enriched.cell != inner]
        np.testing.assert_array_equal(others, getattr(points, name)[~here])


def test_a_crumb_is_not_split(mesh, clay_ground, rng):
    """Soil that flows through an empty sub-region would else halve its donor in every step."""
    points = scattered(mesh, clay_ground, rng)
    centre = mesh.nodes[mesh.cell_nodes[:, :3]].mean(axis=1)
    inner = np.linalg.norm(centre - [1.0, -1.5], axis=1).argmin()
    is_left = (points.cell != inner) | (sub_region_of(points) == 0)
    points = kept(points, is_left)
    region = cell_geometry(mesh, CELL, Kinematics.PLANE_STRAIN).integration_volume[inner].min()
    for share in (0.5, 2.0 * LEAST_SHARE, 0.9 * LEAST_SHARE):
        volume = np.where(points.cell == inner, share * region, points.volume)
        enriched = injected(points._replace(volume=volume), mesh, clay_ground)
        assert (len(enriched.mass) > len(points.mass)) == (share > LEAST_SHARE)


@pytest.mark.parametrize("cell_type", [CellType.TRI6, CellType.TET10])
def test_sub_region_is_the_one_that_the_kernel_finds(cell_type, rng):
    """Also where two are equally near: in the middle of edges and of the cell."""
    cell = reference_cell(cell_type)
    shares = rng.dirichlet(np.ones(cell.dim + 1), size=200)
    shares[:50] = rng.integers(1, 3, size=(50, cell.dim + 1))
    coordinates = (shares / shares.sum(axis=1, keepdims=True))[:, 1:]
    points = SimpleNamespace(reference_coordinates=coordinates, cell=np.zeros(200, dtype=np.int64))
    expected = [nearest_integration_point(xi, cell.integration_coordinates) for xi in coordinates]
    np.testing.assert_array_equal(injection.sub_region_of(points, cell), expected)


def test_injection_leaves_complete_cells_alone(mesh, clay_ground, rng):
    points = scattered(mesh, clay_ground, rng)
    assert injected(points, mesh, clay_ground) is points


def test_injection_does_not_change_its_input(mesh, clay_ground, with_holes):
    points, _ = with_holes
    before = [field.copy() for field in points]
    injected(points, mesh, clay_ground)
    for field, expected in zip(points, before, strict=True):
        np.testing.assert_array_equal(field, expected)


def test_empty_surface_cells_get_no_points(mesh, clay_ground, rng):
    """Only interior cells are filled up: injection must not raise the ground surface."""
    points = scattered(mesh, clay_ground, rng)
    points = kept(points, points.position[:, 1] < -1.3)
    enriched = injected(points, mesh, clay_ground)
    geometry = cell_geometry(mesh, CELL, Kinematics.PLANE_STRAIN)
    fill = fill_cells(points, mesh, CELL, geometry, THRESHOLD)
    new = enriched.cell[len(points.mass) :]
    assert fill.is_interior[new].all()
