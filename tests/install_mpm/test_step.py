"""One step: ground at rest on a moving mesh, and exact deformations in many steps."""

from dataclasses import replace

import numpy as np
import pytest

from install_mpm import carriers
from install_mpm.assembly import sparsity_pattern
from install_mpm.constitutive import coulomb_interface
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic, VonMises
from install_mpm.equilibrium import Prescribed
from install_mpm.geostatic import elastic_strain_of
from install_mpm.ground import Ground, geostatic_stress
from install_mpm.interface import InterfaceElements, InterfacePoints, facet_rule
from install_mpm.material_points import cauchy_stress
from install_mpm.mesh_motion import translate
from install_mpm.options import Numerics
from install_mpm.pile import PileMotion

GROUNDS = {
    "clay": Ground(18e3, 0.8, VonMises(4e6, 0.49, 20e3)),
    "elastic": Ground(16e3, 0.5, HenckyElastic(5e6, 0.3)),
}
every_ground = pytest.mark.parametrize("ground", GROUNDS.values(), ids=GROUNDS)


@every_ground
def test_geostatic_ground_is_in_equilibrium(make_column, ground, rng):
    column = make_column(ground)
    mesh = column.mesh
    points = column.scattered_points(rng)
    result = column.step(points, mesh)
    assert result.is_converged
    assert result.equilibrium.newton.residuals[0] < 1e-10
    assert np.abs(result.equilibrium.displacement).max() < 1e-10
    weight = result.equilibrium.reaction[:, 1].sum()
    assert weight == pytest.approx(ground.unit_weight * column.width * column.depth, rel=1e-10)
    stress = geostatic_stress(ground, points.position[:, 1], 1)
    np.testing.assert_allclose(
        result.points.kirchhoff_stress, stress, atol=1e-9 * np.abs(stress).max()
    )


