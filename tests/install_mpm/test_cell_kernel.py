"""Force and stiffness of the cells: plain arithmetic, differences, and exact states of stress."""

from types import SimpleNamespace

import numpy as np
import pytest

from install_mpm.cell_fill import cell_geometry
from install_mpm.cells import CellType, reference_cell
from install_mpm.constitutive import dispatch
from install_mpm.constitutive.parameters import HenckyElastic, VonMises
from install_mpm.conventions import Kinematics
from install_mpm.integration_points import IntegrationPoints, empty_trial
from install_mpm.kernels.cell_records import COLLAPSED, CellOptions
from install_mpm.kernels.equilibrium import evaluate_cells

MODULUS = 1e3
SOILS = {"elastic": HenckyElastic(MODULUS, 0.3), "plastic": VonMises(MODULUS, 0.3, 2.0)}
STRAIN_OUT_OF_PLANE = 0.02

OPTIONS = {
    "plain": {},
    "mean dilatation": {"mean": True},
    "volumetric term": {"mean": True, "volumetric": 200.0},
    "soft": {"soft": 3.0},
    "soft, held in rotation too": {"soft": 3.0, "moment_free": False},
    "all terms": {"mean": True, "volumetric": 200.0, "soft": 3.0},
    "small strain": {"finite": False, "soft": 3.0},
    "axisymmetric": {"axisymmetric": True},
    "axisymmetric, all terms": {
        "axisymmetric": True,
        "mean": True,
        "volumetric": 200.0,
        "soft": 3.0,
    },
    "axisymmetric, small strain": {"axisymmetric": True, "finite": False, "soft": 3.0},
}
every_option = pytest.mark.parametrize("option", OPTIONS)
every_soil = pytest.mark.parametrize("soil", SOILS)


@pytest.fixture
def mesh(make_grid):
    grid = make_grid(2, 2, distortion=0.3, width=2.0, depth=1.5)
    return grid._replace(nodes=grid.nodes + np.array([0.5, 0.0]))  # away from the axis


def kinematics_of(options):
    return Kinematics.AXISYMMETRIC if options.is_axisymmetric else Kinematics.PLANE_STRAIN


def integration_points(mesh, rng, soil, *, random_start=True, kinematics=Kinematics.PLANE_STRAIN):
    """Integration points of all cells; volumes, strains and J differ from point to point."""
    cell = reference_cell(CellType.TRI6)
    geometry = cell_geometry(mesh, cell, kinematics)
    n_cells, n_points = len(mesh.cell_nodes), 3 * len(mesh.cell_nodes)
    strain = rng.normal(size=(n_points, 3, 3)) * (0.01 if random_start else 0.0)
    strain = (strain + strain.transpose(0, 2, 1)) / 2.0
    return IntegrationPoints(
        cell_start=np.arange(n_cells + 1) * 3,
        reference_coordinates=np.tile(cell.integration_coordinates, (n_cells, 1)),
        shape_values=geometry.shape_values.reshape(n_points, 6),
        shape_gradients=geometry.shape_gradients.reshape(n_points, 6, 2),
        hoop_gradients=geometry.hoop_gradients.reshape(n_points, 6),
        volume=geometry.integration_volume.ravel()
        * (rng.uniform(0.5, 1.0, n_points) if random_start else 1.0),
        density=np.ones(n_points),
        volume_ratio=rng.uniform(0.9, 1.1, n_points) if random_start else np.ones(n_points),
        elastic_log_strain=strain,
        state_variables=dispatch.initial_state(
            soil, np.zeros(n_points), np.zeros((n_points, 3, 3))
        ),
        material=np.zeros(n_points, dtype=np.int64),
    )


def cell_options(
    n_cells, *, finite=True, mean=False, axisymmetric=False, moment_free=True, volumetric=0.0,
    soft=0.0,
):  # fmt: skip
    return CellOptions(
        finite, mean, axisymmetric, moment_free, np.full(n_cells, volumetric),
        np.full(n_cells, soft),
    )  # fmt: skip


