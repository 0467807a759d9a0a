"""The model in space: patch test, balance, rigid motion, a slab against plane strain."""

import numpy as np
import pytest

from handoff.fe_mesh import FacetTag, FEMesh
from install_mpm.background_mesh import facet_edge_nodes, facets_opposite_vertices
from install_mpm.constitutive.mandel import COLUMN, ROW, SCALE
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic, VonMises
from install_mpm.conventions import Kinematics
from install_mpm.ground import Ground
from service_fe.interface_forms import InterfaceForms
from service_fe.options import (
    Cycles,
    Displace,
    Lateral,
    Load,
    Release,
    Resume,
    Rotate,
    ServiceNumerics,
)
from service_fe.problem import ServiceProblem
from service_fe.rigid_pile import PileControl, head_frame, held, moved, rigid_motion
from service_fe.soil_forms import SoilForms
from service_fe.solve import run
from workflows.verification.solid_meshes import box_mesh, extruded, grid, quadratic_mesh

pytestmark = pytest.mark.dolfinx

SPACE = Kinematics.THREE_D
ELASTIC = HenckyElastic(5e6, 0.3)
CLAY = VonMises(youngs_modulus=4e6, poissons_ratio=0.45, undrained_shear_strength=20e3)
ROUGH = CoulombInterface(normal_stiffness=2e8, shear_stiffness=2e7, adhesion_factor=0.5)
SIZE, HALF, TIP = 2.0, 0.4, 0.8
FULL = ServiceNumerics(mean_dilatation=False)
"""Every point of a cell has its own change of volume."""

NORMALS = {0: (0, 0, 1), 1: (-1, 0, 0), 2: (1, 0, 0), 3: (0, -1, 0), 4: (0, 1, 0)}


def fe_mesh(mesh, tag_of):
    """FEMesh of a background mesh; ``tag_of(centres)`` names the boundary facets."""
    cell, facet = np.argwhere(mesh.cell_neighbours < 0).T
    vertices = facets_opposite_vertices(mesh.cell_nodes[:, :4])[cell, facet]
    nodes = np.hstack([vertices, facet_edge_nodes(mesh, cell, facet)])
    return FEMesh(mesh.nodes, mesh.cell_nodes, nodes, tag_of(mesh.nodes[vertices].mean(axis=1)))


def outer_tags(centres):
    tags = np.full(len(centres), int(FacetTag.SIDE))
    tags[np.abs(centres[:, 2]) < 1e-9] = FacetTag.SURFACE
    tags[np.abs(centres[:, 2] + SIZE) < 1e-9] = FacetTag.BOTTOM
    return tags


def square_pile_tags(centres):
    """Of a square pile around the axis, one part for its base and each of its four sides."""
    tags = outer_tags(centres)
    x, y, z = centres.T
    inside = (np.maximum(np.abs(x), np.abs(y)) < HALF + 1e-9) & (z > -TIP - 1e-9) & (z < -1e-9)
    tags[inside & (np.abs(z + TIP) < 1e-9)] = 0
    for part, (axis, side) in enumerate(((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)), start=1):
        tags[inside & (np.abs(centres[:, axis] - side * HALF) < 1e-9)] = part
    return tags


def square_normals(facets):
    return np.array([NORMALS[number] for number in facets.parts], dtype=float).reshape(-1, 3)


@pytest.fixture(scope="module")
def cube():
    lines = [np.array([-1.0, -0.3, 1.0]), np.array([-1.0, 0.2, 1.0]), np.array([-2.0, -0.9, 0.0])]
    return fe_mesh(box_mesh(*lines), outer_tags)


def square_pile_mesh():
    """A square pile of 0.8 m, 0.8 m deep, in a cube of 2 m."""
    across = np.array([-1.0, -HALF, 0.0, HALF, 1.0])
    solid = extruded(grid(across, across), np.array([-SIZE, -1.3, -TIP, -0.4, 0.0]))
    x, y, z = solid.centroids.T
    is_pile = (np.maximum(np.abs(x), np.abs(y)) < HALF) & (z > -TIP)
    return fe_mesh(quadratic_mesh(solid, ~is_pile), square_pile_tags)


@pytest.fixture(scope="module")
def pile_mesh():
    return square_pile_mesh()


@pytest.fixture(scope="module")
def problem(pile_mesh):
    ground = Ground(unit_weight=18e3, k0=0.8, soil=CLAY)
    numerics = ServiceNumerics(tolerance=1e-10)
    return ServiceProblem(
        pile_mesh, ground, ROUGH, 1e3, numerics, kinematics=SPACE, normals=square_normals
    )


@pytest.fixture(scope="module")
def undisturbed(problem):
    return problem.wished_in_place_state()


