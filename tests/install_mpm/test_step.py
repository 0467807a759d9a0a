"""One step: ground at rest on a moving mesh, exact deformations, and what happens to the points."""

from types import SimpleNamespace

import numpy as np
import pytest

from install_mpm.assembly import sparsity_pattern
from install_mpm.carriers import cell_geometry, fill_cells
from install_mpm.conventions import Kinematics
from install_mpm.cells import CellType, reference_cell
from install_mpm.constitutive import dispatch
from install_mpm.constitutive.parameters import HenckyElastic, VonMises
from install_mpm.conventions import GRAVITY
from install_mpm.equilibrium import Discretisation, Prescribed
from install_mpm.ground import Ground, geostatic_stress
from install_mpm.interface import InterfaceElements, InterfacePoints, facet_rule
from install_mpm.linear_solvers import superlu
from install_mpm.material_points import MaterialPoints, cauchy_stress
from install_mpm.mesh_motion import translate
from install_mpm.options import Numerics
from install_mpm.pile import PileMotion
from install_mpm.seeding import elastic_strain_of, geostatic_gradient, seed_points
from install_mpm.step import carry, locate, step

CELL = reference_cell(CellType.TRI6)
WIDTH, DEPTH = 1.5, 3.0


def no_interface():
    """No elements and no points."""
    elements = InterfaceElements(
        np.empty((0, 3), dtype=np.int64), np.empty(0, dtype=np.int64), *facet_rule(3, 3)
    )
    vectors, scalars, integers = np.empty((0, 2)), np.empty(0), np.empty(0, dtype=np.int64)
    points = InterfacePoints(
        vectors, vectors, scalars, vectors, np.empty((0, 5)), integers, integers
    )
    return elements, points


class Column:
    """A box of soil on rollers, without pile."""

    def __init__(self, mesh, ground, *, tolerance=1e-9):
        elements, self.interface = no_interface()
        pattern = sparsity_pattern([mesh.cell_nodes, elements.nodes], len(mesh.nodes), 2)
        self.mesh, self.ground = mesh, ground
        self.model = Discretisation(
            CELL,
            elements,
            dispatch.pack([ground.soil]),
            pattern,
            superlu(pattern),
            Numerics(tolerance=tolerance),
        )
        x, z = mesh.reference_nodes.T
        self.supports = np.zeros(mesh.nodes.shape, dtype=bool)
        self.supports[:, 0] = (x < 1e-9) | (x > WIDTH - 1e-9)
        self.supports[:, 1] = z < -DEPTH + 1e-9
        self.gradient = geostatic_gradient(ground, 1)

    def step(self, points, mesh, prescribed=None, move_mesh=lambda mesh: mesh, start=None):
        at_rest = np.zeros_like(mesh.nodes)
        return step(
            points, mesh, self.interface, PileMotion(np.zeros(2)),
            prescribed or Prescribed(self.supports, at_rest), at_rest if start is None else start,
            move_mesh, self.model, self.gradient,
        )  # fmt: skip


@pytest.fixture
def mesh(make_grid):
    return make_grid(3, 6, width=WIDTH, depth=DEPTH, distortion=0.2)


@pytest.fixture
def scattered(rng):
    """Function that shakes seeded points within their cells; they get their geostatic state."""

    def make(column):
        points = seed_points(column.mesh, CELL, column.ground, 2)
        coordinates = points.reference_coordinates + rng.uniform(
            -0.03, 0.03, points.reference_coordinates.shape
        )
        corners = column.mesh.nodes[column.mesh.cell_nodes[points.cell, :3]]
        shares = np.column_stack([1.0 - coordinates.sum(axis=1), coordinates])
        position = np.einsum("pv,pvi->pi", shares, corners)
        stress = geostatic_stress(column.ground, position[:, 1], 1)
        return points._replace(
            position=position,
            reference_coordinates=coordinates,
            kirchhoff_stress=stress,
            elastic_log_strain=elastic_strain_of(column.ground.soil, stress),
        )

    return make