def evaluate(mesh, points, soil, displacement, options, is_active=None):
    """Force, stiffness and trial state of all cells."""
    n_cells = len(mesh.cell_nodes)
    force, stiffness = np.full((n_cells, 6, 2), np.nan), np.full((n_cells, 6, 2, 6, 2), np.nan)
    trial = empty_trial(points)
    active = np.ones(n_cells, dtype=bool) if is_active is None else is_active
    evaluate_cells(
        mesh.cell_nodes, active, points, displacement, dispatch.pack([soil]), options, force,
        stiffness, trial,
    )  # fmt: skip
    return SimpleNamespace(force=force, stiffness=stiffness, trial=trial)


def kirchhoff_stress(soil, trial):
    """Radial return written with tensors."""
    bulk = soil.youngs_modulus / (3.0 * (1.0 - 2.0 * soil.poissons_ratio))
    shear = soil.youngs_modulus / (2.0 * (1.0 + soil.poissons_ratio))
    deviator = 2.0 * shear * (trial - np.trace(trial) / 3.0 * np.eye(3))
    if isinstance(soil, VonMises):
        radius = np.sqrt(2.0) * soil.undrained_shear_strength
        deviator *= min(1.0, radius / max(np.linalg.norm(deviator), 1e-300))
    return bulk * np.trace(trial) * np.eye(3) + deviator


def of_tensor(function, tensor):
    """Apply a function to the eigenvalues of a symmetric tensor."""
    values, vectors = np.linalg.eigh(tensor)
    return vectors @ np.diag(function(values)) @ vectors.T


def soft_force(gradients, hoop, increments, options, c):
    """Force of the soft stress: F S G with S = k (F^T F - 1), or its linear part; or 2 k H G."""
    if not options.has_moment_free_soft_stress:
        force = 2.0 * np.einsum("qij,qaj->ai", (increments - np.eye(3))[:, :2, :2], gradients)
        return options.soft_stiffness[c] * force
    if options.is_finite_strain:
        strain = increments.transpose(0, 2, 1) @ increments - np.eye(3)
        first = increments @ strain
    else:
        first = increments + increments.transpose(0, 2, 1) - 2.0 * np.eye(3)
    force = np.einsum("qij,qaj->ai", first[:, :2, :2], gradients)
    if options.is_axisymmetric:
        force[:, 0] += first[:, 2, 2] @ hoop
    return options.soft_stiffness[c] * force


def reference_cell_force(c, mesh, points, soil, displacement, options):
    """Force on the nodes of cell ``c``, straight from the equations of the method."""
    own = slice(points.cell_start[c], points.cell_start[c + 1])
    gradients, volume = points.shape_gradients[own], points.volume[own]
    hoop, n_axes = points.hoop_gradients[own], 3 if options.is_axisymmetric else 2
    nodal = displacement[mesh.cell_nodes[c]]
    increments = np.tile(np.eye(3), (3, 1, 1))
    increments[:, :2, :2] += np.einsum("ai,qaj->qij", nodal, gradients)
    increments[:, 2, 2] += hoop @ nodal[:, 0]
    soft = soft_force(gradients, hoop, increments, options, c)
    if not options.is_finite_strain:
        small = (increments + increments.transpose(0, 2, 1)) / 2.0 - np.eye(3)
        stress = [kirchhoff_stress(soil, e) for e in points.elastic_log_strain[own] + small]
        force = np.einsum("q,qij,qaj->ai", volume, np.array(stress)[:, :2, :2], gradients) + soft
        force[:, 0] += np.einsum("q,q,qa->a", volume, np.array(stress)[:, 2, 2], hoop)
        return force
    ratio = np.linalg.det(increments)
    mean_ratio = volume @ ratio / volume.sum() if options.has_mean_dilatation else ratio
    scaled = increments.copy()
    scaled[:, :n_axes] *= ((mean_ratio / ratio) ** (1.0 / n_axes))[:, None, None]
    current_hoop = hoop / increments[:, 2, 2, None]
    current = np.einsum("qaj,qji->qai", gradients, np.linalg.inv(increments)[:, :2, :2])
    total_ratio = points.volume_ratio[own] * mean_ratio * np.ones(3)
    force = soft
    for q in range(3):
        strain = points.elastic_log_strain[own][q]
        pushed = scaled[q] @ of_tensor(np.exp, 2.0 * strain) @ scaled[q].T
        stress = kirchhoff_stress(soil, of_tensor(np.log, pushed) / 2.0) / total_ratio[q]
        force = force + volume[q] * ratio[q] * current[q] @ stress[:2, :2]
        force[:, 0] += volume[q] * ratio[q] * stress[2, 2] * current_hoop[q]
    if options.has_mean_dilatation:
        divergence = current.copy()
        divergence[:, :, 0] += current_hoop
        mean = np.einsum("q,qai->ai", volume * ratio, divergence) / (volume @ ratio)
        pressure = options.volumetric_term[c] * volume * np.log(ratio / mean_ratio)
        force = force + np.einsum("q,qai->ai", pressure, divergence - mean)
    return force


