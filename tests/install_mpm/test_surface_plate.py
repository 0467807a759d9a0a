"""Plates that the mesh holds as surfaces: the cut, its sides, points beside it, and its edges."""

import numpy as np
import pytest
from scipy.integrate import quad

from install_mpm import screw_surface
from install_mpm.background_mesh import (
    FACETS_OPPOSITE,
    cell_quality,
    cut_along,
    facets_opposite_vertices,
)
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic, VonMises
from install_mpm.conventions import rotation_matrix
from install_mpm.edge_resistance import edge_resistance
from install_mpm.equilibrium import Prescribed
from install_mpm.ground import Ground
from install_mpm.kernels.locate import FOUND, PROJECTED, locate_points
from install_mpm.options import Box, Numerics, ScrewMeshOptions
from install_mpm.pile import PileMotion
from install_mpm.screw_installation import install_screw_pile
from install_mpm.screw_pile import Helix, ScrewPile, part_names
from install_mpm.screw_pile_mesh import generate_screw_mesh
from install_mpm.screw_programme import Phase, Pose, ScrewProgramme
from install_mpm.screw_record import weight_of
from install_mpm.screw_setup import geostatic_state, set_up
from install_mpm.step import step
from workflows.verification.solid_meshes import box_mesh

HELIX = Helix(1.0, 0.33, 0.03, 0.25, plate="surface")
BOX = Box(width=2.75, depth=3.0, headroom=0.5)
SIZES = ScrewMeshOptions(0.25, 0.35, 0.4, 1.2, 0.05, points_per_direction=1)
STRENGTH, ADHESION = 10e3, 0.5


def pile_of(hand="right", helix=HELIX):
    return ScrewPile(0.5, 1.2, (helix,), 8e3, hand=hand)


@pytest.fixture(scope="module")
def pile():
    return pile_of()


@pytest.fixture(scope="module")
def mesh(pile):
    return generate_screw_mesh(pile, BOX, SIZES)


# --- a mesh that is cut open ----------------------------------------------------------------------


@pytest.fixture(scope="module")
def cut_box():
    """A box of four by four by four, cut open at half height where x < 2."""
    ticks = np.arange(5.0)
    mesh = box_mesh(ticks, ticks, ticks)
    places = mesh.nodes[facets_opposite_vertices(mesh.cell_nodes[:, :4])]
    is_cut = (np.abs(places[..., 2] - 2.0) < 1e-9).all(axis=2) & (places[..., 0] < 2.1).all(axis=2)
    return mesh, cut_along(mesh, is_cut)


def test_nodes_of_a_cut_are_doubled_but_not_on_its_free_edge(cut_box):
    whole, cut = cut_box
    at_cut = np.abs(whole.nodes[:, 2] - 2.0) < 1e-9
    added = np.count_nonzero(at_cut & (whole.nodes[:, 0] < 2.0 - 1e-9))
    assert len(cut.nodes) == len(whole.nodes) + added
    for field in ("nodes", "reference_nodes"):
        np.testing.assert_array_equal(
            getattr(cut, field)[cut.cell_nodes], getattr(whole, field)[whole.cell_nodes]
        )
    height = cut.nodes[cut.cell_nodes[:, :4], 2].mean(axis=1)
    above, below = (np.unique(cut.cell_nodes[side]) for side in (height > 2.0, height < 2.0))
    both = np.intersect1d(above, below)
    np.testing.assert_allclose(cut.nodes[both, 2], 2.0)
    assert cut.nodes[both, 0].min() == pytest.approx(2.0)


def test_neighbours_across_a_cut_are_remembered(cut_box):
    whole, cut = cut_box
    is_cut = cut.cell_neighbours < -1
    assert np.count_nonzero(is_cut) == 2 * 2 * 4 * 2
    np.testing.assert_array_equal(-2 - cut.cell_neighbours[is_cut], whole.cell_neighbours[is_cut])
    np.testing.assert_array_equal(cut.cell_neighbours[~is_cut], whole.cell_neighbours[~is_cut])