GROUNDS = {
    "clay": Ground(18e3, 0.8, VonMises(4e6, 0.49, 20e3)),
    "elastic": Ground(16e3, 0.5, HenckyElastic(5e6, 0.3)),
}
every_ground = pytest.mark.parametrize("ground", GROUNDS.values(), ids=GROUNDS)


@every_ground
def test_geostatic_ground_is_in_equilibrium(mesh, ground, scattered):
    column = Column(mesh, ground)
    points = scattered(column)
    result = column.step(points, mesh)
    assert result.is_converged
    assert result.equilibrium.newton.residuals[0] < 1e-10
    assert np.abs(result.equilibrium.displacement).max() < 1e-10
    weight = result.equilibrium.reaction[:, 1].sum()
    assert weight == pytest.approx(ground.unit_weight * WIDTH * DEPTH, rel=1e-10)
    stress = geostatic_stress(ground, points.position[:, 1], 1)
    np.testing.assert_allclose(
        result.points.kirchhoff_stress, stress, atol=1e-9 * np.abs(stress).max()
    )


@every_ground
def test_moving_the_mesh_alone_changes_nothing(mesh, ground, scattered):
    """The mesh goes up and down through ground at rest; points are only carried.

    Mass is kept exactly, volume to 1e-10, the stress stays geostatic to 1e-8 of its maximum.
    """
    column = Column(mesh, ground)
    start = scattered(column)
    points, current = start, mesh
    for advance in (0.3, 0.8, 0.2, -0.6, 0.0, 0.7):
        result = column.step(
            points,
            current,
            move_mesh=lambda mesh, a=advance: translate(mesh, a, -1.5, (-DEPTH, 0.0)),
        )
        assert result.is_converged
        assert result.equilibrium.newton.residuals[0] < 1e-10
        points, current = result.points, result.mesh
        assert result.counts.projected_points == 0
    n = len(start.mass)
    assert len(points.mass) > n  # cells outran their points: injection was at work
    np.testing.assert_allclose(points.position[:n], start.position, atol=1e-11)
    assert points.mass.sum() == pytest.approx(start.mass.sum(), rel=1e-14)
    assert points.volume.sum() == pytest.approx(start.volume.sum(), rel=1e-10)
    np.testing.assert_allclose(points.volume_ratio, 1.0, atol=1e-10)
    stress = geostatic_stress(ground, points.position[:, 1], 1)
    scale = np.abs(stress).max()
    np.testing.assert_allclose(points.kirchhoff_stress, stress, atol=1e-8 * scale)


def squeeze(column, mesh, share):
    """Prescribed motion of the top by ``share`` of the height, and the mesh that follows it."""
    is_prescribed = column.supports.copy()
    on_top = np.abs(mesh.nodes[:, 1] - mesh.nodes[:, 1].max()) < 1e-9
    is_prescribed[on_top, 1] = True
    height = mesh.nodes[:, 1] + DEPTH
    displacement = np.zeros_like(mesh.nodes)
    displacement[:, 1] = np.where(on_top, -share * height, 0.0)

    def follow(mesh):
        nodes = mesh.nodes.copy()
        nodes[:, 1] -= share * height
        return mesh._replace(nodes=nodes)

    return Prescribed(is_prescribed, displacement), follow