@every_option
@every_soil
def test_force_equals_plain_arithmetic(option, soil, mesh, rng):
    options = cell_options(len(mesh.cell_nodes), **OPTIONS[option])
    points = integration_points(mesh, rng, SOILS[soil], kinematics=kinematics_of(options))
    displacement = 0.03 * rng.normal(size=mesh.nodes.shape)
    result = evaluate(mesh, points, SOILS[soil], displacement, options)
    assert not result.trial.status.any()
    for c in range(len(mesh.cell_nodes)):
        expected = reference_cell_force(c, mesh, points, SOILS[soil], displacement, options)
        np.testing.assert_allclose(result.force[c], expected, atol=1e-12 * MODULUS)


@every_option
@every_soil
def test_stiffness_is_the_derivative_of_the_force(option, soil, mesh, rng):
    options = cell_options(len(mesh.cell_nodes), **OPTIONS[option])
    points = integration_points(mesh, rng, SOILS[soil], kinematics=kinematics_of(options))
    displacement = 0.03 * rng.normal(size=mesh.nodes.shape)
    result = evaluate(mesh, points, SOILS[soil], displacement, options)
    assert not result.trial.status.any()
    if soil == "plastic":
        assert (result.trial.state_variables[:, 1] > 1e-3).all()
    step, scale = 1e-6, np.abs(result.stiffness).max()
    for node, i in np.ndindex(*mesh.nodes.shape):
        nudge = np.zeros_like(displacement)
        nudge[node, i] = step
        ends = [
            evaluate(mesh, points, SOILS[soil], displacement + sign * nudge, options).force
            for sign in (1.0, -1.0)
        ]
        derivative = (ends[0] - ends[1]) / (2.0 * step)
        for c, b in np.argwhere(mesh.cell_nodes == node):
            column = result.stiffness[c, :, :, b, i]
            np.testing.assert_allclose(column, derivative[c], atol=1e-6 * scale)


