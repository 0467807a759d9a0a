"""The mesh conforms to pile, box and heaved surface, is well shaped and repeatable."""

import gmsh
import numpy as np
import pytest

from handoff.fe_mesh import FacetTag, cell_areas, make_mesh, mesh_quality
from handoff.gmsh_triangles import MeshError
from handoff.options import HandoffOptions
from handoff.surface import SurfaceProfile, height_at, level_surface

pytestmark = pytest.mark.gmsh


def mound(height: float) -> SurfaceProfile:
    x = np.linspace(0.5, 4.0, 200)
    return SurfaceProfile(x, height * np.exp(-(x - 0.5)))


def test_area_of_the_soil_is_that_of_the_box_less_the_pile(site):
    mesh = site.mesh()
    assert cell_areas(mesh).min() > 0.0
    assert cell_areas(mesh).sum() == pytest.approx(4.0 * 5.0 - 0.5 * 2.0, rel=1e-13)


@pytest.mark.parametrize(
    ("tag", "length"),
    [
        (FacetTag.PILE_BASE, 0.5),
        (FacetTag.PILE_SHAFT, 2.0),
        (FacetTag.SYMMETRY, 3.0),
        (FacetTag.SIDE, 5.0),
        (FacetTag.BOTTOM, 4.0),
        (FacetTag.SURFACE, 3.5),
    ],
)
def test_each_part_of_the_boundary_has_its_length(site, tag, length):
    mesh = site.mesh()
    ends = mesh.nodes[mesh.facet_nodes[mesh.facet_tag == tag, :2]]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    assert lengths.sum() == pytest.approx(length, rel=1e-12)


def test_soil_lies_on_the_left_of_every_facet(site):
    mesh = site.mesh()
    ends = mesh.nodes[mesh.facet_nodes[:, :2]]
    along = ends[:, 1] - ends[:, 0]
    outward = np.column_stack([along[:, 1], -along[:, 0]]).sum(axis=0)
    assert np.abs(outward).max() < 1e-12
    bottom = mesh.facet_tag == FacetTag.BOTTOM
    assert (along[bottom, 0] > 0.0).all()


def test_mid_sides_lie_halfway_also_after_warping(site):
    mesh = site.mesh(surface=mound(0.3))
    for corner in range(3):
        ends = mesh.nodes[mesh.cell_nodes[:, [corner, (corner + 1) % 3]]]
        assert np.array_equal(mesh.nodes[mesh.cell_nodes[:, 3 + corner]], ends.mean(axis=1))
    assert np.array_equal(
        mesh.nodes[mesh.facet_nodes[:, 2]], mesh.nodes[mesh.facet_nodes[:, :2]].mean(axis=1)
    )


def test_cells_are_small_at_the_corner_and_well_shaped(site):
    mesh = site.mesh(0.1)
    corner = np.flatnonzero(np.linalg.norm(mesh.nodes - (0.5, -2.0), axis=1) < 1e-12)
    assert len(corner) == 1
    around = np.isin(mesh.cell_nodes[:, :3], corner).any(axis=1)
    assert np.sqrt(cell_areas(mesh)[around]).max() < 0.1
    assert mesh_quality(mesh).min() > 0.4


def test_surface_follows_the_profile_and_nothing_below_the_tip_moves(site):
    level, warped, surface = site.mesh(), site.mesh(surface=mound(0.3)), mound(0.3)
    ends = np.unique(warped.facet_nodes[warped.facet_tag == FacetTag.SURFACE, :2])
    x, z = warped.nodes[ends].T
    assert z == pytest.approx(height_at(surface, x), abs=1e-12)
    vertices = np.unique(level.cell_nodes[:, :3])
    below = vertices[level.nodes[vertices, 1] <= -2.0]
    assert np.array_equal(level.nodes[below], warped.nodes[below])
    assert np.array_equal(level.nodes[:, 0], warped.nodes[:, 0])
    assert np.array_equal(level.facet_tag, warped.facet_tag)
    assert mesh_quality(warped).min() > 0.3


def test_same_arguments_give_the_bit_equal_mesh(site):
    for first, second in zip(site.mesh(), site.mesh(), strict=True):
        assert np.array_equal(first, second)


def test_level_profile_gives_the_same_mesh_as_no_profile(site):
    flat = SurfaceProfile(np.linspace(0.5, 4.0, 30), np.zeros(30))
    for first, second in zip(site.mesh(), site.mesh(surface=flat), strict=True):
        assert np.array_equal(first, second)


def test_mesh_options_and_models_of_the_caller_survive(site):
    expected = site.mesh()
    gmsh.initialize(argv=[], readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.MeshSizeFactor", 7.0)
        gmsh.option.setNumber("Mesh.ElementOrder", 2)
        gmsh.model.add("caller")
        nodes = site.mesh().nodes
        assert gmsh.model.list()[-1] == gmsh.model.getCurrent() == "caller"
        assert gmsh.option.getNumber("Mesh.MeshSizeFactor") == 7.0
        assert gmsh.option.getNumber("Mesh.ElementOrder") == 2.0
    finally:
        gmsh.finalize()
    assert np.array_equal(nodes, expected.nodes)
    site.mesh()
    assert not gmsh.isInitialized()


def test_fault_in_the_size_function_leaves_gmsh_closed(site, monkeypatch):
    monkeypatch.setattr("handoff.fe_mesh._edge_length", lambda *_: -1.0)
    with pytest.raises(MeshError, match="gmsh could not mesh"):
        site.mesh()
    assert not gmsh.isInitialized()


@pytest.mark.parametrize(
    ("tip_depth", "size", "words"),
    [(6.0, 0.1, "does not fit"), (2.0, 0.6, "larger than the half-width")],
)
def test_impossible_geometry_is_named(site, tip_depth, size, words):
    options = HandoffOptions(size_at_pile=size, size_far=1.0)
    with pytest.raises(MeshError, match=words):
        make_mesh(site.pile, tip_depth, site.box, options, level_surface())


def test_surface_deeper_than_the_mesh_can_follow_is_named(site):
    with pytest.raises(MeshError, match="too steep"):
        site.mesh(surface=mound(-1.99))