def go(meshes, before, after):
    """Cell, status and place of points that go from one place in the cut mesh to another."""
    cells, coordinates = np.zeros(len(before), dtype=np.int64), np.zeros((len(before), 3))
    position, status = np.array(before), np.full(len(before), -1)
    for mesh, places in zip(meshes, (before, after), strict=True):  # they are found in the whole
        position[:] = places
        locate_points(
            mesh.nodes, mesh.cell_nodes, mesh.cell_neighbours, np.array(FACETS_OPPOSITE[4]),
            position, cells, coordinates, status,
        )  # fmt: skip
    return cells, status, position


def test_points_do_not_go_through_a_cut(cut_box, rng):
    _, mesh = cut_box
    before = np.column_stack([rng.uniform(0.1, 1.8, 40), rng.uniform(0.1, 3.9, 40), np.zeros(40)])
    before[:, 2] = 2.0 + np.where(np.arange(40) % 2, -0.1, 0.1)
    after = before * [1.0, 1.0, -1.0] + [0.05, 0.0, 4.0]  # mirrored
    cells, status, position = go(cut_box, before, after)
    np.testing.assert_array_equal(status, PROJECTED)
    side = np.sign(before[:, 2] - 2.0)
    centre = mesh.nodes[mesh.cell_nodes[cells, :4]].mean(axis=1)
    np.testing.assert_array_equal(np.sign(centre[:, 2] - 2.0), side)
    assert (side * (position[:, 2] - 2.0) > 0.0).all()
    assert np.abs(position - [0.0, 0.0, 2.0])[:, 2].max() < 0.05
    np.testing.assert_allclose(position[:, :2], after[:, :2], atol=0.05)


def test_points_go_round_the_edge_of_a_cut(cut_box, rng):
    across = np.array([[2.2, 1.3, 2.4], [3.1, 2.2, 2.3], [2.6, 0.7, 2.1]])
    _, status, position = go(cut_box, across, across * [1, 1, -1] + [0, 0, 4])
    np.testing.assert_array_equal(status, FOUND)
    assert (position[:, 2] < 2.0).all()
    # the straight way passes the edge, the walk from cell to cell is stopped by the cut
    start = np.column_stack([rng.uniform(0.5, 1.9, 200), rng.uniform(0.5, 3.5, 200),
                             rng.uniform(2.1, 2.5, 200)])  # fmt: skip
    end = np.column_stack([rng.uniform(2.6, 3.5, 200), rng.uniform(0.5, 3.5, 200),
                           rng.uniform(1.5, 1.99, 200)])  # fmt: skip
    share = (start[:, 2] - 2.0) / (start[:, 2] - end[:, 2])
    is_beyond = start[:, 0] + share * (end[:, 0] - start[:, 0]) > 2.0
    _, status, position = go(cut_box, start[is_beyond], end[is_beyond])
    np.testing.assert_array_equal(status, FOUND)
    np.testing.assert_array_equal(position, end[is_beyond])
    assert np.count_nonzero(is_beyond) > 10


# --- the mesh around a pile -----------------------------------------------------------------------


@pytest.mark.gmsh
def test_both_faces_are_in_the_mesh_and_nothing_else_of_the_plate(mesh, pile):
    elements, part, normals = screw_surface.pile_elements(mesh, pile)
    names = part_names(pile)
    _, area, facet_normal = screw_surface.place_points(elements, mesh)
    of_part = np.bincount(np.repeat(part, 3), area, len(names))
    exact, _ = quad(lambda r: np.hypot(2.0 * np.pi * r, HELIX.pitch), 0.25, 0.5)
    lower, upper = names.index("lower face"), names.index("upper face")
    assert of_part[lower] == pytest.approx(exact, rel=0.05)
    assert of_part[upper] == pytest.approx(of_part[lower], rel=1e-12)
    for name in ("rim", "leading edge", "trailing edge"):
        assert of_part[names.index(name)] == 0.0
    assert (np.einsum("pi,pi->p", normals, facet_normal) > 0.7).all()
    of_element = normals.reshape(-1, 3, 3)
    assert (of_element[part == lower, :, 2] > 0.9).all()
    assert (of_element[part == upper, :, 2] < -0.9).all()
    assert elements.is_swept.all()
    assert cell_quality(mesh).min() > 0.03