@pytest.mark.parametrize("mean", [False, True])
def test_uniform_stress_gives_the_traction_on_the_boundary(mean, mesh, rng):
    """Start states are chosen such that sigma is uniform after an arbitrary deformation.

    Then the force of every cell is the traction sigma n on its (curved) boundary, to round-off.
    """
    soil = SOILS["elastic"]
    stress = np.array([[3.0, 1.5, 0.0], [1.5, -8.0, 0.0], [0.0, 0.0, 2.0]])
    points = integration_points(mesh, rng, soil, random_start=False)
    displacement = 0.03 * rng.normal(size=mesh.nodes.shape)
    shear = soil.youngs_modulus / (2.0 * (1.0 + soil.poissons_ratio))
    bulk = soil.youngs_modulus / (3.0 * (1.0 - 2.0 * soil.poissons_ratio))
    pressure = np.trace(stress) / 3.0
    target = (stress - pressure * np.eye(3)) / (2.0 * shear) + pressure / (3.0 * bulk) * np.eye(3)
    for c, nodes in enumerate(mesh.cell_nodes):
        own = slice(3 * c, 3 * c + 3)
        gradients = points.shape_gradients[own]
        increments = np.tile(np.eye(3), (3, 1, 1))
        increments[:, :2, :2] += np.einsum("ai,qaj->qij", displacement[nodes], gradients)
        ratio = np.linalg.det(increments)
        if mean:
            increments[:, :2] *= np.sqrt(ratio.mean() / ratio)[:, None, None]
            ratio = np.full(3, ratio.mean())
        inverse = np.linalg.inv(increments)
        pulled = inverse @ of_tensor(np.exp, 2.0 * target) @ inverse.transpose(0, 2, 1)
        points.elastic_log_strain[own] = [of_tensor(np.log, tensor) / 2.0 for tensor in pulled]
        points.volume_ratio[own] = 1.0 / ratio
    options = cell_options(len(mesh.cell_nodes), mean=mean)
    result = evaluate(mesh, points, soil, displacement, options)
    moved = mesh.nodes + displacement
    np.testing.assert_allclose(result.trial.cauchy_stress, np.tile(stress, (24, 1, 1)), atol=1e-10)
    for c, nodes in enumerate(mesh.cell_nodes):
        expected = boundary_force(moved[nodes], stress[:2, :2])
        np.testing.assert_allclose(result.force[c], expected, atol=1e-11)


def boundary_force(corners, stress):
    """Integral of N sigma n along the three quadratic edges of a six-node triangle."""
    force = np.zeros((6, 2))
    abscissae, weights = np.polynomial.legendre.leggauss(3)
    for edge in range(3):
        local = [edge, (edge + 1) % 3, 3 + edge]
        for xi, weight in zip(abscissae, weights, strict=True):
            values = np.array([xi * (xi - 1.0) / 2.0, xi * (xi + 1.0) / 2.0, 1.0 - xi**2])
            slope = np.array([xi - 0.5, xi + 0.5, -2.0 * xi]) @ corners[local]
            normal = np.array([slope[1], -slope[0]])  # outward, with the length of the edge
            force[local] += weight * np.outer(values, stress @ normal)
    return force


@every_soil
def test_rigid_motion_turns_stress_and_force(soil, mesh, rng, make_rotation):
    points = integration_points(mesh, rng, SOILS[soil])
    options = cell_options(len(mesh.cell_nodes), mean=True, volumetric=200.0, soft=100.0)
    at_rest = evaluate(mesh, points, SOILS[soil], np.zeros_like(mesh.nodes), options)
    turn = make_rotation(2)
    motion = mesh.nodes @ (turn[:2, :2] - np.eye(2)).T + [3.0, -2.0]
    moved = evaluate(mesh, points, SOILS[soil], motion, options)
    scale = np.abs(at_rest.trial.cauchy_stress).max()
    expected = turn @ at_rest.trial.cauchy_stress @ turn.T
    np.testing.assert_allclose(moved.trial.cauchy_stress, expected, atol=1e-12 * scale)
    np.testing.assert_allclose(moved.force, at_rest.force @ turn[:2, :2].T, atol=1e-12 * scale)
    np.testing.assert_allclose(moved.trial.cell_volume_ratio, 1.0, atol=1e-14)
    np.testing.assert_array_equal(moved.trial.status, 0)


def test_force_of_a_cell_sums_to_zero(mesh, rng):
    points = integration_points(mesh, rng, SOILS["plastic"])
    options = cell_options(len(mesh.cell_nodes), mean=True, volumetric=200.0, soft=1.0)
    displacement = 0.03 * rng.normal(size=mesh.nodes.shape)
    force = evaluate(mesh, points, SOILS["plastic"], displacement, options).force
    np.testing.assert_allclose(force.sum(axis=1), 0.0, atol=1e-12 * MODULUS)


