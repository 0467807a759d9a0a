"""Laws of mesh motion: nodes go where they should, and no law touches what points carry."""

import numpy as np
import pytest

from install_mpm import mesh_motion
from install_mpm.background_mesh import cell_quality
from install_mpm.cells import CellType, reference_cell
from install_mpm.constitutive.parameters import VonMises
from install_mpm.ground import Ground
from install_mpm.location import relocate
from install_mpm.mesh_generation import generate_background_mesh
from install_mpm.pile import PileMotion
from install_mpm.seeding import seed_points

pytestmark = pytest.mark.gmsh

CLAY = Ground(18e3, 1.0, VonMises(4e6, 0.49, 20e3, 1e3))
MOTION = PileMotion(np.array([0.2, -0.3]), 0.4)
LAWS = {
    "translate": lambda mesh: mesh_motion.translate(mesh, 0.4, -2.0, (-5.0, 0.6), 0.2),
    "rotate": lambda mesh: mesh_motion.rotate(mesh, 0.1),
    "rotate, tapered": lambda mesh: mesh_motion.rotate(
        mesh, 0.3, inner_radius=1.0, outer_radius=4.0
    ),
    "translate and rotate": lambda mesh: mesh_motion.translate_and_rotate(
        mesh, MOTION, inner_radius=1.0, outer_radius=6.0
    ),
    "stretch": lambda mesh: mesh_motion.stretch(mesh, (1.2, 0.9)),
    "expand": lambda mesh: mesh_motion.expand(mesh, 0.2, inner_radius=0.5, outer_radius=4.0),
    "reset": lambda mesh: mesh_motion.reset(mesh, MOTION),
}


@pytest.fixture(scope="module", params=[CellType.TRI3, CellType.TRI6], ids=["tri3", "tri6"])
def ground_mesh(request, pile, box, mesh_options):
    return generate_background_mesh(pile, box, mesh_options, cell_type=request.param)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_motion_of_the_mesh_alone_changes_no_stress_volume_or_mass(law, ground_mesh):
    """Only cell and place in the cell may change; a point left outside may be put back inside."""
    cell_type = CellType.TRI6 if ground_mesh.cell_nodes.shape[1] == 6 else CellType.TRI3
    points = seed_points(ground_mesh, reference_cell(cell_type), CLAY, 2)
    moved_mesh = law(ground_mesh)
    moved, n_projected = relocate(points, moved_mesh)
    assert (moved.cell != points.cell).any()
    for name in points._fields:
        if name in ("cell", "reference_coordinates"):
            continue
        is_same = getattr(moved, name) == getattr(points, name)
        allowed = n_projected if name in ("position", "displacement") else 0
        assert (~is_same.reshape(len(is_same), -1).all(axis=1)).sum() <= allowed, name
    corners = moved_mesh.nodes[moved_mesh.cell_nodes[moved.cell, :3]]
    xi = moved.reference_coordinates
    share = np.column_stack([1.0 - xi.sum(axis=1), xi])
    np.testing.assert_allclose(np.einsum("pv,pvi->pi", share, corners), moved.position, atol=1e-12)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_law_starts_from_the_reference_mesh_and_keeps_mid_sides(law, ground_mesh):
    once = law(ground_mesh)
    np.testing.assert_array_equal(law(once).nodes, once.nodes)
    np.testing.assert_array_equal(once.reference_nodes, ground_mesh.reference_nodes)
    np.testing.assert_array_equal(once.cell_nodes, ground_mesh.cell_nodes)
    if once.cell_nodes.shape[1] == 6:
        ends = once.nodes[once.cell_nodes[:, [[0, 1], [1, 2], [2, 0]]]]
        middles = once.nodes[once.cell_nodes[:, 3:]]
        np.testing.assert_allclose(middles, ends.mean(axis=2), atol=1e-14)


def test_positive_rotation_is_eqs_3_and_4_with_minus_the_angle(ground_mesh):
    """As printed the equations turn clockwise; a quarter turn takes (1, 0) to (0, -1)."""
    place = mesh_motion.rotate_clockwise(np.array([[1.0, 0.0]]), np.pi / 2.0)
    np.testing.assert_allclose(place, [[0.0, -1.0]], atol=1e-15)
    turned = mesh_motion.rotate(ground_mesh, 0.3).nodes[ground_mesh.cell_nodes[:, :3]]
    wanted = mesh_motion.rotate_clockwise(ground_mesh.reference_nodes, -0.3)
    np.testing.assert_allclose(turned, wanted[ground_mesh.cell_nodes[:, :3]], atol=1e-14)


def test_tapered_rigid_motion_is_whole_inside_and_nothing_at_the_rim(ground_mesh):
    moved = LAWS["translate and rotate"](ground_mesh)
    vertices = np.unique(ground_mesh.cell_nodes[:, :3])
    start, end = ground_mesh.reference_nodes[vertices], moved.nodes[vertices]
    radius = np.linalg.norm(start, axis=1)
    cosine, sine = np.cos(0.4), np.sin(0.4)
    rigid = start @ np.array([[cosine, sine], [-sine, cosine]]) + MOTION.translation
    inside, outside = radius <= 1.0, radius >= 6.0
    assert inside.any()
    assert outside.any()
    np.testing.assert_allclose(end[inside], rigid[inside], atol=1e-13)
    np.testing.assert_array_equal(end[outside], start[outside])


def test_reset_gives_the_cells_their_first_shape_beside_the_pile(ground_mesh):
    worn = LAWS["translate"](ground_mesh)
    assert cell_quality(worn).min() < cell_quality(ground_mesh).min()
    back = mesh_motion.reset(worn, PileMotion(np.array([0.0, -0.4])))
    np.testing.assert_allclose(cell_quality(back), cell_quality(ground_mesh), rtol=1e-9)
    moved = back.nodes - ground_mesh.reference_nodes
    np.testing.assert_allclose(moved, np.tile([0.0, -0.4], (len(moved), 1)), atol=1e-11)