@every_ground
def test_moving_the_mesh_alone_changes_nothing(make_column, ground, rng):
    """The mesh goes up and down through ground at rest; points are only carried.

    Mass is kept exactly, volume to 1e-10, the stress stays geostatic to 1e-8 of its maximum.
    """
    column = make_column(ground)
    mesh = column.mesh
    start = column.scattered_points(rng)
    points, current = start, mesh
    for advance in (0.3, 0.8, 0.2, -0.6, 0.0, 0.7):
        result = column.step(
            points,
            current,
            move_mesh=lambda mesh, a=advance: translate(mesh, a, -1.5, (-column.depth, 0.0)),
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


def test_oedometer_is_exact_in_many_steps(make_column):
    """Weightless elastic column: sigma = M ln(J) / J, the same in all points, after 5 x 8 %."""
    soil = HenckyElastic(5e6, 0.3)
    column = make_column(Ground(0.0, 1.0, soil), tolerance=1e-12)
    mesh = column.mesh
    start = column.points()
    points, current = start, mesh
    for _ in range(5):
        prescribed, follow = column.squeeze(current, 0.08)
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
    height = (start.position[:, 1] + column.depth) * ratio - column.depth
    np.testing.assert_allclose(points.position[:, 1], height, atol=1e-9)
    np.testing.assert_allclose(points.displacement, points.position - start.position, atol=1e-15)
    np.testing.assert_array_equal(points.mass, start.mass)
    top = np.abs(current.nodes[:, 1] - current.nodes[:, 1].max()) < 1e-9
    load = result.equilibrium.reaction[top, 1].sum()
    assert load == pytest.approx(expected[1, 1] * column.width, rel=1e-9)


def test_rigid_rotation_turns_the_stress(make_column, make_rotation):
    """All nodes are turned in three steps; stress and strain turn with them, the volume stays."""
    column = make_column(Ground(0.0, 1.0, HenckyElastic(5e6, 0.3)))
    mesh = column.mesh
    points = column.points()
    stress = np.array([[-20e3, 5e3, 0.0], [5e3, -60e3, 0.0], [0.0, 0.0, -10e3]])
    stress = np.tile(stress, (len(points.mass), 1, 1))
    points = points._replace(
        kirchhoff_stress=stress,
        elastic_log_strain=elastic_strain_of(column.ground.soil, stress, points.state_variables),
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


def test_step_leaves_its_input_alone(make_column, clay_ground, rng):
    column = make_column(clay_ground)
    mesh = column.mesh
    points = column.scattered_points(rng)
    inputs = [*points, mesh.nodes]
    before = [field.copy() for field in inputs]
    result = column.step(points, mesh, *column.squeeze(mesh, 0.01))
    assert result.is_converged
    for field, expected in zip(inputs, before, strict=True):
        np.testing.assert_array_equal(field, expected)


def test_points_are_admissible_and_consistent_after_a_plastic_step(make_column, clay_ground, rng):
    column = make_column(clay_ground)
    mesh = column.mesh
    points = column.scattered_points(rng)
    prescribed, follow = column.squeeze(mesh, 0.0)
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
    expected = elastic_strain_of(clay_ground.soil, points.kirchhoff_stress, points.state_variables)
    np.testing.assert_allclose(points.elastic_log_strain, expected, atol=1e-14)


def test_step_without_convergence_gives_back_the_start(make_column, clay_ground, rng):
    column = make_column(clay_ground)
    mesh = column.mesh
    points = column.scattered_points(rng)
    column.model = column.model._replace(
        numerics=Numerics(tolerance=1e-12, max_iterations=3),
        solve=lambda values, load, is_prescribed=None, inner_tolerance=0.0: 1e-6 * load,
    )
    prescribed, follow = column.squeeze(mesh, 0.02)
    result = column.step(points, mesh, prescribed, follow)
    assert not result.is_converged
    for field, expected in zip(result.points, points, strict=True):
        np.testing.assert_array_equal(field, expected)
    assert result.mesh is mesh


def test_crushed_cells_are_a_failed_step(make_column, clay_ground):
    """The driven top passes its neighbours: no exception, and nothing to undo."""
    column = make_column(clay_ground)
    mesh = column.mesh
    points = column.points()
    assert not column.step(points, mesh, *column.squeeze(mesh, 0.4)).is_converged


@pytest.mark.parametrize("leads_nowhere", ["turned inside out", "shaken"])
def test_step_begins_again_from_rest(make_column, clay_ground, leads_nowhere):
    """Ground at rest is in equilibrium: the second start ends where it begins."""
    column = make_column(clay_ground)
    nodes = column.mesh.nodes
    far = -2.0 * nodes if leads_nowhere == "turned inside out" else 0.02 * np.sin(40.0 * nodes)
    numerics = replace(column.model.numerics, second_start=True)
    column.model = column.model._replace(numerics=numerics)
    result = column.step(column.points(), column.mesh, start=np.where(column.supports, 0.0, far))
    assert result.is_converged
    residuals = result.equilibrium.newton.residuals
    assert np.isfinite(residuals).all()
    attempt, at_rest = residuals[:-1], residuals[-1]
    assert at_rest < 1e-9
    assert len(attempt) < 6
    assert (np.diff(attempt[:-1]) < 0.0).all()  # it ends with the first correction that is worse
    assert np.abs(result.equilibrium.displacement).max() < 1e-8


def test_results_do_not_depend_on_the_number_of_threads(make_column, clay_ground, rng, threads):
    column = make_column(clay_ground)
    mesh = column.mesh
    points = column.scattered_points(rng)
    results = []
    for n in (1, 2):
        threads(n)
        result = column.step(points, mesh, *column.squeeze(mesh, 0.005))
        assert result.is_converged
        results.append([*result.points, result.equilibrium.displacement])
    for first, second in zip(*results, strict=True):
        np.testing.assert_array_equal(first, second)


def test_nodal_force_acts_as_the_weight_does(make_column):
    """A force on the top of a weightless elastic column arrives at the base, and squeezes it."""
    column = make_column(Ground(0.0, 1.0, HenckyElastic(5e6, 0.0)), tolerance=1e-12)
    mesh = column.mesh
    top = mesh.nodes[:, 1].max()
    force = np.zeros_like(mesh.nodes)
    for x, share in ((0.0, 1 / 6), (0.25, 2 / 3), (0.5, 1 / 3), (0.75, 2 / 3), (1.0, 1 / 3),
                     (1.25, 2 / 3), (1.5, 1 / 6)):  # fmt: skip
        node = np.argmin(np.linalg.norm(mesh.nodes - [x, top], axis=1))
        force[node, 1] = -1e3 * 0.5 * share
    prescribed = Prescribed(column.supports, np.zeros_like(mesh.nodes), force)
    result = column.step(column.points(), mesh, prescribed)
    assert result.is_converged
    assert result.equilibrium.reaction[:, 1].sum() == pytest.approx(1.5e3, rel=1e-10)
    stress = cauchy_stress(result.points)
    np.testing.assert_allclose(stress[:, 1, 1], -1e3, rtol=1e-9)


def test_weight_of_points_is_that_of_the_body(make_column, clay_ground, rng):
    """Cells of scattered points weigh what the points weigh, cell by cell."""
    column = make_column(clay_ground)
    points = column.points()
    points = points._replace(mass=points.mass * rng.uniform(0.5, 1.5, len(points.mass)))
    model = column.model._replace(has_weight_of_points=True)
    quadrature = carriers.give_state(points, column.mesh, model, column.gradient).quadrature
    weight = (quadrature.density * quadrature.volume).reshape(len(column.mesh.cell_nodes), -1)
    expected = np.bincount(points.cell, points.mass, len(weight))
    np.testing.assert_allclose(weight.sum(axis=1), expected, rtol=1e-12)


def test_turning_pile_slides_without_a_gap(make_column, elastic_ground):
    """Points on a circle about the origin, soil held: the pressure stays, the chord is the slip."""
    column, angle, radius = make_column(elastic_ground), 0.3, 0.5
    mesh = column.mesh
    direction = np.array([0.2, 1.0, 2.0])
    normal = -np.column_stack([np.cos(direction), np.sin(direction)])
    law = CoulombInterface(1e8, 1e7, cohesion=1e12)
    elements = InterfaceElements(
        mesh.cell_nodes[:1, [0, 1, 3]], np.zeros(1, dtype=np.int64), *facet_rule(3, 3)
    )
    column.model = column.model._replace(
        elements=elements,
        pattern=sparsity_pattern([mesh.cell_nodes, elements.nodes], len(mesh.nodes), 2),
    )
    interface = InterfacePoints(
        position=-radius * normal,
        normal=normal,
        area=elements.weights,
        traction=np.tile([0.0, -5e3], (3, 1)),
        parameters=coulomb_interface.pack(law, np.zeros(3)),
        part=np.zeros(3, dtype=np.int64),
        covered=np.ones(3),
    )
    column.interface, column.motion = interface, PileMotion(np.zeros(2), angle)
    everything = np.ones(mesh.nodes.shape, dtype=bool)
    result = column.step(column.points(), mesh, Prescribed(everything, 0.0 * mesh.nodes))
    assert result.is_converged
    chord = 2.0 * radius * np.sin(angle / 2.0)
    expected = np.tile([-1e7 * chord, -5e3], (3, 1))  # the tangent points clockwise here
    np.testing.assert_allclose(result.interface.traction, expected, rtol=1e-9)
