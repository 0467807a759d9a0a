"""The mesh of tetrahedra around a screw pile: volume, areas, parts, layers, heaved surface."""

from dataclasses import replace

import numpy as np
import pytest

from handoff.fe_mesh import FacetTag
from handoff.gmsh_triangles import MeshError
from handoff.options import HandoffOptions
from handoff.screw_mesh import make_screw_mesh
from handoff.surface import SurfaceProfile, height_at, level_surface
from install_mpm.options import Box
from install_mpm.screw_pile import Helix, ScrewPile, first_part
from install_mpm.screw_shape import surface_normals

pytestmark = pytest.mark.gmsh

PILE = ScrewPile(0.5, 1.5, (Helix(1.0, 0.33, 0.12, 0.25),), 18e3)
BOX = Box(2.75, 3.5, 0.6)
OPTIONS = HandoffOptions(size_at_pile=0.2, size_far=1.1)
ANGLE = -0.7


@pytest.fixture(scope="module")
def mesh():
    return make_screw_mesh(PILE, ANGLE, BOX, OPTIONS, level_surface(), (2.0,))


def volume(mesh):
    corners = mesh.nodes[mesh.cell_nodes[:, :4]]
    return np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6.0


def vector_areas(mesh):
    corners = mesh.nodes[mesh.facet_nodes[:, :3]]
    return 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def test_volume_is_that_of_the_box_less_the_pile(mesh):
    prism = 12.0 * BOX.width**2 * np.sin(2.0 * np.pi / 24.0) * BOX.depth
    plate = (0.5**2 - 0.25**2) * np.pi * 0.12
    pile = np.pi * 0.25**2 * PILE.embedment + plate
    assert volume(mesh).min() > 0.0
    # the facets on the pile are plane, so they cut off a part of its volume
    assert volume(mesh).sum() == pytest.approx(prism - pile, rel=2e-3)
    assert volume(mesh).sum() > prism - pile


def test_boundary_is_closed_and_its_parts_have_their_areas(mesh):
    areas = vector_areas(mesh)
    np.testing.assert_allclose(areas.sum(axis=0), 0.0, atol=1e-10)
    size = {
        tag: np.linalg.norm(areas[mesh.facet_tag == tag], axis=1).sum()
        for tag in np.unique(mesh.facet_tag)
    }
    prism = 12.0 * BOX.width**2 * np.sin(2.0 * np.pi / 24.0)
    assert size[FacetTag.BOTTOM] == pytest.approx(prism, rel=1e-9)
    assert size[FacetTag.SURFACE] == pytest.approx(prism - np.pi * 0.25**2, rel=2e-3)
    edges = first_part(0) + np.array([3, 4])
    assert [size[edge] for edge in edges] == pytest.approx([0.25 * 0.12] * 2, rel=1e-3)
    assert size[2] == pytest.approx(2.0 * np.pi * 0.25 * (PILE.embedment - 0.12), rel=0.05)
    assert size[first_part(0)] == pytest.approx(size[first_part(0) + 1], rel=0.02)


def test_rounded_edges_are_meshed_as_well():
    """Two chords are 10 % short of a half circle."""
    rounded = replace(PILE, helices=(replace(PILE.helices[0], edges="rounded"),))
    mesh = make_screw_mesh(rounded, ANGLE, BOX, OPTIONS, level_surface())
    areas = vector_areas(mesh)
    np.testing.assert_allclose(areas.sum(axis=0), 0.0, atol=1e-10)
    for edge in first_part(0) + np.array([3, 4]):
        size = np.linalg.norm(areas[mesh.facet_tag == edge], axis=1).sum()
        assert size == pytest.approx(np.pi * 0.06 * 0.25, rel=0.15)


def test_facets_of_a_part_face_as_its_exact_normals_do(mesh):
    turn = np.array([[np.cos(ANGLE), -np.sin(ANGLE)], [np.sin(ANGLE), np.cos(ANGLE)]])
    on_pile = mesh.facet_tag >= 0
    centre = mesh.nodes[mesh.facet_nodes[on_pile, :3]].mean(axis=1)
    facing = vector_areas(mesh)[on_pile]
    for vectors in (centre, facing):
        vectors[:, :2] = vectors[:, :2] @ turn  # back into the frame of the pile
    normals = surface_normals(PILE, mesh.facet_tag[on_pile], centre)
    cosine = (normals * facing).sum(axis=1) / np.linalg.norm(facing, axis=1)
    assert cosine.min() > 0.9


def test_no_cell_lies_across_a_boundary_between_layers(mesh):
    z = mesh.nodes[mesh.cell_nodes[:, :4], 2]
    assert not ((z.min(axis=1) < -2.0 - 1e-9) & (z.max(axis=1) > -2.0 + 1e-9)).any()


def test_surface_follows_the_heave_and_the_plate_does_not_move(mesh):
    heaved = SurfaceProfile(np.array([0.25, 0.6, 1.5]), np.array([0.1, 0.03, 0.0]))
    warped = make_screw_mesh(PILE, ANGLE, BOX, OPTIONS, heaved, (2.0,))
    top = np.unique(warped.facet_nodes[warped.facet_tag == FacetTag.SURFACE, :3])
    radius = np.linalg.norm(warped.nodes[top, :2], axis=1)
    np.testing.assert_allclose(warped.nodes[top, 2], height_at(heaved, radius), atol=1e-9)
    plate = np.unique(warped.facet_nodes[warped.facet_tag >= first_part(0)])
    np.testing.assert_array_equal(warped.nodes[plate], mesh.nodes[plate])


def test_mesh_is_repeatable(mesh):
    again = make_screw_mesh(PILE, ANGLE, BOX, OPTIONS, level_surface(), (2.0,))
    for first, second in zip(mesh, again, strict=True):
        np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize(
    ("pile", "options", "words"),
    [
        (PILE, HandoffOptions(0.3, 1.1), "take at most 0.25 m"),
        (PILE, HandoffOptions(0.2, 0.1), "size_far is smaller"),
        (replace(PILE, embedment=4.0), OPTIONS, "make the box deeper"),
    ],
)
def test_meshes_that_cannot_be_are_refused(pile, options, words):
    with pytest.raises(MeshError, match=words):
        make_screw_mesh(pile, 0.0, BOX, options, level_surface())
