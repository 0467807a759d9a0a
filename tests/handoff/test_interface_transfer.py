"""Interface tractions: geostatic exactly, resultants kept, inactive points passed over."""

import numpy as np
import pytest

from handoff.geostatic import geostatic_traction
from handoff.interface_transfer import forces_on_pile, part_forces, transferred_traction
from install_mpm.pile import PilePart

pytestmark = pytest.mark.gmsh


@pytest.fixture(scope="module")
def surface(site, build):
    return build.pile_surface(site.mesh())


def test_geostatic_traction_is_reproduced(site, build, surface):
    traction = transferred_traction(
        site.ground, build.interface(site), surface.positions, surface.areas, surface.parts
    )
    expected = geostatic_traction(site.ground, surface.positions, surface.normals)
    assert np.abs(traction - expected).max() < 1e-12 * np.abs(expected).max()


def test_resultant_of_each_part_is_kept(site, build, surface):
    """A base pressure rising to the edge and adhesion that starts 1 m down, on unequal points."""
    points = build.interface(site, per_part=40)
    x, z = points.position.T
    extra = np.column_stack(
        [np.where(x < 0.5, 0.0, 10e3 * (z < -1.0)), np.where(z < -1.999, -40e3 * (1 + x**2), 0.0)]
    )
    points = points._replace(traction=points.traction + extra * points.covered[:, None])
    traction = transferred_traction(
        site.ground, points, surface.positions, surface.areas, surface.parts
    )
    covered = points.area * points.covered
    before = forces_on_pile(points.traction, points.normal, covered, points.position)
    after = forces_on_pile(traction, surface.normals, surface.areas, surface.positions)
    assert part_forces(after, surface.parts, 2)[:, 1] == pytest.approx(
        part_forces(before, points.part, 2)[:, 1], rel=2e-3
    )


def test_reaction_is_upward_under_pressure_and_pulling_down_soil(site):
    """Soil presses on the base and is dragged down by the shaft: both push the pile up."""
    traction = np.array([[0.0, -100.0], [30.0, 0.0]])
    normals = np.array([[0.0, 1.0], [-1.0, 0.0]])
    places = np.array([[0.2, -2.0], [0.5, -1.0]])
    forces = forces_on_pile(traction, normals, np.array([0.5, 2.0]), places)
    np.testing.assert_array_equal(part_forces(forces, np.array([0, 1]), 2)[:, 1], [50.0, 60.0])


def test_lost_contact_inside_a_part_takes_the_difference_of_its_neighbours(site, build, surface):
    points = build.interface(site)
    lost = np.flatnonzero(points.part == PilePart.SHAFT)[20:23]
    traction, covered = points.traction.copy(), points.covered.copy()
    traction[lost], covered[lost] = 0.0, 0.0
    result = transferred_traction(
        site.ground,
        points._replace(traction=traction, covered=covered),
        surface.positions,
        surface.areas,
        surface.parts,
    )
    expected = geostatic_traction(site.ground, surface.positions, surface.normals)
    assert np.abs(result - expected).max() < 1e-12 * np.abs(expected).max()


def test_base_without_contact_is_named(site, build, surface):
    points = build.interface(site)
    points = points._replace(covered=points.covered * (points.part == PilePart.SHAFT))
    with pytest.raises(ValueError, match="no soil touches the base"):
        transferred_traction(site.ground, points, surface.positions, surface.areas, surface.parts)
