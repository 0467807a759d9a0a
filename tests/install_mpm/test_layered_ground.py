"""Layers, water table and K0: stress by hand, equilibrium at step zero, soils that stay apart."""

import numpy as np
import pytest

from install_mpm.carriers import integration_points
from install_mpm.cell_fill import cell_geometry, fill_cells
from install_mpm.cells import CellType, reference_cell
from install_mpm.constitutive.parameters import (
    CoulombInterface,
    HenckyElastic,
    MohrCoulomb,
    NeoHookean,
    Tresca,
    VonMises,
)
from install_mpm.conventions import GRAVITY, WATER_UNIT_WEIGHT, Kinematics
from install_mpm.geostatic import first_beyond_strength, geostatic_gradient, undisturbed_state
from install_mpm.ground import (
    Ground,
    GroundError,
    Layer,
    LayeredGround,
    boundary_depths,
    geostatic_stress,
    hydrostatic_pressure,
    material_at,
    soils_of,
    strata,
    undrained_shear_strength,
    unit_weights,
)
from install_mpm.injection import merge
from install_mpm.installation import advance_pile
from install_mpm.installation_setup import geostatic_state, set_up
from install_mpm.mesh_generation import generate_background_mesh
from install_mpm.options import BackgroundMeshOptions, Box, InstallationProgramme, Numerics
from install_mpm.pile import Pile, buried_weight
from install_mpm.seeding import seed_points

CLAY = Tresca(6e6, 0.49, 30e3, 1e3)
SAND = MohrCoulomb(20e6, 0.3, 1e3, np.radians(32.0))
STIFF = NeoHookean(3e5, 0.3)
CELL = reference_cell(CellType.TRI6)
GROUND = LayeredGround(
    (
        Layer("crust", 0.0, 18e3, 0.9, CLAY),
        Layer("sand", 1.25, 20e3, "jaky", SAND),
        Layer("gravel", 2.6, 21e3, 0.6, STIFF),
    ),
    water_table=0.5,
)


def test_strata_end_at_layers_and_at_the_water_table():
    assert [row.layer.name for row in strata(GROUND)] == ["crust", "crust", "sand", "gravel"]
    assert boundary_depths(GROUND) == (0.5, 1.25, 2.6)
    assert soils_of(GROUND) == [CLAY, CLAY, SAND, STIFF]
    buoyant = np.array([0.0, 1.0, 1.0, 1.0]) * WATER_UNIT_WEIGHT
    np.testing.assert_allclose(unit_weights(GROUND), [18e3, 18e3, 20e3, 21e3] - buoyant)
    np.testing.assert_array_equal(material_at(GROUND, np.array([0.3, -0.4, -0.6, -2.0, -9.0])),
                                  [0, 0, 1, 2, 3])  # fmt: skip


def test_stress_by_hand_below_the_water_table():
    """Total stress less pore pressure, from the definition of effective stress."""
    depth = 3.0
    total = 18e3 * 1.25 + 20e3 * 1.35 + 21e3 * 0.4
    pore = hydrostatic_pressure(GROUND, np.array([-depth, 1.0]))
    np.testing.assert_allclose(pore, [1000.0 * GRAVITY * 2.5, 0.0])
    stress = geostatic_stress(GROUND, np.array([-depth]), 1)[0]
    assert stress[1, 1] == pytest.approx(-(total - pore[0]), rel=1e-12)
    np.testing.assert_allclose(np.diag(stress) / stress[1, 1], [0.6, 1.0, 0.6])


def test_k0_of_sand_is_that_of_jaky():
    stress = geostatic_stress(GROUND, np.array([-2.0]), 1)[0]
    assert stress[0, 0] / stress[1, 1] == pytest.approx(1.0 - np.sin(np.radians(32.0)))


def test_one_layer_is_the_same_as_uniform_ground():
    uniform = Ground(18e3, 0.8, VonMises(4e6, 0.49, 20e3, 1e3))
    layered = LayeredGround((Layer("clay", 0.0, 18e3, 0.8, uniform.soil),))
    height = np.linspace(0.5, -6.0, 14)
    for one, many in zip(
        undisturbed_state(uniform, height, 1), undisturbed_state(layered, height, 1), strict=True
    ):
        np.testing.assert_array_equal(one, many)


def test_undrained_strength_is_that_of_the_layer():
    strength = undrained_shear_strength(GROUND, np.array([-1.0, -2.0, -4.0]))
    np.testing.assert_allclose(strength, [31e3, 0.0, 0.0])


@pytest.mark.parametrize(
    ("layers", "water_table", "words"),
    [
        ((), None, "has no layer"),
        ((Layer("a", 1.0, 18e3, 1.0, CLAY),), None, "its top must be the surface"),
        (
            (Layer("a", 0.0, 18e3, 1.0, CLAY), Layer("b", 0.0, 18e3, 1.0, CLAY)),
            None,
            "not below 'a'",
        ),
        (
            (Layer("a", 0.0, 18e3, 1.0, CLAY), Layer("a", 1.0, 18e3, 1.0, CLAY)),
            None,
            "two layers are named 'a'",
        ),
        ((Layer("a", 0.0, 9e3, 1.0, CLAY),), 0.0, "weighs less than water"),
        ((Layer("a", 0.0, 18e3, "jaky", CLAY),), None, "no friction angle"),
    ],
)
def test_ground_that_cannot_be_is_refused(layers, water_table, words):
    with pytest.raises(GroundError, match=words):
        LayeredGround(layers, water_table)