def test_force_of_a_cell_has_no_moment_about_the_current_positions(mesh, rng):
    """Also with the terms of the step only, and with points of a cell that hold no soil."""
    points = integration_points(mesh, rng, SOILS["plastic"])
    points.volume[4] = 0.0
    options = cell_options(len(mesh.cell_nodes), mean=True, volumetric=200.0, soft=100.0)
    displacement = 0.03 * rng.normal(size=mesh.nodes.shape)
    force = evaluate(mesh, points, SOILS["plastic"], displacement, options).force
    place = (mesh.nodes + displacement)[mesh.cell_nodes]
    moments = place[:, :, 0] * force[:, :, 1] - place[:, :, 1] * force[:, :, 0]
    np.testing.assert_allclose(moments.sum(axis=1), 0.0, atol=1e-13 * np.abs(moments).sum())


def test_mean_dilatation_gives_every_point_the_volume_change_of_its_cell(mesh, rng):
    points = integration_points(mesh, rng, SOILS["elastic"], random_start=False)
    options = cell_options(len(mesh.cell_nodes), mean=True)
    displacement = 0.03 * rng.normal(size=mesh.nodes.shape)
    trial = evaluate(mesh, points, SOILS["elastic"], displacement, options).trial
    trace = np.trace(trial.elastic_log_strain, axis1=1, axis2=2)
    np.testing.assert_allclose(trace, np.log(np.repeat(trial.cell_volume_ratio, 3)), atol=1e-13)


def test_inactive_cells_and_empty_points_do_nothing(mesh, rng):
    points = integration_points(mesh, rng, SOILS["elastic"])
    points.volume[4] = 0.0
    options = cell_options(len(mesh.cell_nodes), mean=True, volumetric=200.0)
    is_active = np.arange(8) != 2
    displacement = 0.03 * rng.normal(size=mesh.nodes.shape)
    result = evaluate(mesh, points, SOILS["elastic"], displacement, options, is_active)
    assert not result.force[2].any()
    assert not result.stiffness[2].any()
    reduced = points._replace(cell_start=points.cell_start - (np.arange(9) > 1))
    reduced = reduced._replace(
        **{
            name: np.delete(getattr(points, name), 4, axis=0)
            for name in IntegrationPoints._fields
            if name != "cell_start"
        }
    )
    expected = evaluate(mesh, reduced, SOILS["elastic"], displacement, options, is_active)
    np.testing.assert_array_equal(result.force, expected.force)
    np.testing.assert_array_equal(result.stiffness, expected.stiffness)


def test_collapsed_cell_is_reported(mesh, rng):
    points = integration_points(mesh, rng, SOILS["elastic"])
    displacement = np.zeros_like(mesh.nodes)
    displacement[mesh.cell_nodes[1, 0]] = 5.0
    options = cell_options(len(mesh.cell_nodes), mean=True)
    status = evaluate(mesh, points, SOILS["elastic"], displacement, options).trial.status
    assert status[1] == COLLAPSED
    untouched = ~(mesh.cell_nodes == mesh.cell_nodes[1, 0]).any(axis=1)
    assert not status[untouched].any()


def test_start_state_is_not_changed(mesh, rng):
    points = integration_points(mesh, rng, SOILS["plastic"])
    before = [np.array(field) for field in points]
    options = cell_options(len(mesh.cell_nodes), mean=True, volumetric=200.0)
    evaluate(mesh, points, SOILS["plastic"], 0.03 * rng.normal(size=mesh.nodes.shape), options)
    for field, expected in zip(points, before, strict=True):
        np.testing.assert_array_equal(field, expected)


def test_results_do_not_depend_on_the_number_of_threads(make_grid, rng, threads):
    mesh = make_grid(9, 8, distortion=0.2)
    points = integration_points(mesh, rng, SOILS["plastic"])
    options = cell_options(len(mesh.cell_nodes), mean=True, volumetric=200.0)
    displacement = 0.005 * rng.normal(size=mesh.nodes.shape)
    results = []
    for n in (1, 2):
        threads(n)
        results.append(evaluate(mesh, points, SOILS["plastic"], displacement, options))
    np.testing.assert_array_equal(results[0].force, results[1].force)
    np.testing.assert_array_equal(results[0].stiffness, results[1].stiffness)
    for first, second in zip(results[0].trial, results[1].trial, strict=True):
        np.testing.assert_array_equal(first, second)
