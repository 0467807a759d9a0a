"""Bodies of revolution: forms, equilibrium at the start, patch test, tangent, convergence."""

import numpy as np
import pytest

from handoff.fe_mesh import FacetTag
from install_mpm.constitutive.elastic import elastic_stress, pack
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic, Tresca, VonMises
from install_mpm.conventions import Kinematics
from install_mpm.ground import Ground
from install_mpm.newton import convergence_order
from service_fe.axisymmetric_forms import AxisymmetricForms
from service_fe.interface_forms import InterfaceForms
from service_fe.load_step import LoadStep
from service_fe.options import Release
from service_fe.problem import ServiceProblem
from service_fe.rigid_pile import PileControl, held, moved
from service_fe.solve import run_programme
from service_fe.step import Unknowns

pytestmark = pytest.mark.dolfinx

AXISYMMETRIC = Kinematics.AXISYMMETRIC
SOIL = HenckyElastic(youngs_modulus=4e6, poissons_ratio=0.3)
CLAYS = {"von_mises": VonMises(4e6, 0.49, 20e3), "tresca": Tresca(4e6, 0.49, 20e3)}
RADIUS, TIP = 0.5, 1.0
PILE_WEIGHT = 18e3 * np.pi * RADIUS**2 * TIP
ADHESIVE = CoulombInterface(normal_stiffness=2e8, shear_stiffness=2e7, adhesion_factor=0.5)


@pytest.fixture(scope="module")
def soil(box_mesh):
    return AxisymmetricForms(box_mesh)


@pytest.fixture(scope="module", params=CLAYS)
def pile_problem(pile_mesh, request):
    """Cylindrical pile wished in place in clay."""
    ground = Ground(unit_weight=18e3, k0=0.8, soil=CLAYS[request.param])
    return ServiceProblem(pile_mesh, ground, ADHESIVE, PILE_WEIGHT, kinematics=AXISYMMETRIC)


@pytest.fixture(scope="module")
def pushed(pile_problem):
    """Pile pushed far into the plastic range."""
    step, state = None, pile_problem.wished_in_place_state()
    for _ in range(3):
        step = pile_problem.solve(state, moved(0.01), guess=step.increment if step else None)
        state = step.state
    return step


def test_strain_of_a_homogeneous_deformation(soil, box_mesh):
    """u_r = 0.3 r, u_z = 0.5 z + 0.2: radial and hoop strain are equal, also at the axis."""
    strain = soil.strain(box_mesh.nodes * [0.3, 0.5] + [0.0, 0.2])
    np.testing.assert_allclose(
        strain, np.tile([0.3, 0.5, 0.3, 0, 0, 0], (len(strain), 1)), atol=1e-14
    )


def test_strain_of_a_linear_shear(soil, box_mesh):
    """u_z = 0.4 r has the engineering shear strain 0.4."""
    strain = soil.strain(np.outer(box_mesh.nodes[:, 0], [0.0, 0.4]))
    np.testing.assert_allclose(strain[:, 3], 0.4 / np.sqrt(2.0), atol=1e-14)
    np.testing.assert_allclose(strain[:, :3], 0.0, atol=1e-14)


def test_volumes_and_areas_are_those_of_the_whole_body(soil, pile_mesh):
    assert soil.integration_volumes.min() > 0.0
    assert soil.integration_volumes.sum() == pytest.approx(np.pi * 2.0**2 * 1.5, rel=1e-14)
    np.testing.assert_allclose(
        soil.weight(np.full(len(soil.integration_volumes), 18e3)).sum(axis=0),
        [0.0, -18e3 * np.pi * 6.0],
        atol=1e-8,
    )
    interface = InterfaceForms(pile_mesh, AXISYMMETRIC)
    is_base = interface.parts == FacetTag.PILE_BASE
    assert interface.areas[is_base].sum() == pytest.approx(np.pi * RADIUS**2, rel=1e-14)
    assert interface.areas[~is_base].sum() == pytest.approx(2.0 * np.pi * RADIUS * TIP, rel=1e-14)