def test_oedometer_is_exact_in_many_steps(mesh):
    """Weightless elastic column: sigma = M ln(J) / J, the same in all points, after 5 x 8 %."""
    soil = HenckyElastic(5e6, 0.3)
    column = Column(mesh, Ground(0.0, 1.0, soil), tolerance=1e-12)
    start = seed_points(mesh, CELL, column.ground, 2)
    points, current = start, mesh
    for _ in range(5):
        prescribed, follow = squeeze(column, current, 0.08)
        first = 0.5 * (follow(current).nodes - current.nodes)
        result = column.step(points, current, prescribed, follow, first)
        assert result.is_converged
        points, current = result.points, result.mesh
    ratio = 0.92**5
    modulus = soil.youngs_modulus * 0.7 / (1.3 * 0.4)
    stress = cauchy_stress(points)
    expected = modulus * np.log(ratio) / ratio * np.diag([0.3 / 0.7, 1.0, 0.3 / 0.7])
    np.testing.assert_allclose(stress, np.tile(expected, (len(stress), 1, 1)), atol=1e-2)
    np.testing.assert_allclose(points.volume_ratio, ratio, rtol=1e-10)
    np.testing.assert_allclose(points.volume, ratio * start.volume, rtol=1e-10)
    height = (start.position[:, 1] + DEPTH) * ratio - DEPTH
    np.testing.assert_allclose(points.position[:, 1], height, atol=1e-9)
    np.testing.assert_allclose(points.displacement, points.position - start.position, atol=1e-15)
    np.testing.assert_array_equal(points.mass, start.mass)
    top = np.abs(current.nodes[:, 1] - current.nodes[:, 1].max()) < 1e-9
    load = result.equilibrium.reaction[top, 1].sum()
    assert load == pytest.approx(expected[1, 1] * WIDTH, rel=1e-9)


def test_rigid_rotation_turns_the_stress(mesh, make_rotation):
    """All nodes are turned in three steps; stress and strain turn with them, the volume stays."""
    column = Column(mesh, Ground(0.0, 1.0, HenckyElastic(5e6, 0.3)))
    points = seed_points(mesh, CELL, column.ground, 2)
    stress = np.array([[-20e3, 5e3, 0.0], [5e3, -60e3, 0.0], [0.0, 0.0, -10e3]])
    stress = np.tile(stress, (len(points.mass), 1, 1))
    points = points._replace(
        kirchhoff_stress=stress,
        elastic_log_strain=elastic_strain_of(column.ground.soil, stress),
    )
    turn = make_rotation(2)
    total, current, start = np.eye(3), mesh, points
    for _ in range(3):
        total = turn @ total
        displacement = current.nodes @ (turn[:2, :2] - np.eye(2)).T
        prescribed = Prescribed(np.ones(mesh.nodes.shape, dtype=bool), displacement)
        result = column.step(
            points,
            current,
            prescribed,
            lambda mesh, d=displacement: mesh._replace(nodes=mesh.nodes + d),
        )
        assert result.is_converged
        points, current = result.points, result.mesh
    np.testing.assert_allclose(
        points.kirchhoff_stress, total @ stress @ total.T, atol=1e-8 * np.abs(stress).max()
    )
    np.testing.assert_allclose(points.volume, start.volume, rtol=1e-12)
    np.testing.assert_allclose(points.position, start.position @ total[:2, :2].T, atol=1e-13)


def test_step_leaves_its_input_alone(mesh, clay_ground, scattered):
    column = Column(mesh, clay_ground)
    points = scattered(column)
    inputs = [*points, mesh.nodes]
    before = [field.copy() for field in inputs]
    result = column.step(points, mesh, *squeeze(column, mesh, 0.01))
    assert result.is_converged
    for field, expected in zip(inputs, before, strict=True):
        np.testing.assert_array_equal(field, expected)


def test_points_are_admissible_and_consistent_after_a_plastic_step(mesh, clay_ground, scattered):
    column = Column(mesh, clay_ground)
    points = scattered(column)
    prescribed, follow = squeeze(column, mesh, 0.0)
    is_left = (mesh.nodes[:, 1] > -1e-9) & (mesh.nodes[:, 0] < 0.51)
    prescribed.displacement[is_left, 1] = -0.03
    prescribed.is_prescribed[:, 1] &= is_left | (mesh.nodes[:, 1] < -1e-9)
    result = column.step(points, mesh, prescribed, follow)
    assert result.is_converged
    points = result.points
    n = len(points.mass)
    assert (points.state_variables[:, 1] > 0.0).mean() > 0.1
    deviator = points.kirchhoff_stress - np.einsum(
        "pii,jk->pjk", points.kirchhoff_stress, np.eye(3) / 3.0
    )
    norm = np.linalg.norm(deviator.reshape(n, 9), axis=1)
    assert (norm <= np.sqrt(2.0) * points.state_variables[:, 0] * (1.0 + 1e-9)).all()
    expected = elastic_strain_of(clay_ground.soil, points.kirchhoff_stress)
    np.testing.assert_allclose(points.elastic_log_strain, expected, atol=1e-14)