@pytest.mark.gmsh
def test_both_faces_have_their_own_nodes_but_at_rim_and_edges(mesh, pile):
    elements, part, _ = screw_surface.pile_elements(mesh, pile)
    names = part_names(pile)
    lower, upper = (
        np.unique(elements.nodes[part == names.index(name)])
        for name in ("lower face", "upper face")
    )
    shared = mesh.nodes[np.intersect1d(lower, upper)]
    radius = np.linalg.norm(shared[:, :2], axis=1)
    is_on_edge = (np.abs(shared[:, 1]) < 1e-6) & (shared[:, 0] > 0.0)
    assert (is_on_edge | (radius > 0.45)).all()  # mid-sides of the rim lie on chords
    inner = mesh.nodes[np.setdiff1d(lower, upper)]
    assert (np.abs(np.linalg.norm(inner[:, :2], axis=1) - 0.25) < 1e-6).any()  # at the shaft
    np.testing.assert_allclose(len(lower), len(upper))


@pytest.mark.gmsh
@pytest.mark.parametrize("hand", ["right", "left"])
def test_weight_leaves_out_a_plate_without_thickness(hand):
    pile = pile_of(hand)
    assert weight_of(pile, 1.2) == pytest.approx(8e3 * np.pi * 0.25**2 * 1.2)


def ground(soil=None):
    return Ground(soil=soil or VonMises(200 * STRENGTH, 0.49, STRENGTH), unit_weight=8e3, k0=1.0)


def law():
    stiffness = 50 * 200 * STRENGTH
    return CoulombInterface(stiffness, stiffness / 10, adhesion_factor=ADHESION)


@pytest.mark.gmsh
def test_a_rigid_motion_of_soil_and_pile_has_no_stress(mesh, pile):
    soil = Ground(0.0, 1.0, HenckyElastic(2e6, 0.3))
    programme = ScrewProgramme((Phase("in", 1.0, 1.0),), 0.02)
    problem = set_up(soil, pile, law(), BOX, programme, Numerics(), mesh)
    state = geostatic_state(problem, mesh, SIZES, "")
    motion = PileMotion(np.array([0.0, 0.0, -0.02]), np.radians(-2.0))
    rigid = mesh.nodes @ (rotation_matrix(motion.rotation, 3) - np.eye(3)).T + motion.translation
    radius = np.linalg.norm(mesh.nodes[:, :2], axis=1)
    is_outer = (radius > 2.0) | (mesh.nodes[:, 2] < -2.9)
    held = Prescribed(np.repeat(is_outer[:, None], 3, axis=1), rigid)
    result = step(
        state.material_points, mesh, state.interface, motion, held, np.zeros_like(mesh.nodes),
        lambda mesh, motion: mesh._replace(nodes=mesh.nodes + rigid), problem.model,
        problem.gradient,
    )  # fmt: skip
    found = result.equilibrium  # there is no force that its residual could be measured against
    assert np.abs(found.trial.cauchy_stress).max() < 1e-6 * 2e6
    assert np.abs(found.traction).max() < 1e-6 * 2e6
    soil_nodes = np.unique(mesh.cell_nodes[state.material_points.cell])
    error = found.displacement[soil_nodes] - rigid[soil_nodes]
    assert np.abs(error).max() < 1e-7


# --- installation ---------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def history(pile):
    programme = ScrewProgramme((Phase("in", 0.02, 1.0),), 0.022, release=False)
    state = install_screw_pile(
        ground(), pile, law(), BOX, SIZES, programme, Numerics(tolerance=1e-6), "title = 'x'"
    )
    return state.history