def test_internal_force_is_dual_to_strain(soil, box_mesh):
    rng = np.random.default_rng(2)
    displacement = rng.normal(size=box_mesh.nodes.shape)
    stress = rng.normal(size=(len(soil.integration_volumes), 6))
    work = soil.integration_volumes @ (stress * soil.strain(displacement)).sum(axis=1)
    assert (soil.internal_force(stress) * displacement).sum() == pytest.approx(work, rel=1e-12)


def test_no_deformation_is_without_strain(box_mesh):
    """Only the rigid motion along the axis has no energy: the stiffness lacks one rank."""
    soil = AxisymmetricForms(box_mesh)
    tangent = np.tile(np.eye(6), (len(soil.integration_volumes), 1, 1))
    matrix = soil.stiffness(tangent)
    rows, columns, values = matrix.getValuesCSR()
    dense = np.zeros((soil.n_dofs, soil.n_dofs))
    for row in range(soil.n_dofs):
        part = slice(rows[row], rows[row + 1])
        dense[row, columns[part]] = values[part]
    np.testing.assert_allclose(dense, dense.T, atol=1e-12)
    eigenvalues = np.linalg.eigvalsh(dense)
    assert eigenvalues[0] < 1e-12 * eigenvalues[-1]
    assert eigenvalues[1] > 1e-4 * eigenvalues[-1]


def test_undisturbed_ground_is_in_equilibrium_to_round_off(pile_problem):
    undisturbed = pile_problem.wished_in_place_state()
    assert pile_problem.out_of_balance(undisturbed) < 1e-14
    assert pile_problem.solve(undisturbed, held()).iterations == 0
    assert abs(pile_problem.pile_load(undisturbed)[1]) < 1e-11 * PILE_WEIGHT


def test_patch_of_elastic_soil_takes_a_uniform_stress(box_mesh):
    is_fixed = np.zeros((len(box_mesh.nodes), 2), dtype=bool)
    is_fixed[np.unique(box_mesh.facet_nodes)] = True
    problem = ServiceProblem(
        box_mesh, Ground(0.0, 1.0, SOIL), CoulombInterface(1.0, 1.0), is_fixed=is_fixed,
        kinematics=AXISYMMETRIC,
    )  # fmt: skip
    exact = box_mesh.nodes * [3e-4, -5e-4]
    step = problem.solve(problem.wished_in_place_state(), held(), support_motion=exact)
    np.testing.assert_allclose(step.increment.displacement, exact, atol=1e-14)
    strain, stress = np.array([3e-4, -5e-4, 3e-4, 0.0, 0.0, 0.0]), np.empty(6)
    elastic_stress(strain, pack(SOIL), stress)
    expected = np.tile(np.diag(stress[:3]), (len(step.state.cauchy_stress), 1, 1))
    np.testing.assert_allclose(step.state.cauchy_stress, expected, atol=1e-9 * np.abs(stress).max())
    on_top = box_mesh.nodes[:, 1] > -1e-9
    force = step.support_reaction[on_top, 1].sum()
    assert force == pytest.approx(stress[1] * np.pi * 2.0**2, rel=1e-10)


@pytest.mark.parametrize("is_loaded", [(0, 0, 0), (0, 1, 0)])
def test_tangent_of_the_complete_model_against_finite_differences(pile_problem, pushed, is_loaded):
    """Along Newton's direction the out-of-balance force changes by minus itself: K d = -r.

    With new factors, so that the direction is exact.
    """
    rng = np.random.default_rng(3)
    control = PileControl(
        np.array(is_loaded, dtype=bool), np.array([0.0, -2e-3, 0.0]), np.array([0.0, -3e4, 0.0])
    )
    zero = np.zeros_like(pile_problem.gravity(pushed.state))
    step = LoadStep(
        pile_problem.model, pushed.state, control, zero, pile_problem.gravity(pushed.state)
    )
    trial = step.evaluate(Unknowns(1e-3 * rng.normal(size=zero.shape), np.array([0.0, -5e-3, 0.0])))
    assert np.mean(trial.soil.state_variables[:, 1] > pushed.state.state_variables[:, 1]) > 0.3
    pile_problem.model.solver.forget()
    direction = step.search_direction(trial)
    small = 1e-7 / np.abs(direction).max()
    forward, backward = (
        step.evaluate(
            Unknowns(
                trial.unknowns.displacement + sign * small * direction[:-3].reshape(-1, 2),
                trial.unknowns.motion + sign * small * direction[-3:],
            )
        ).out_of_balance
        for sign in (1.0, -1.0)
    )
    change = (forward - backward) / (2.0 * small)
    error = np.linalg.norm(change + trial.out_of_balance) / np.linalg.norm(trial.out_of_balance)
    assert error < 1e-6