def test_step_without_convergence_gives_back_the_start(mesh, clay_ground, scattered):
    column = Column(mesh, clay_ground)
    points = scattered(column)
    column.model = column.model._replace(
        numerics=Numerics(tolerance=1e-12, max_iterations=3), solve=lambda values, load: 1e-6 * load
    )
    prescribed, follow = squeeze(column, mesh, 0.02)
    result = column.step(points, mesh, prescribed, follow)
    assert not result.is_converged
    for field, expected in zip(result.points, points, strict=True):
        np.testing.assert_array_equal(field, expected)
    assert result.mesh is mesh


def test_crushed_cells_are_a_failed_step(mesh, clay_ground):
    """The driven top passes its neighbours: no exception, and nothing to undo."""
    column = Column(mesh, clay_ground)
    points = seed_points(mesh, CELL, clay_ground, 2)
    assert not column.step(points, mesh, *squeeze(column, mesh, 0.4)).is_converged


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


def test_points_take_the_displacement_of_their_cell(mesh, scattered, rng):
    """Against plain arithmetic, for an arbitrary displacement of all nodes."""
    column = Column(mesh, GROUNDS["elastic"])
    points = scattered(column)
    n_cells = len(mesh.cell_nodes)
    displacement = 0.01 * rng.normal(size=mesh.nodes.shape)
    ratio = rng.uniform(0.95, 1.05, n_cells)
    geometry = cell_geometry(mesh, CELL, Kinematics.PLANE_STRAIN)
    fill = fill_cells(points, mesh, CELL, geometry, 0.3)
    equilibrium = SimpleNamespace(
        displacement=displacement, trial=SimpleNamespace(cell_volume_ratio=ratio)
    )
    updated, is_sound = carry(points, mesh, fill, equilibrium, column.model, column.gradient)
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


def test_collapsed_points_are_not_sound(mesh, scattered):
    column = Column(mesh, GROUNDS["elastic"])
    points = scattered(column)
    fill = fill_cells(points, mesh, CELL, cell_geometry(mesh, CELL, Kinematics.PLANE_STRAIN), 0.3)
    displacement = np.zeros_like(mesh.nodes)
    displacement[mesh.cell_nodes[4, 0]] = 3.0
    trial = SimpleNamespace(cell_volume_ratio=np.ones(len(mesh.cell_nodes)))
    equilibrium = SimpleNamespace(displacement=displacement, trial=trial)
    assert not carry(points, mesh, fill, equilibrium, column.model, column.gradient)[1]


def test_displacement_leads_from_the_start_to_the_place_of_a_point(mesh, scattered):
    """Also where a point was brought back from outside: the hand-over finds its start by it."""
    column = Column(mesh, GROUNDS["elastic"])
    points = scattered(column)
    start = points.position - points.displacement
    lowered = mesh._replace(nodes=mesh.nodes * [1.0, 1.1] - [0.0, 0.05])
    n_projected = locate(points, lowered)
    is_outside = start[:, 1] > -0.05
    assert n_projected == is_outside.sum() > 0
    np.testing.assert_allclose(points.position - points.displacement, start, atol=1e-15)


def test_results_do_not_depend_on_the_number_of_threads(mesh, clay_ground, scattered, threads):
    column = Column(mesh, clay_ground)
    points = scattered(column)
    results = []
    for n in (1, 2):
        threads(n)
        result = column.step(points, mesh, *squeeze(column, mesh, 0.005))
        assert result.is_converged
        results.append([*result.points, result.equilibrium.displacement])
    for first, second in zip(*results, strict=True):
        np.testing.assert_array_equal(first, second)


def test_mass_density_and_weight_belong_together(mesh, clay_ground):
    points = seed_points(mesh, CELL, clay_ground, 3)
    assert isinstance(points, MaterialPoints)
    np.testing.assert_allclose(points.mass * GRAVITY, 18e3 * points.volume, rtol=1e-14)
