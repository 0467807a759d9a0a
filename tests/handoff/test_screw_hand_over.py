"""A screw pile handed over: transfer in space, tractions, and no installation at all."""

from dataclasses import replace

import numpy as np
import pytest

from handoff.facet_points import facet_points
from handoff.hand_over import hand_over, wished_in_place
from handoff.interface_transfer import FESurface, forces_on_pile
from handoff.line_of_sight import hides, screw_obstacle
from handoff.options import HandoffOptions
from handoff.placed_pile import PlacedScrewPile
from handoff.quality import failed_checks
from handoff.surface import level_surface
from handoff.surface_transfer import resultant
from handoff.synthetic import rim_stress
from handoff.transfer import least_squares_weights, transferred
from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.conventions import rotation_matrix
from install_mpm.exact_patches import strength_shares
from install_mpm.ground import Ground
from install_mpm.interface import InterfacePoints, force_on_pile, reaction
from install_mpm.options import Box, Numerics, ScrewMeshOptions
from install_mpm.screw_history import ScrewHistory
from install_mpm.screw_pile import Helix, ScrewPile
from install_mpm.screw_pile_mesh import generate_screw_mesh
from install_mpm.screw_programme import Phase, ScrewProgramme
from install_mpm.screw_setup import geostatic_state, set_up
from install_mpm.screw_shape import surface_normals
from install_mpm.screw_surface import facet_normals

PILE = ScrewPile(0.5, 1.5, (Helix(1.0, 0.33, 0.12, 0.25),), 18e3)
BOX = Box(2.75, 3.5, 0.6)
GROUND = Ground(18e3, 0.8, VonMises(2e6, 0.49, 10e3))
LAW = CoulombInterface(1e8, 1e7, adhesion_factor=0.5)
MESH = ScrewMeshOptions(0.25, 0.4, 0.35, 1.1, 0.1, points_per_direction=1)
OPTIONS = HandoffOptions(size_at_pile=0.22, size_far=1.1, neighbours=16, max_synthetic_error=0.2)
PLACED = PlacedScrewPile(PILE, 0.0)


@pytest.fixture(scope="module")
def undisturbed():
    mesh = generate_screw_mesh(PILE, BOX, MESH)
    programme = ScrewProgramme((Phase("in", 1.0, 1.0),), 0.02)
    problem = set_up(GROUND, PILE, LAW, BOX, programme, Numerics(), mesh)
    state = geostatic_state(problem, mesh, MESH, 'title = "none"\n')
    return state._replace(pile=state.pile._replace(reaction=reaction(state.interface)))


@pytest.fixture(scope="module")
def make_problem():
    from service_fe.problem import ServiceProblem

    def make(mesh):
        return ServiceProblem(
            mesh, GROUND, LAW, PLACED.weight(None), kinematics=PLACED.kinematics,
            normals=PLACED.normals, strength_share=PLACED.strength_share,
        )  # fmt: skip

    return make


def released(undisturbed, last_share=1.0):
    """The same ground around a pile that the rig has let go of, or is letting go of."""
    fields = dict.fromkeys(ScrewHistory._fields, np.zeros(4))
    fields |= {
        "penetration": np.array([0.0, 0.30, 0.298, 0.294]),
        "rotation": np.array([0.0, -5.0, -4.998, -4.99]),
        "release_share": np.array([0.0, 0.0, 0.5, last_share]),
    }
    pile = undisturbed.pile._replace(penetration=np.array(0.294), rotation=np.array(-4.99))
    return undisturbed._replace(history=ScrewHistory(**fields), pile=pile)


def test_rebound_is_the_motion_since_the_rig_let_go(undisturbed):
    assert PLACED.rebound(undisturbed) == (0.0, 0.0)
    assert PLACED.rebound(released(undisturbed)) == pytest.approx((6e-3, 0.01))


def test_only_a_pile_that_the_rig_has_let_go_of_is_free(undisturbed):
    assert PLACED.carried(undisturbed) is None
    assert PLACED.carried(released(undisturbed, last_share=0.75)) is None
    carried = PLACED.carried(released(undisturbed))
    expected = resultant(undisturbed.interface.position, force_on_pile(undisturbed.interface))
    np.testing.assert_allclose(carried, np.ravel(expected), rtol=1e-12)


@pytest.mark.dolfinx
@pytest.mark.gmsh
def test_a_released_pile_carries_its_load_when_handed_over(undisturbed, make_problem):
    """What was pushed down is pushed down after: force and moment, in a certificate that holds."""
    before = undisturbed.interface
    pushed = before._replace(traction=before.traction * [1.0, 1.0, 1.05])
    state = released(undisturbed)._replace(interface=pushed)
    state = state._replace(pile=undisturbed.pile._replace(reaction=reaction(pushed)))
    handed_off, certificate = hand_over(
        state, GROUND, PLACED, BOX, LAW, OPTIONS, make_problem, lambda phase: None
    )
    load = make_problem(handed_off.mesh).pile_load(handed_off.state)
    carried = PLACED.carried(state)
    expected = -carried + np.eye(6)[2] * PLACED.weight(None)
    np.testing.assert_allclose(load, expected, atol=1e-6 * np.abs(carried).max())
    value = {name: figure.value for name, figure in certificate.figures.items()}
    assert value["pile_reaction_change"] < 1e-6
    assert value["pile_moment_change"] < 1e-6
    assert 0.0 < value["pile_displacement"] < 1e-3