def test_patch_of_elastic_soil_takes_a_linear_displacement(cube):
    """All boundary nodes move linearly: so do those inside, and the stress is uniform."""
    ground = Ground(0.0, 1.0, ELASTIC)
    on_boundary = np.zeros(cube.nodes.shape, dtype=bool)
    on_boundary[np.unique(cube.facet_nodes)] = True
    problem = ServiceProblem(cube, ground, ROUGH, kinematics=SPACE, is_fixed=on_boundary)
    gradient = 1e-3 * np.random.default_rng(1).normal(size=(3, 3))
    exact = cube.nodes @ gradient.T
    step = problem.solve(problem.wished_in_place_state(), held(3), support_motion=exact)
    assert not on_boundary.all()
    np.testing.assert_allclose(step.increment.displacement, exact, atol=1e-12)
    strain = 0.5 * (gradient + gradient.T)
    lame = 5e6 * 0.3 / (1.3 * 0.4)
    stress = 2.0 * 5e6 / 2.6 * strain + lame * np.trace(strain) * np.eye(3)
    np.testing.assert_allclose(
        step.state.cauchy_stress, np.broadcast_to(stress, step.state.cauchy_stress.shape), rtol=1e-9
    )


def test_strain_and_volume_of_a_tetrahedral_mesh(cube):
    ground = Ground(0.0, 1.0, ELASTIC)
    problem = ServiceProblem(cube, ground, ROUGH, numerics=FULL, kinematics=SPACE)
    assert problem.integration_volumes.sum() == pytest.approx(8.0, rel=1e-12)
    x, y, z = problem.integration_positions.T
    nodes = cube.nodes
    displacement = np.column_stack([nodes[:, 1] * nodes[:, 2], nodes[:, 0] ** 2, nodes[:, 2] ** 2])
    gradient = np.zeros((len(x), 3, 3))
    gradient[:, 0, 1], gradient[:, 0, 2], gradient[:, 1, 0], gradient[:, 2, 2] = z, y, 2 * x, 2 * z
    strain = 0.5 * (gradient + gradient.transpose(0, 2, 1))
    np.testing.assert_allclose(
        problem.model.soil.strain(displacement), strain[:, ROW, COLUMN] * SCALE, atol=1e-12
    )


def test_all_points_of_a_cell_have_its_mean_dilatation(cube):
    """Beside their own shear strain; of a linear displacement nothing changes."""
    full, mean = SoilForms(cube), SoilForms(cube, mean_dilatation=True)
    displacement = np.random.default_rng(3).normal(size=cube.nodes.shape)
    own, found = (soil.strain(displacement).reshape(-1, 4, 6) for soil in (full, mean))
    growth = own[:, :, :3].sum(axis=2)
    assert np.ptp(growth, axis=1).max() > 1.0
    expected = own.copy()
    expected[:, :, :3] += (growth.mean(axis=1, keepdims=True) - growth)[:, :, None] / 3.0
    np.testing.assert_allclose(found, expected, atol=1e-12)
    linear = cube.nodes @ np.arange(9.0).reshape(3, 3)
    np.testing.assert_allclose(mean.strain(linear), full.strain(linear), atol=1e-12)


def test_undrained_block_does_not_lock():
    """A corner pressed into a block that hardly changes its volume, on two meshes.

    Without mean dilatation the coarse block is far stiffer than the fine one, with it hardly.
    """
    stiffness = {}
    for name, numerics in (("full", FULL), ("mean", ServiceNumerics())):
        stiffness[name] = [corner_stiffness(n_cells, numerics) for n_cells in (2, 4)]
    full, mean = (coarse / fine for coarse, fine in (stiffness["full"], stiffness["mean"]))
    assert stiffness["full"][1] > stiffness["mean"][1]
    assert full > 1.0 + 2.0 * abs(mean - 1.0)


def corner_stiffness(n_cells, numerics):
    """Force in N per m that presses a quarter of the top of a block of 1 m into it."""
    lines = np.linspace(0.0, 1.0, n_cells + 1)
    mesh = fe_mesh(box_mesh(lines, lines, lines - 1.0), lambda centres: np.full(len(centres), -1))
    x, y, z = mesh.nodes.T
    is_fixed = np.stack([(x == 0.0) | (x == 1.0), (y == 0.0) | (y == 1.0), z == -1.0], axis=1)
    is_pressed = (z == 0.0) & (x <= 0.5) & (y <= 0.5)
    is_fixed[is_pressed] = True
    problem = ServiceProblem(
        mesh, Ground(0.0, 1.0, HenckyElastic(1e6, 0.4999)), ROUGH, numerics=numerics,
        kinematics=SPACE, is_fixed=is_fixed,
    )  # fmt: skip
    motion = np.where(is_pressed, -1e-3, 0.0)[:, None] * [0.0, 0.0, 1.0]
    step = problem.solve(problem.wished_in_place_state(), held(3), support_motion=motion)
    return -step.support_reaction[is_pressed, 2].sum() / 1e-3


