"""Facets have the shear strength of the exact surface that they stand for."""

import numpy as np
import pytest

from install_mpm.exact_patches import strength_shares
from install_mpm.options import Box, ScrewMeshOptions
from install_mpm.screw_pile import Helix, ScrewPile, part_names
from install_mpm.screw_pile_mesh import generate_screw_mesh
from install_mpm.screw_shape import surface_normals
from install_mpm.screw_surface import pile_elements, place_points

BOX = Box(width=2.75, depth=3.0, headroom=0.5)
COARSE, FINER = (ScrewMeshOptions(s, 1.8 * s, 1.6 * s, 1.2, 0.05) for s in (0.25, 0.1))
HELIX = Helix(diameter=1.0, pitch=0.33, thickness=0.12, height=0.45)
PILES = {
    "flat tip": ScrewPile(0.5, 1.2, (HELIX,), 8e3),
    "left hand": ScrewPile(0.5, 1.2, (HELIX,), 8e3, hand="left"),
    "cone, steep plate": ScrewPile(
        0.4, 1.5, (Helix(0.9, 0.6, 0.1, 0.5, turns=1.25),), 8e3, tip_length=0.3
    ),
}


def moments_of_parts(pile, sizes):
    """Moment of a unit traction around the axis along each part, of facets and of patches."""
    mesh = generate_screw_mesh(pile, BOX, sizes)
    elements, part, _ = pile_elements(mesh, pile)
    position, area, _ = place_points(elements, mesh)
    normal = surface_normals(pile, np.repeat(part, 3), position)
    around = np.cross([0.0, 0.0, 1.0], position)
    lever = np.linalg.norm(around - (around * normal).sum(axis=1)[:, None] * normal, axis=1)
    share = strength_shares(pile, elements, part, mesh.reference_nodes)
    number = np.repeat(part, 3)
    names = part_names(pile)
    return {
        names[n]: (float((area * lever)[number == n].sum()),
                   float((area * lever * share)[number == n].sum()))
        for n in np.unique(part)
    }  # fmt: skip


def exact_moments(pile):
    (helix,) = pile.helices
    a, r, winding = pile.shaft_radius, helix.radius, helix.winding
    length = pile.embedment - pile.tip_length + BOX.headroom - helix.thickness * helix.turns
    exact = {
        "shaft": 2.0 * np.pi * a**2 * length,
        "lower face": winding * (r**3 - a**3) / 3.0,
        "upper face": winding * (r**3 - a**3) / 3.0,
        "rim": winding * r**2 * helix.thickness,
    }
    if pile.tip_length:
        exact["cone"] = 2.0 * np.pi / 3.0 * a**2 * np.hypot(a, pile.tip_length)
    else:
        exact["tip"] = 2.0 * np.pi / 3.0 * a**3
    return exact


@pytest.mark.gmsh
@pytest.mark.parametrize("pile", PILES.values(), ids=PILES)
def test_strength_of_every_part_is_that_of_its_exact_surface(pile):
    moments, exact = moments_of_parts(pile, COARSE), exact_moments(pile)
    assert set(exact) < set(moments)
    for name, expected in exact.items():
        assert moments[name][1] == pytest.approx(expected, rel=2e-3), name
    facets = [moments[name][0] / exact[name] - 1.0 for name in exact]
    assert min(facets) < -0.04  # without the shares a coarse mesh is weaker by this much
    for name in ("leading edge", "trailing edge"):
        assert moments[name][0] == moments[name][1]


@pytest.mark.gmsh
def test_shares_tend_to_one_with_the_mesh():
    pile = PILES["flat tip"]
    coarse, finer = (moments_of_parts(pile, sizes) for sizes in (COARSE, FINER))
    for name in ("tip", "shaft", "lower face"):
        (first, exact), (second, _) = coarse[name], finer[name]
        assert abs(second / exact - 1.0) < 0.6 * abs(first / exact - 1.0)