@pytest.mark.gmsh
def test_adhesion_is_full_on_both_faces(history, pile):
    """As in the closed form of PC1, though the faces share the nodes of their rim."""
    a, r, names = pile.shaft_radius, pile.helices[0].radius, part_names(pile)
    whole = ADHESION * STRENGTH * 2.0 * np.pi / 3.0 * (r**3 - a**3)
    tangential = history.part_torque[-1] - history.part_normal_torque[-1]
    for face in ("lower face", "upper face"):
        number = names.index(face)
        assert tangential[number] == pytest.approx(whole, rel=0.03)
    assert history.part_torque[-1, names.index("rim") :].sum() == 0.0


@pytest.mark.gmsh
def test_forces_and_work_balance(history):
    assert (history.far_force_mismatch <= 1e-6).all()
    assert (history.far_moment_mismatch <= 1e-6).all()
    taken = history.interface_work + history.soil_work - history.weight_work
    np.testing.assert_allclose(history.rig_work[1:], taken[1:], rtol=1e-3)


@pytest.mark.gmsh
def test_resistance_of_the_edges_is_recorded_beside_the_torque(history, pile):
    assert np.isnan(history.edge_torque[0])  # nothing moves
    stated = edge_resistance(pile, ground(), law(), 0.0066, Pose(0.0066, -0.04 * np.pi))
    np.testing.assert_allclose(history.edge_torque[1:], stated.edge_torque, rtol=1e-9)
    np.testing.assert_allclose(history.edge_force[1:], stated.edge_force, rtol=1e-9)
    np.testing.assert_allclose(history.torque, history.part_torque.sum(axis=1), rtol=1e-9)


# --- what is stated by hand -----------------------------------------------------------------------


@pytest.mark.parametrize("hand", ["right", "left"])
def test_resistance_of_edges_and_rim_is_that_by_hand(hand):
    """Two edges of 7 su on the thickness, and the rim, against the way of each place."""
    pile = pile_of(hand)
    climb = HELIX.pitch / (2.0 * np.pi)
    per_length = 2.0 * 7.0 * STRENGTH * HELIX.thickness
    edge_torque, _ = quad(lambda r: per_length * r * r / np.hypot(r, climb), 0.25, 0.5)
    edge_force, _ = quad(lambda r: per_length * climb / np.hypot(r, climb), 0.25, 0.5)
    rim = ADHESION * STRENGTH * 2.0 * np.pi * 0.5 * HELIX.thickness
    slope = np.hypot(0.5, climb)
    motion = Pose(0.033, -pile.sense * 0.2 * np.pi)
    found = edge_resistance(pile, ground(), law(), 0.1, motion)
    assert found.edge_torque == pytest.approx(edge_torque + rim * 0.5 * 0.5 / slope, rel=1e-3)
    assert found.edge_force == pytest.approx(edge_force + rim * climb / slope, rel=1e-3)
    out = edge_resistance(pile, ground(), law(), 0.1, Pose(-motion.advance, -motion.rotation))
    assert out.edge_torque == pytest.approx(-found.edge_torque)


@pytest.mark.parametrize(
    ("changes", "soil", "motion"),
    [
        ({"plate": "solid"}, None, Pose(0.03, -0.6)),
        ({}, HenckyElastic(2e6, 0.3), Pose(0.03, -0.6)),
        ({}, None, Pose(0.0, 0.0)),
    ],
    ids=["solid plate", "ground without su", "no motion"],
)
def test_what_cannot_be_stated_is_not(changes, soil, motion):
    helix = Helix(1.0, 0.33, 0.03, 0.25, **({"plate": "surface"} | changes))
    stated = edge_resistance(pile_of(helix=helix), ground(soil), law(), 0.1, motion)
    assert np.isnan(stated).all()