def test_linear_field_is_reproduced_and_a_quadratic_one_to_second_order():
    random = np.random.default_rng(0)
    targets = random.uniform(-0.5, 0.5, size=(300, 3))
    errors = []
    for count in (4000, 32000):
        points = random.uniform(-1.0, 1.0, size=(count, 3))
        table = least_squares_weights(points, np.ones(count), targets, 24)
        linear = [x @ np.array([1.0, -2.0, 0.5]) + 3.0 for x in (points, targets)]
        assert np.abs(transferred(table, linear[0]) - linear[1]).max() < 1e-10
        quadratic = [(x[:, 0] * x[:, 1] + x[:, 2] ** 2) for x in (points, targets)]
        errors.append(np.sqrt(np.mean((transferred(table, quadratic[0]) - quadratic[1]) ** 2)))
    assert np.log2(errors[0] / errors[1]) > 1.7


def test_points_on_a_plane_keep_constants_and_bound_the_gradient():
    points = np.random.default_rng(1).uniform(-1.0, 1.0, size=(200, 3)) * [1.0, 1.0, 0.0]
    targets = np.array([[0.1, 0.2, 0.0], [0.0, 0.0, 0.3]])
    table = least_squares_weights(points, np.ones(200), targets, 24)
    assert np.abs(transferred(table, np.ones(200)) - 1.0).max() < 1e-10
    assert np.abs(table.weights).sum(axis=1).max() < 3.0


@pytest.mark.parametrize("rotation", [0.0, -2.0])
def test_plate_and_shaft_hide_points_and_the_gap_between_the_edges_does_not(rotation):
    """The plate begins at the polar angle 0 at -1.25 m and ends there 0.33 m higher."""
    obstacle = screw_obstacle(PILE, rotation)
    turn = rotation_matrix(rotation, 3)

    def hidden(start, end):
        return hides(obstacle, turn @ np.array(start), turn @ np.array(end))

    middle = -1.25 + 0.33 / 2.0  # of the plate at the polar angle 180 degrees
    assert hidden((-0.4, 0.0, middle - 0.1), (-0.4, 0.0, middle + 0.1))
    assert not hidden((-0.6, 0.0, middle - 0.1), (-0.6, 0.0, middle + 0.1))
    assert not hidden((-0.4, 0.0, middle + 0.1), (-0.4, 0.0, middle + 0.5))
    assert hidden((-0.4, 0.0, -0.5), (0.4, 0.0, -0.5))
    assert not hidden((-0.4, 0.0, -1.6), (0.4, 0.0, -1.6))
    assert not hidden((0.4, -0.1, -1.08), (0.4, 0.1, -1.08))  # between the edges


def test_rim_field_is_free_of_divergence():
    positions = np.random.default_rng(0).uniform((-1, -1, -2.5), (1, 1, -0.5), size=(50, 3))
    step = 1e-4
    along = [
        (
            rim_stress(GROUND, PILE, 0.3, positions + step * axis)
            - rim_stress(GROUND, PILE, 0.3, positions - step * axis)
        )
        / (2.0 * step)
        for axis in np.eye(3)
    ]
    divergence = sum(along[axis][:, axis] for axis in range(3))
    assert np.abs(divergence).max() < 1e-6 * np.abs(along[0]).max()
    assert np.abs(rim_stress(GROUND, PILE, 0.3, positions)).max() > 10e3


def surface_of_mesh(make_problem):
    problem = make_problem(PLACED.mesh(BOX, OPTIONS, level_surface()))
    return FESurface(
        problem.interface_positions, problem.interface_normals, problem.interface_facet_normals,
        problem.interface_areas, problem.interface_parts,
    ), problem  # fmt: skip


@pytest.mark.dolfinx
@pytest.mark.gmsh
def test_force_and_moment_of_every_part_are_kept(undisturbed, make_problem):
    surface, problem = surface_of_mesh(make_problem)
    before: InterfacePoints = undisturbed.interface
    x, y, z = before.position.T
    extra = 1e3 * np.column_stack([x + 2.0 * z, y**2, -3.0 - x * y]) * before.covered[:, None]
    traction = PLACED.traction(GROUND, undisturbed, surface)
    more = undisturbed._replace(interface=before._replace(traction=before.traction + extra))
    changed = PLACED.traction(GROUND, more, surface) - traction
    on_fe = forces_on_pile(changed, surface.normals, surface.areas, surface.positions)
    on_mpm = force_on_pile(before._replace(traction=extra))
    for part in np.unique(surface.parts):
        here, there = before.part == part, surface.parts == part
        expected = resultant(before.position[here], on_mpm[here])
        found = resultant(surface.positions[there], on_fe[there])
        np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(expected).max())
    geostatic = problem.wished_in_place_state().interface_traction
    np.testing.assert_allclose(traction, geostatic, atol=1e-9 * np.abs(geostatic).max())


