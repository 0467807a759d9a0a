"""A deformable pile: start, a stiff one against the rigid pile, bonded against the interface."""

import numpy as np
import pytest

from handoff.fe_mesh import FacetTag, FEMesh, make_mesh
from handoff.options import HandoffOptions
from handoff.pile_mesh import mesh_of_pile, pile_mesh, with_twins
from handoff.surface import level_surface
from install_mpm.background_mesh import facet_edge_nodes, facets_opposite_vertices
from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.conventions import Kinematics
from install_mpm.ground import Ground
from install_mpm.options import Box
from install_mpm.pile import Pile
from service_fe.along_pile import Levels, levels_of, section_forces
from service_fe.deformable_pile import deformable_model
from service_fe.interface_forms import flat_normals
from service_fe.options import DeformablePile, Displace, Lateral, ServiceNumerics
from service_fe.problem import ServiceProblem
from service_fe.results import without_pile
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


def square_normals(facets):
    return np.array([NORMALS[number] for number in facets.parts], dtype=float).reshape(-1, 3)


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


def square_meshes():
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


@pytest.fixture(scope="module")
def meshes():
    return square_meshes()


def model_of(meshes, modulus, contact="interface", law=ROUGH, ground=GROUND):
    pile = DeformablePile(modulus, 0.3, contact)
    return deformable_model(
        *meshes, pile, ground, law, WEIGHT, kinematics=SPACE, normals=square_normals,
        numerics=ServiceNumerics(),
    )  # fmt: skip


@pytest.fixture(scope="module")
def rigid(meshes):
    return ServiceProblem(
        meshes[0], GROUND, ROUGH, WEIGHT, ServiceNumerics(), kinematics=SPACE,
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
    """E = 200 GPa, 50 000 times the clay's: 1 % in compression and under a load at a height."""
    start = rigid.wished_in_place_state()
    expected = run(rigid, start, PUSH)
    model = model_of(meshes, 200e9)
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


def test_reactions_add_up_to_the_load_and_the_pile_bends_away_from_it(meshes, rigid):
    start = rigid.wished_in_place_state()
    model = model_of(meshes, 200e9)
    push = Lateral("lateral", 5e-3, 5e-3, height=0.5, start="equilibrated", first_step_halvings=0)
    whole = run(model.problem, model.start(start), (push,))
    ground, result = without_pile(whole, 1), whole.programme("lateral")
    assert len(ground.mesh.cell_nodes) == len(meshes[0].cell_nodes) < len(whole.mesh.cell_nodes)
    assert len(ground.programmes[0].state.cauchy_stress) == len(start.cauchy_stress)
    assert not ground.programmes[0].state.material.any()
    along, load = result.along, result.curve.load
    change = along.reaction[-1] - along.reaction[0]
    np.testing.assert_allclose(
        Levels(along.height).lengths @ change,
        -(load[-1] - load[0])[:2],
        rtol=1e-6,
        atol=1e-6 * load[-1, 0],
    )
    assert along.deflection[-1, -1, 0] == along.deflection[-1].max() > 0.0
    assert along.bending_moment[-1, -1, 0] < 0.0  # tension on the side of the load
    assert 0.0 < along.shear_force[-1, -1, 0] < load[-1, 0]


def test_section_forces_of_known_stress(meshes):
    """Uniform shear tau and a pressure that grows with x: V = tau A and M = a I, at every level."""
    model = model_of(meshes, 200e9)
    problem, across = model.problem, 2.0 * HALF
    state = model.start(ServiceProblem(meshes[0], GROUND, ROUGH, WEIGHT, kinematics=SPACE,
                                       normals=square_normals).wished_in_place_state())  # fmt: skip
    is_pile = state.material == 1
    stress = np.zeros_like(state.cauchy_stress)
    stress[is_pile, 0, 2] = stress[is_pile, 2, 0] = 3e3
    stress[is_pile, 2, 2] = 2e3 + 5e3 * problem.integration_positions[is_pile, 0]
    levels = levels_of(problem)
    normal, shear, moment = section_forces(problem, state._replace(cauchy_stress=stress), levels)
    ends = levels.lengths
    assert ends @ normal == pytest.approx(2e3 * across**2 * TIP, rel=1e-9)
    assert ends @ shear[:, 0] == pytest.approx(3e3 * across**2 * TIP, rel=1e-9)
    assert ends @ moment[:, 0] == pytest.approx(5e3 * across**4 / 12.0 * TIP, rel=1e-9)
    np.testing.assert_allclose(shear[:, 0], 3e3 * across**2, rtol=0.1)
    np.testing.assert_allclose(moment[:, 1], 0.0, atol=1e-6 * 5e3)


@pytest.fixture(scope="module")
def half():
    """Half of a wall, or a body of revolution, 1 m wide and 2 m deep: soil, and pile."""
    options = HandoffOptions(size_at_pile=0.2, size_far=1.0)
    mesh = make_mesh(Pile(0.5, 2.0, 0.0), 2.0, Box(4.0, 5.0, 0.5), options, level_surface())
    return mesh, mesh_of_pile(mesh)


def compressions(half, kinematics, law, contact):
    """Head loads of the rigid pile and of one of steel that starts like it."""
    rigid = ServiceProblem(half[0], GROUND, law, WEIGHT, kinematics=kinematics)
    start = rigid.wished_in_place_state()
    model = deformable_model(
        *half, DeformablePile(200e9, 0.3, contact), GROUND, law, WEIGHT, kinematics=kinematics,
        normals=flat_normals,
    )  # fmt: skip
    state = model.start(start)
    assert model.problem.out_of_balance(state) < 1e-12
    pushed = (run(*model, PUSH[:1]) for model in ((rigid, start), (model.problem, state)))
    return [result.programme("compression").curve.head_load for result in pushed]


@pytest.mark.gmsh
@pytest.mark.parametrize("kinematics", [Kinematics.PLANE_STRAIN, Kinematics.AXISYMMETRIC])
def test_steel_pile_of_a_half_model_is_the_rigid_one(half, kinematics):
    rigid, steel = compressions(half, kinematics, ROUGH, "interface")
    assert np.abs(steel - rigid).max() < 1e-3 * rigid.max()


@pytest.mark.gmsh
def test_bonded_pile_is_one_with_a_rough_interface(half):
    """An interface with the whole strength of the clay (alpha = 1) and stiff springs, or none."""
    rough = CoulombInterface(normal_stiffness=1e10, shear_stiffness=1e10, adhesion_factor=1.0)
    interface, bonded = compressions(half, Kinematics.PLANE_STRAIN, rough, "bonded")
    assert np.abs(bonded - interface).max() < 0.01 * interface.max()
