"""The mesh inside a pile: it conforms to the ground, fills the pile, and knows its head."""

import numpy as np
import pytest

from handoff.fe_mesh import FacetTag, make_mesh, pile_facets
from handoff.options import HandoffOptions
from handoff.pile_mesh import mesh_of_pile, with_twins
from handoff.screw_mesh import make_screw_mesh
from handoff.surface import level_surface
from install_mpm.options import Box
from install_mpm.pile import Pile
from install_mpm.screw_pile import Helix, ScrewPile

pytestmark = pytest.mark.gmsh


def flat_ground():
    options = HandoffOptions(size_at_pile=0.1, size_far=0.5)
    return make_mesh(Pile(0.5, 2.0, 0.0), 2.0, Box(4.0, 5.0, 0.5), options, level_surface())


def screw_ground():
    pile = ScrewPile(0.2, 2.0, (Helix(0.6, 0.15, 0.05, 0.2),), 0.0)
    options = HandoffOptions(size_at_pile=0.1, size_far=0.6)
    return make_screw_mesh(pile, 0.3, Box(2.0, 3.0, 0.3), options, level_surface())


def volumes(mesh):
    dim = mesh.nodes.shape[1]
    corners = mesh.nodes[mesh.cell_nodes[:, : dim + 1]]
    return np.linalg.det(corners[:, 1:] - corners[:, :1]) / (2 if dim == 2 else 6)


def enclosed(ground):
    """Volume inside the pile facets below the surface z = 0, by Gauss' theorem with (0, 0, z)."""
    facets = ground.facet_nodes[pile_facets(ground)]
    if ground.nodes.shape[1] == 2:
        start, end = (ground.nodes[facets[:, k]] for k in (0, 1))
        outward = start[:, 0] - end[:, 0]  # out of the pile, along z, times length
        return abs(0.5 * ((start[:, 1] + end[:, 1]) * outward).sum())
    a, b, c = (ground.nodes[facets[:, k]] for k in (0, 1, 2))
    area = 0.5 * np.cross(b - a, c - a)[:, 2]
    return abs(((a + b + c)[:, 2] / 3.0 * area).sum())


@pytest.mark.parametrize("make", [flat_ground, screw_ground])
def test_mesh_fills_the_pile_and_shares_its_surface(make):
    ground = make()
    inside = mesh_of_pile(ground)
    assert volumes(inside.mesh).min() > 0.0
    assert volumes(inside.mesh).sum() == pytest.approx(enclosed(ground), rel=1e-9)
    on_pile = np.unique(ground.facet_nodes[pile_facets(ground)])
    np.testing.assert_array_equal(np.flatnonzero(inside.twin >= 0), on_pile)
    np.testing.assert_allclose(
        inside.mesh.nodes[inside.twin[on_pile]], ground.nodes[on_pile], atol=1e-9
    )
    touching = inside.mesh.facet_tag == FacetTag.SURFACE
    assert touching.sum() == len(pile_facets(ground))
    head = inside.mesh.facet_nodes[inside.mesh.facet_tag == FacetTag.PILE_HEAD]
    assert len(head)
    assert np.abs(inside.mesh.nodes[head][:, :, -1]).max() < 1e-9


def test_mesh_that_does_not_conform_is_refused():
    ground = flat_ground()
    inside = mesh_of_pile(ground).mesh
    moved = inside._replace(nodes=inside.nodes + np.array([0.01, 0.0]))
    with pytest.raises(ValueError, match="does not conform"):
        with_twins(moved, ground)