@pytest.mark.dolfinx
@pytest.mark.gmsh
def test_pile_that_was_not_installed_is_the_pile_wished_in_place(undisturbed, make_problem):
    """Certificate passed without equilibration, and the same curves to 1e-6 in every programme."""
    from service_fe.options import Cycles, Displace, Lateral, Load, Release, Resume, Rotate
    from service_fe.solve import run

    handed_off, certificate = hand_over(
        undisturbed, GROUND, PLACED, BOX, LAW, OPTIONS, make_problem, lambda phase: None
    )
    assert failed_checks(certificate) == []
    value = {name: figure.value for name, figure in certificate.figures.items()}
    assert value["out_of_balance_geostatic"] < 1e-13
    assert value["out_of_balance_before"] < 1e-4  # what the slip limit takes on plane facets
    # and at the corners of the edges, whose one normal leans by 45 degrees: a quarter of a mm there
    assert value["equilibration_displacement"] < 3e-4
    assert value["mean_pressure_relaxation"] < 1e-3
    problem = make_problem(handed_off.mesh)
    programmes = (
        Release(steps=1),
        Displace("compression", 0.02, 0.02, first_step_halvings=0),
        Displace("uplift", -0.01, 0.01, first_step_halvings=0),
        Lateral("lateral", 0.02, 0.02, height=0.5, first_step_halvings=0),
        Rotate("torsion", 0.01, 0.01, first_step_halvings=0),
        Rotate("moment", 0.005, 0.005, about="horizontal", first_step_halvings=0),
        Load("combined", vertical=20e3, lateral=2e3, torque=1e3, height=0.5, steps=1),
        Cycles("cycles", "lateral", amplitude=2e3, cycles=1, steps=1),
        Resume(steps=1),
        Rotate("on", -0.01, 0.01, advance=2e-3, start="resumed", first_step_halvings=0),
    )
    wished = run(problem, wished_in_place(GROUND, LAW, problem, OPTIONS), programmes)
    installed = run(problem, handed_off.state, programmes)
    for mine, its in zip(installed.programmes, wished.programmes, strict=True):
        scale = np.abs(its.curve.load).max()
        np.testing.assert_allclose(mine.curve.load, its.curve.load, atol=1e-6 * scale)


@pytest.mark.gmsh
def test_facets_are_those_of_the_installation():
    """One normal at each corner, three points, and strengths of the exact surface."""
    facets = facet_points(PLACED.mesh(BOX, OPTIONS, level_surface()))
    assert len(facets.weights) == 3
    normals, has_corner = facet_normals(PILE, facets, facets.facet_parts, facets.coordinates)
    np.testing.assert_array_equal(PLACED.normals(facets), normals)
    exact = surface_normals(PILE, facets.parts, facets.positions)
    off = np.linalg.norm(normals - exact, axis=1).reshape(-1, 3).max(axis=1)
    assert off[~has_corner].max() < 1e-12
    assert off[has_corner].min() > 1e-3
    np.testing.assert_array_equal(
        PLACED.strength_share(facets),
        strength_shares(PILE, facets, facets.facet_parts, facets.coordinates),
    )
    some = facets.selected(facets.facet_parts == 3)
    assert (some.parts == 3).all()
    np.testing.assert_array_equal(some.positions, facets.positions[facets.parts == 3])


@pytest.mark.gmsh
def test_turned_pile_has_turned_normals_and_distances():
    turned = PlacedScrewPile(PILE, 0.5)
    turn = rotation_matrix(0.5, 3)
    places = np.random.default_rng(2).uniform((-1, -1, -2.0), (1, 1, 0), size=(40, 3))
    facets = facet_points(PLACED.mesh(BOX, OPTIONS, level_surface()))
    moved = facets._replace(coordinates=facets.coordinates @ turn.T)
    np.testing.assert_allclose(turned.normals(moved), PLACED.normals(facets) @ turn.T, atol=1e-12)
    np.testing.assert_allclose(turned.strength_share(moved), PLACED.strength_share(facets))
    np.testing.assert_allclose(turned.distance(places @ turn.T), PLACED.distance(places))
    beside = np.array([[0.0, 0.7, -1.25 + 0.33 / 4.0], [0.0, 0.0, -1.9]])
    np.testing.assert_allclose(PLACED.distance(beside), [0.2, 0.4])
    assert replace(turned, rotation=0.0) == PLACED