def test_k0_stress_beyond_the_strength_names_layer_and_depth():
    ground = LayeredGround(
        (
            Layer("sand", 0.0, 20e3, "jaky", SAND),
            Layer("clay", 2.0, 18e3, 0.2, Tresca(1e6, 0.4, 3e4)),
        )
    )
    layer, depth = first_beyond_strength(ground, 10.0)
    assert layer.name == "clay"
    assert 0.8 * (40e3 + 18e3 * (depth - 2.0)) / 2.0 == pytest.approx(30e3, rel=0.1)
    assert first_beyond_strength(GROUND, 10.0) is None


@pytest.fixture(scope="module")
def start():
    """Problem and undisturbed state of a pile in layered ground."""
    pile, box = Pile(0.5, 2.0, 18e3), Box(3.0, 4.0, 0.5)
    options = BackgroundMeshOptions(0.25, 1.0)
    law = CoulombInterface(2e8, 2e7, cohesion=5e3)
    mesh = generate_background_mesh(pile, box, options, boundary_depths(GROUND))
    programme = InstallationProgramme(0.1, 0.02)
    problem = set_up(
        GROUND,
        pile,
        box=box,
        law=law,
        mesh_options=options,
        programme=programme,
        numerics=Numerics(),
        mesh=mesh,
    )
    return problem, geostatic_state(problem, mesh, 2, "")


def test_layered_ground_is_in_equilibrium_at_step_zero(start):
    problem, state = start
    after, is_accepted = advance_pile(problem, state, 0.0)
    assert is_accepted
    assert after.history.residual_history[0, 0] < 1e-8


def test_points_take_the_soil_and_the_weight_of_their_layer(start):
    _, state = start
    points = state.material_points
    np.testing.assert_array_equal(points.material, material_at(GROUND, points.position[:, 1]))
    weight = points.mass / points.volume * GRAVITY
    np.testing.assert_allclose(weight, unit_weights(GROUND)[points.material], rtol=1e-12)


def two_soils_in_one_cell(make_grid, shares):
    """A column whose points of one cell are of soil 0 and 1, by ``shares`` of each sub-region."""
    mesh = make_grid(1, 2, width=1.0, depth=1.0)
    ground = LayeredGround(
        (
            Layer("soft", 0.0, 18e3, 0.5, HenckyElastic(1e6, 0.3)),
            Layer("stiff", 0.5, 20e3, 0.7, HenckyElastic(9e6, 0.2)),
        )
    )
    points = seed_points(mesh, CELL, ground, 2)
    own = np.flatnonzero(points.cell == 0)
    material = points.material.copy()
    material[own] = np.tile(shares, 3)
    strain = np.where(material == 1, 1e-3, -2e-3)[:, None, None] * np.eye(3)
    return mesh, ground, points._replace(material=material, elastic_log_strain=strain)


@pytest.mark.parametrize("shares", [(0, 0, 0, 1), (1, 0, 0, 0), (1, 1, 0, 1), (0, 1, 1, 1)])
def test_an_integration_point_takes_the_soil_that_fills_most_of_its_sub_region(make_grid, shares):
    """Whatever the order of the points; and the state of that soil, not a mean of both."""
    mesh, ground, points = two_soils_in_one_cell(make_grid, shares)
    geometry = cell_geometry(mesh, CELL, Kinematics.PLANE_STRAIN)
    fill = fill_cells(points, mesh, CELL, geometry, 0.3)
    level = geostatic_gradient(ground, 1)._replace(strain=np.zeros((2, 3, 3)))
    quadrature, _ = integration_points(points, CELL, geometry, fill, level)
    most = int(np.mean(shares) > 0.5)
    np.testing.assert_array_equal(quadrature.material[:3], most)
    expected = (1e-3 if most else -2e-3) * np.eye(3)
    np.testing.assert_allclose(quadrature.elastic_log_strain[:3], [expected] * 3, atol=1e-15)
    assert quadrature.density[:3].sum() > 0.0


def test_points_of_two_soils_are_never_merged(make_grid):
    mesh, _, points = two_soils_in_one_cell(make_grid, (0, 1, 0, 1))
    geometry = cell_geometry(mesh, CELL, Kinematics.PLANE_STRAIN)
    fill = fill_cells(points, mesh, CELL, geometry, 0.3)
    merged = merge(points, CELL, fill, 3)
    for row in (0, 1):
        before, after = points.material == row, merged.material == row
        assert merged.volume[after].sum() == pytest.approx(points.volume[before].sum())
    assert set(np.unique(np.round(merged.elastic_log_strain[:, 0, 0], 9))) == {-2e-3, 1e-3}


def test_a_pile_below_the_water_table_weighs_less_by_the_water_it_displaces():
    pile = Pile(0.5, 2.0, 18e3)
    dry = buried_weight(pile, 3.0)
    assert dry - buried_weight(pile, 3.0, water_table=1.0) == pytest.approx(0.5 * 2.0 * 9810.0)
    assert buried_weight(pile, 3.0, water_table=4.0) == dry