def test_undisturbed_ground_is_in_balance(problem, undisturbed):
    assert problem.out_of_balance(undisturbed) < 1e-14
    step = problem.solve(undisturbed, held(3))
    assert step.residuals[-1] < 1e-12
    assert np.abs(step.increment.displacement).max() < 1e-12


def test_uniform_traction_on_the_pile_has_exact_resultants(pile_mesh, problem):
    forces = InterfaceForms(pile_mesh, SPACE, square_normals)
    assert forces.areas.sum() == pytest.approx(4 * 0.8 * TIP + 0.8**2, rel=1e-12)
    traction = np.zeros((len(forces.areas), 3))
    traction[:, 2] = -100.0
    soil, pile = forces.forces(traction)
    np.testing.assert_allclose(pile, [0.0, 0.0, -100.0 * 0.64, 0.0, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(soil.sum(axis=0), -pile[:3], atol=1e-9)


def test_rigid_motion_of_soil_and_pile_together_strains_no_interface(pile_mesh):
    forces = InterfaceForms(pile_mesh, SPACE, square_normals)
    motion = np.array([0.1, -0.2, 0.3, 0.02, -0.01, 0.03])
    soil = rigid_motion(pile_mesh.nodes) @ motion
    assert np.abs(forces.relative_displacement(soil, motion)).max() < 1e-14


@pytest.mark.parametrize("is_loaded", [(0,) * 6, (0, 0, 1, 0, 0, 1), (1,) * 6])
def test_tangent_of_the_complete_model_against_finite_differences(problem, undisturbed, is_loaded):
    """With new factors, so that the direction is exact."""
    from service_fe.load_step import LoadStep
    from service_fe.step import Unknowns

    pushed = problem.solve(undisturbed, moved(0.01, 3)).state
    motion = np.array([1e-3, -2e-3, 1e-3, 1e-3, 2e-3, -1e-3])
    load = np.array([5e3, -3e3, 3e4, 2e3, 1e3, -1e3])
    control = PileControl(np.array(is_loaded, dtype=bool), motion, load, head_frame(1.0, 0.4))
    gravity = problem.gravity(pushed)
    step = LoadStep(problem.model, pushed, control, np.zeros_like(gravity), gravity)
    random = np.random.default_rng(0)
    free = ~problem.model.is_fixed
    unknowns = Unknowns(1e-4 * random.normal(size=free.shape) * free, 1e-3 * random.normal(size=6))
    trial = step.evaluate(unknowns)
    problem.model.solver.forget()
    direction = step.search_direction(trial)
    size = 1e-6
    ahead, behind = (step._evaluate_along(trial, direction, s * size) for s in (1.0, -1.0))
    slope = (ahead.out_of_balance - behind.out_of_balance) / (2.0 * size)
    expected = -trial.out_of_balance
    prescribed = np.concatenate([np.zeros(free.size, dtype=bool), ~np.array(is_loaded, bool)])
    fixed = np.concatenate([~free.ravel(), prescribed[free.size :]])
    error = np.abs(slope - expected)[~fixed].max()
    assert error < 1e-5 * np.abs(expected).max()


def test_six_loaded_motions_give_the_prescribed_ones_back(problem, undisturbed):
    motion = np.array([2e-3, -1e-3, -3e-3, 1e-3, 2e-3, -2e-3])
    none, every = np.zeros(6, dtype=bool), np.ones(6, dtype=bool)
    frame = head_frame(1.5, 0.7)
    prescribed = problem.solve(undisturbed, PileControl(none, motion, np.zeros(6), frame))
    own_load = prescribed.pile_load @ frame
    by_load = problem.solve(undisturbed, PileControl(every, np.zeros(6), own_load, frame))
    np.testing.assert_allclose(by_load.increment.motion, frame @ motion, rtol=1e-5)


def test_load_at_a_height_is_a_load_and_a_moment_at_the_ground():
    """A force of 1 N along the direction, 2 m up, turns about the axis at 90 degrees from it."""
    frame = head_frame(2.0, np.pi / 2.0)
    load = np.linalg.solve(frame.T, np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    np.testing.assert_allclose(load, [0.0, 1.0, 0.0, -2.0, 0.0, 0.0], atol=1e-15)


def test_programmes_in_space(problem, undisturbed):
    """Each reaches what it prescribes, with the loads it keeps."""
    programmes = (
        Release(steps=1),
        Resume(steps=2),
        Rotate("on", 0.002, 0.002, start="resumed", advance=1e-3, first_step_halvings=0),
        Displace("compression", 4e-3, 4e-3, first_step_halvings=0),
        Lateral("lateral", 4e-3, 4e-3, height=1.0, direction=0.3, first_step_halvings=0),
        Lateral("fixed", 4e-3, 4e-3, head="fixed", first_step_halvings=0),
        Rotate("torsion", 0.004, 0.004, first_step_halvings=0),
        Rotate("moment", 0.004, 0.004, about="horizontal", first_step_halvings=0),
        Load("combined", vertical=5e3, lateral=1e3, torque=500.0, height=0.5, steps=2),
        Cycles("cycles", "lateral", amplitude=1e3, cycles=2, steps=1, start="combined"),
    )
    rebound = np.array([0.0, 0.0, 2e-3, 0.0, 0.0, 0.004])
    told = []
    result = run(problem, undisturbed, programmes, told.append, rebound=rebound)
    assert {entry.programme for entry in told if entry.load_unit == "N m"} == {
        "on", "torsion", "moment",
    }  # fmt: skip
    curve = {entry.programme.name: entry.curve for entry in result.programmes}
    scale = np.abs(curve["compression"].load).max()
    np.testing.assert_allclose(curve["release"].load[-1], np.zeros(6), atol=1e-6 * scale)
    let_go, *back = np.diff(curve["resume"].motion, axis=0)
    np.testing.assert_allclose(curve["resume"].load[1, [2, 5]], [0.0, 0.0], atol=1e-6 * scale)
    np.testing.assert_allclose(let_go[[0, 1, 3, 4]], np.zeros(4), atol=1e-12)
    np.testing.assert_allclose(back, [-rebound / 2, -rebound / 2], atol=1e-12)
    np.testing.assert_allclose(curve["on"].load[0], curve["resume"].load[-1], rtol=1e-9)
    np.testing.assert_allclose(curve["compression"].motion[-1], [0, 0, -4e-3, 0, 0, 0], atol=1e-12)
    lateral = curve["lateral"]
    assert lateral.displacement[-1] == pytest.approx(4e-3)
    force = lateral.head_load[-1]
    expected = force * np.array([np.cos(0.3), np.sin(0.3), 0, -np.sin(0.3), np.cos(0.3), 0])
    np.testing.assert_allclose(lateral.load[-1], expected, atol=1e-6 * scale)
    assert abs(curve["fixed"].head_load[-1]) > abs(force)
    np.testing.assert_allclose(curve["fixed"].motion[-1, 3:], 0.0, atol=1e-12)
    assert curve["torsion"].motion[-1, 5] == pytest.approx(0.004)
    assert curve["torsion"].head_load[-1] == pytest.approx(curve["torsion"].load[-1, 5])
    moment = curve["moment"].load[-1]
    np.testing.assert_allclose(np.delete(moment, 4), 0.0, atol=1e-6 * scale)
    np.testing.assert_allclose(
        curve["combined"].load[-1], [1e3, 0, -5e3, 0, 500.0, 500.0], atol=1e-6 * scale
    )
    assert curve["cycles"].head_load == pytest.approx(
        [1e3, 0, 1e3, 0, -1e3, 0, 1e3, 0, -1e3, 0], abs=1e-6 * scale
    )


def test_slab_of_tetrahedra_settles_as_plane_strain_does(make_structured_mesh):
    """The same elastic column under its weight, one cell thick: 1-D strain in both, exactly."""
    ground = Ground(18e3, 0.5, ELASTIC)
    x, z = np.array([0.0, 0.5, 1.0]), np.array([-2.0, -1.1, 0.0])

    def tag_of(middle):
        if abs(middle[1] + 2.0) < 1e-9:
            return FacetTag.BOTTOM
        return FacetTag.SURFACE if abs(middle[1]) < 1e-9 else FacetTag.SIDE

    plane = ServiceProblem(make_structured_mesh(x, z, tag_of), ground, ROUGH)
    slab = ServiceProblem(
        fe_mesh(box_mesh(x, np.array([0.0, 0.4]), z), outer_tags), ground, ROUGH, numerics=FULL,
        kinematics=SPACE,
    )  # fmt: skip
    heights = []
    for problem, dim in ((plane, 2), (slab, 3)):
        state = problem.wished_in_place_state()
        more = problem.solve(state, held(dim), external_force=2.0 * problem.gravity(state))
        top = np.abs(problem.mesh.nodes[:, -1]) < 1e-9
        heights.append(more.increment.displacement[top, -1])
    settlement = -18e3 * 4.0 / 2.0 / (5e6 * 0.7 / (1.3 * 0.4))
    for height in heights:
        np.testing.assert_allclose(height, settlement, rtol=1e-9)