def test_newton_ends_quadratically(pile_problem):
    step = pile_problem.solve(pile_problem.wished_in_place_state(), moved(0.01))
    assert convergence_order(np.array(step.residuals)) >= 1.8


def test_forces_balance_in_the_accepted_state(pile_problem, pushed):
    """Weight of the soil, supports and pile add up to nothing along the axis."""
    from_pile = pushed.pile_load[1] + pile_problem.model.pile_weight[1]
    total = (
        pile_problem.gravity(pushed.state).sum(axis=0)[1]
        + pushed.support_reaction.sum(axis=0)[1]
        + from_pile
    )
    assert abs(total) < 1e-7 * np.linalg.norm(pile_problem.gravity(pushed.state))


def test_loads_of_a_programme_are_those_of_the_pile_itself(pile_problem, pushed):
    result = run_programme(pile_problem, pushed.state, Release(steps=2))
    assert result.curve.head_load[0] == pytest.approx(pushed.head_load, rel=1e-12)
    assert result.curve.head_load[-1] == pytest.approx(0.0, abs=1e-6 * pushed.head_load)
    assert result.curve.displacement[-1] < 0.0


def lame_error(make_structured_mesh, n):
    """Error of the displacement of a thick cylinder (1 m to 2 m) that is widened inside."""
    r, z = np.linspace(1.0, 2.0, n + 1), np.linspace(-1.0, 0.0, n + 1)
    mesh = make_structured_mesh(r, z, lambda middle: FacetTag.SURFACE)
    exact = np.zeros_like(mesh.nodes)
    exact[:, 0] = 1e-3 * (mesh.nodes[:, 0] + 4.0 / mesh.nodes[:, 0])
    is_fixed = np.zeros(mesh.nodes.shape, dtype=bool)
    is_fixed[:, 1] = True  # plane strain
    is_fixed[(mesh.nodes[:, 0] < 1.0 + 1e-9) | (mesh.nodes[:, 0] > 2.0 - 1e-9), 0] = True
    problem = ServiceProblem(
        mesh, Ground(0.0, 1.0, SOIL), CoulombInterface(1.0, 1.0), is_fixed=is_fixed,
        kinematics=AXISYMMETRIC,
    )  # fmt: skip
    step = problem.solve(problem.wished_in_place_state(), held(), support_motion=exact)
    error = (step.increment.displacement - exact)[:, 0]
    return float(np.sqrt(np.mean(error**2))) / np.abs(exact).max()


def test_thick_cylinder_converges_to_lame(make_structured_mesh):
    errors = np.array([lame_error(make_structured_mesh, n) for n in (2, 4, 8, 16)])
    rates = np.log2(errors[:-1] / errors[1:])
    assert rates[-1] > 2.8
    assert errors[-1] < 1e-5


def test_unusable_meshes_are_refused(box_mesh):
    with pytest.raises(ValueError, match="no negative radius"):
        AxisymmetricForms(box_mesh._replace(nodes=box_mesh.nodes - [1.0, 0.0]))
    with pytest.raises(ValueError, match="belong to no cell"):
        AxisymmetricForms(box_mesh._replace(nodes=np.vstack([box_mesh.nodes, [[9.0, 9.0]]])))
    nodes = box_mesh.nodes.copy()
    nodes[box_mesh.cell_nodes[0, 3]] += 0.01
    with pytest.raises(ValueError, match="middle of a straight edge"):
        AxisymmetricForms(box_mesh._replace(nodes=nodes))
