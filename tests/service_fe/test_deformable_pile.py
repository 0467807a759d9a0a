"""A deformable pile: start, a stiff one against the rigid pile, bonded against the interface."""

import numpy as np
import pytest

from handoff.fe_mesh import FacetTag, FEMesh
from handoff.pile_mesh import pile_mesh, with_twins
from install_mpm.background_mesh import facet_edge_nodes, facets_opposite_vertices
from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.conventions import Kinematics
from install_mpm.ground import Ground
from service_fe.deformable_pile import deformable_model
from service_fe.options import DeformablePile, Displace, Lateral, ServiceNumerics
from service_fe.problem import ServiceProblem
from service_fe.solve import run
from workflows.verification.solid_meshes import extruded, grid, quadratic_mesh

pytestmark = pytest.mark.dolfinx

SPACE = Kinematics.THREE_D
SIZE, HALF, TIP = 2.0, 0.4, 0.8
CLAY = VonMises(youngs_modulus=4e6, poissons_ratio=0.45, undrained_shear_strength=20e3)
GROUND = Ground(unit_weight=18e3, k0=0.8, soil=CLAY)
ROUGH = CoulombInterface(normal_stiffness=2e8, shear_stiffness=2e7, adhesion_factor=0.5)
WEIGHT = 1e3
NORMALS = {0: (0, 0, 1), 1: (-1, 0, 0), 2: (1, 0, 0), 3: (0, -1, 0), 4: (0, 1, 0)}
PUSH = (
    Displace("compression", 0.02, 0.01, "equilibrated"),
    Lateral("lateral", 0.02, 0.01, height=0.5, start="equilibrated"),
)


def square_normals(part, _positions):
    return np.array([NORMALS[number] for number in part], dtype=float).reshape(-1, 3)


def tags_of(centres):
    """Of a square pile around the axis, one part for its base and each of its four sides."""
    x, y, z = centres.T
    tags = np.full(len(centres), int(FacetTag.SIDE))
    tags[np.abs(z) < 1e-9] = FacetTag.SURFACE
    tags[np.abs(z + SIZE) < 1e-9] = FacetTag.BOTTOM
    inside = (np.maximum(np.abs(x), np.abs(y)) < HALF + 1e-9) & (z > -TIP - 1e-9) & (z < -1e-9)
    tags[inside & (np.abs(z + TIP) < 1e-9)] = 0
    for part, (axis, side) in enumerate(((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)), start=1):
        tags[inside & (np.abs(centres[:, axis] - side * HALF) < 1e-9)] = part
    return tags


@pytest.fixture(scope="module")
def meshes():
    """A square pile of 0.8 m, 0.8 m deep, in a cube of 2 m: the soil, and the pile itself."""
    across = np.array([-1.0, -HALF, 0.0, HALF, 1.0])
    solid = extruded(grid(across, across), np.array([-SIZE, -1.3, -TIP, -0.4, 0.0]))
    x, y, z = solid.centroids.T
    is_pile = (np.maximum(np.abs(x), np.abs(y)) < HALF) & (z > -TIP)
    around = quadratic_mesh(solid, ~is_pile)
    cell, facet = np.argwhere(around.cell_neighbours < 0).T
    corners = facets_opposite_vertices(around.cell_nodes[:, :4])[cell, facet]
    facets = np.hstack([corners, facet_edge_nodes(around, cell, facet)])
    tags = tags_of(around.nodes[corners].mean(axis=1))
    soil = FEMesh(around.nodes, around.cell_nodes, facets, tags)
    inside = quadratic_mesh(solid, is_pile)
    vertices, cells = np.unique(inside.cell_nodes[:, :4], return_inverse=True)
    pile = pile_mesh(inside.nodes[vertices], cells.reshape(-1, 4))
    return soil, with_twins(pile, soil)


def model_of(meshes, modulus, contact="interface", law=ROUGH, ground=GROUND):
    pile = DeformablePile(modulus, 0.3, contact)
    return deformable_model(
        *meshes, pile, ground, law, WEIGHT, kinematics=SPACE, normals=square_normals,
        numerics=ServiceNumerics(tolerance=1e-10),
    )  # fmt: skip


@pytest.fixture(scope="module")
def rigid(meshes):
    return ServiceProblem(
        meshes[0], GROUND, ROUGH, WEIGHT, ServiceNumerics(tolerance=1e-10), kinematics=SPACE,
        normals=square_normals,
    )  # fmt: skip


@pytest.mark.parametrize("contact", ["interface", "bonded"])
def test_pile_starts_in_equilibrium_with_the_load_of_the_rigid_one(meshes, rigid, contact):
    ground_state = rigid.wished_in_place_state()
    model = model_of(meshes, 200e9, contact)
    state = model.start(ground_state)
    assert model.problem.out_of_balance(state) < 1e-12
    np.testing.assert_allclose(
        model.problem.pile_load(state), rigid.pile_load(ground_state), rtol=1e-9, atol=1e-6
    )
    n_soil = len(ground_state.material)
    np.testing.assert_array_equal(state.cauchy_stress[:n_soil], ground_state.cauchy_stress)
    assert np.abs(state.cauchy_stress[n_soil:]).max() > 1e3


def test_stiff_pile_is_the_rigid_one(meshes, rigid):
    """E = 1e4 GPa: loads and motions within 1 % in compression and under a load at a height."""
    start = rigid.wished_in_place_state()
    expected = run(rigid, start, PUSH)
    model = model_of(meshes, 1e13)
    found = run(model.problem, model.start(start), PUSH)
    for name in ("compression", "lateral"):
        here, there = found.programme(name).curve, expected.programme(name).curve
        for field in ("load", "motion"):
            computed, reference = getattr(here, field), getattr(there, field)
            assert np.abs(computed - reference).max() < 0.01 * np.abs(reference).max()


def test_soft_pile_gives_way(meshes, rigid):
    start = rigid.wished_in_place_state()
    model = model_of(meshes, 20e6)
    soft = run(model.problem, model.start(start), PUSH[:1]).programme("compression").curve
    stiff = run(rigid, start, PUSH[:1]).programme("compression").curve
    assert soft.head_load[-1] - soft.head_load[0] < 0.9 * (stiff.head_load[-1] - stiff.head_load[0])


def test_reactions_and_section_forces_balance_the_lateral_load(meshes, rigid):
    """The soil takes the load of the head; the shear force falls from it to nothing at the tip."""
    start = rigid.wished_in_place_state()
    model = model_of(meshes, 200e9)
    push = Lateral("lateral", 5e-3, 5e-3, height=0.5, start="equilibrated", first_step_halvings=0)
    result = run(model.problem, model.start(start), (push,)).programme("lateral")
    along, load = result.along, result.curve.load
    lengths = np.diff(along.height).mean() * np.array([0.5, *[1.0] * (len(along.height) - 2), 0.5])
    change = along.reaction[-1] - along.reaction[0]
    np.testing.assert_allclose(
        lengths @ change, -(load[-1] - load[0])[:2], rtol=1e-6, atol=1e-6 * load[-1, 0]
    )
    assert along.shear_force[-1, -1, 0] == pytest.approx(load[-1, 0], rel=0.2)
    assert abs(along.shear_force[-1, 0, 0]) < 0.5 * load[-1, 0]
    assert along.deflection[-1, -1, 0] == pytest.approx(along.deflection[-1].max())
    assert along.bending_moment[-1, -1, 0] * along.deflection[-1, -1, 0] < 0.0
