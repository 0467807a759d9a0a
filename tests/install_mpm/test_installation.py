"""A short installation on a coarse mesh: start, steps, cuts, resuming, number of threads."""

from types import SimpleNamespace

import h5py
import numpy as np
import pytest

from install_mpm import installation
from install_mpm.cell_fill import cell_geometry
from install_mpm.cells import CellType, reference_cell
from install_mpm.constitutive.parameters import CoulombInterface, HenckyElastic, VonMises
from install_mpm.conventions import Kinematics
from install_mpm.ground import Ground, geostatic_stress
from install_mpm.installation import NotConvergedError, install
from install_mpm.interface import global_traction, reaction
from install_mpm.options import BackgroundMeshOptions, InstallationProgramme, Numerics
from install_mpm.pile import WHOLE_PILE, Pile, PilePart
from install_mpm.state_file import read_installed_state, write_installed_state

pytestmark = pytest.mark.gmsh

LAW = CoulombInterface(200e6, 20e6, adhesion_factor=0.5)
CASE_TEXT = 'title = "short"\n'
CLAY = Ground(18e3, 1.0, VonMises(4e6, 0.49, 20e3))
DEFAULTS = Numerics()


@pytest.fixture(scope="module")
def run(pile, box):
    """Function that installs the pile and returns the final state, all states and what was told."""

    def install_pile(
        penetration=0.1,
        step=0.02,
        *,
        ground=CLAY,
        own_pile=pile,
        rigid_zone=0.25,
        numerics=DEFAULTS,
        resume_from=None,
        kinematics=Kinematics.PLANE_STRAIN,
    ):
        states, told = [], []

        def observe(state, progress):
            states.append(state)
            told.append(progress)

        state = install(
            ground, own_pile, LAW, box, BackgroundMeshOptions(0.25, 1.0, rigid_zone),
            InstallationProgramme(penetration, step), numerics, CASE_TEXT,
            resume_from=resume_from, observe=observe, kinematics=kinematics,
        )  # fmt: skip
        return SimpleNamespace(state=state, states=states, told=told)

    return install_pile


@pytest.fixture(scope="module")
def short(run):
    return run()


def assert_bit_equal(first, second):
    """Every array of two installed states, and the rest of them."""
    for name, record in first._asdict().items():
        other = getattr(second, name)
        if not hasattr(record, "_asdict"):
            assert record == other
            continue
        for field, array in record._asdict().items():
            expected = getattr(other, field)
            assert array.dtype == expected.dtype, f"{name}/{field}"
            np.testing.assert_array_equal(array, expected, err_msg=f"{name}/{field}")


def test_start_is_in_equilibrium(short):
    """The first step moves nothing: K0 ground, no head load, pile as heavy as the soil."""
    first, history = short.states[0], short.state.history
    weight = 18e3 * 4.0 * 5.0
    assert history.residual[0] < 1e-10
    assert history.penetration[0] == 0.0
    assert abs(history.crowd_force[0]) < 1e-8 * weight
    assert history.shaft_force[0] == pytest.approx(0.0, abs=1e-8 * weight)
    assert history.base_force[0] == pytest.approx(2.0 * 0.5 * 2.0 * 18e3, rel=1e-10)
    points = first.material_points
    assert np.abs(points.displacement).max() < 1e-9
    stress = geostatic_stress(CLAY, points.position[:, 1], 1)
    np.testing.assert_allclose(points.kirchhoff_stress, stress, atol=1e-9 * 90e3)


@pytest.mark.parametrize("k0", [0.6, 1.4])
def test_elastic_ground_of_any_k0_starts_in_equilibrium(run, k0):
    ground = Ground(18e3, k0, HenckyElastic(5e6, 0.3))
    history = run(0.0, ground=ground).state.history
    assert history.residual[0] < 1e-10
    assert abs(history.crowd_force[0]) < 1e-8 * 18e3 * 20.0


def test_crowd_force_is_what_the_reaction_exceeds_the_weight(run, pile):
    """A weightless pile wished in place pushes up with the weight of the soil it replaces."""
    light = Pile(pile.half_width, pile.embedment, 0.0)
    history = run(0.0, own_pile=light).state.history
    assert history.crowd_force[0] == pytest.approx(2.0 * 0.5 * 2.0 * 18e3, rel=1e-9)


def test_every_step_converges_quadratically(short):
    history = short.state.history
    np.testing.assert_allclose(history.penetration, np.linspace(0.0, 0.1, 6), atol=1e-15)
    assert (history.residual <= 1e-6).all()
    assert (history.residual <= DEFAULTS.tolerance).all()
    assert not history.cuts.any()
    order = history.convergence_order[1:]
    assert (order >= 1.8).mean() > 0.5
    assert (history.iterations[1:] >= 2).all()
    assert (history.iterations <= 12).all()
    last = [row[~np.isnan(row)][-1] for row in history.residual_history]
    np.testing.assert_array_equal(last, history.residual)


def test_crowd_force_grows_towards_the_bearing_capacity(short):
    """It is monotone, and the base carries between 5 and 14 su more than the weight above it."""
    history = short.state.history
    assert (np.diff(history.crowd_force) > 0.0).all()
    overburden = 18e3 * (2.0 + history.penetration)
    factor = (history.base_force[-1] / 1.0 - overburden[-1]) / 20e3
    assert 5.0 < factor < 14.0
    adhesion = 2.0 * 0.5 * 20e3 * (2.0 + history.penetration[1:])
    np.testing.assert_allclose(history.shaft_force[1:], adhesion, rtol=0.1)


def test_forces_are_those_of_the_whole_pile(short, pile):
    state, history = short.state, short.state.history
    weight = pile.unit_weight * 2.0 * pile.half_width * (2.0 + history.penetration)
    total = history.base_force + history.shaft_force
    np.testing.assert_allclose(history.crowd_force, total - weight, rtol=1e-12, atol=1e-6)
    assert WHOLE_PILE[state.kinematics] * state.pile.reaction[1] == pytest.approx(
        total[-1], rel=1e-12
    )


def test_stored_interface_carries_the_reaction(short):
    """Its active points add up to it, but for the stretch of the shaft in the last step."""
    state = short.state
    assert not state.interface.traction[state.interface.covered == 0.0].any()
    force = reaction(state.interface)
    assert force[1] == pytest.approx(state.pile.reaction[1], rel=5e-3)
    on_shaft = state.interface.part == PilePart.SHAFT
    traction = global_traction(state.interface)[on_shaft & (state.interface.covered > 0.0)]
    np.testing.assert_allclose(traction[:, 1], -10e3, rtol=1e-6)  # full adhesion, downward


def test_mesh_and_interface_follow_the_pile(short, pile):
    state = short.state
    assert state.pile.tip_depth == pytest.approx(2.1)
    on_base = state.interface.part == PilePart.BASE
    np.testing.assert_allclose(state.interface.position[on_base, 1], -2.1, atol=1e-12)
    np.testing.assert_allclose(state.interface.position[~on_base, 0], 0.5, atol=1e-12)
    assert state.interface.position[~on_base, 1].min() > -2.1
    assert state.interface.area[on_base].sum() == pytest.approx(pile.half_width)
    assert state.interface.area[~on_base].sum() == pytest.approx(2.1 + 0.6)


def test_points_are_where_the_state_says(short):
    points, mesh = short.state.material_points, short.state.background_mesh
    corners = mesh.nodes[mesh.cell_nodes[points.cell, :3]]
    xi = points.reference_coordinates
    shares = np.column_stack([1.0 - xi.sum(axis=1), xi])
    np.testing.assert_allclose(
        np.einsum("pv,pvi->pi", shares, corners), points.position, atol=1e-12
    )
    assert shares.min() >= -1e-12
    inside = (points.position[:, 0] < 0.5 - 1e-9) & (points.position[:, 1] > -2.1 + 1e-9)
    assert not inside.any()


def test_soil_is_conserved(short):
    """Mass exactly; volume within what the pile compresses; displaced soil heaves."""
    start, end = (state.material_points for state in (short.states[0], short.state))
    assert end.mass.sum() == pytest.approx(start.mass.sum(), rel=1e-14)
    np.testing.assert_allclose(end.mass.sum() * 9.81, 18e3 * (4.0 * 5.0 - 0.5 * 2.0), rtol=1e-12)
    assert end.volume.sum() == pytest.approx(start.volume.sum(), rel=2e-3)
    near_surface = (end.position - end.displacement)[:, 1] > -0.3
    assert end.displacement[near_surface, 1].max() > 0.005


def test_points_are_admissible(short):
    points = short.state.material_points
    mean = np.trace(points.kirchhoff_stress, axis1=1, axis2=2) / 3.0
    deviator = points.kirchhoff_stress - mean[:, None, None] * np.eye(3)
    norm = np.sqrt((deviator**2).sum(axis=(1, 2)))
    assert (norm <= np.sqrt(2.0) * 20e3 * (1.0 + 1e-9)).all()
    assert (points.state_variables[:, 1] > 0.0).any()


def test_observer_is_told_every_accepted_step(short):
    assert [progress.load_step for progress in short.told] == list(range(6))
    for progress, state in zip(short.told, short.states, strict=True):
        assert progress.penetration == state.pile.penetration
        assert progress.crowd_force == state.history.crowd_force[-1]
        assert progress.iterations == state.history.iterations[-1]
        assert progress.target == 0.1
        assert len(state.history.penetration) == progress.load_step + 1
    assert short.states[-1] is short.state


def test_states_given_to_the_observer_are_not_changed_later(run, short):
    """A state that an observer keeps is a checkpoint, however long the run goes on."""
    again = run(0.04)
    assert_bit_equal(short.states[2], again.state)


def test_resumed_run_is_bit_equal(run, short, tmp_path):
    """From the file written after two steps to the end: every dataset equals, bit for bit."""
    write_installed_state(tmp_path / "checkpoint.h5", short.states[2], "test")
    checkpoint = read_installed_state(tmp_path / "checkpoint.h5")
    assert_bit_equal(checkpoint, short.states[2])
    resumed = run(resume_from=checkpoint)
    assert [progress.load_step for progress in resumed.told] == [3, 4, 5]
    assert_bit_equal(resumed.state, short.state)
    for name, state in (("resumed", resumed.state), ("short", short.state)):
        write_installed_state(tmp_path / f"{name}.h5", state, "test")
    datasets = [datasets_of(tmp_path / f"{name}.h5") for name in ("resumed", "short")]
    assert datasets[0] == datasets[1]


def datasets_of(path):
    """Bytes of every dataset of a file."""
    found = {}
    with h5py.File(path) as file:
        file.visititems(
            lambda name, item: (
                found.update({name: item[()].tobytes()}) if isinstance(item, h5py.Dataset) else None
            )
        )
    assert len(found) > 30
    return found


def test_finished_run_is_not_continued(run, short):
    resumed = run(resume_from=short.state)
    assert resumed.state is short.state
    assert resumed.told == []


def test_results_do_not_depend_on_the_number_of_threads(run, threads):
    states = []
    for n in (1, 2):
        threads(n)
        states.append(run(0.04).state)
    assert_bit_equal(*states)


def test_failed_step_is_cut_and_the_step_grows_again(run, monkeypatch):
    """The first steps longer than 11 mm fail; after four that converge the step is doubled."""
    take_step, advances = installation.step, []

    def fail_long_steps(points, mesh, interface, motion, *arguments, **keywords):
        advance = -motion.translation[1]
        advances.append(round(float(advance), 6))
        result = take_step(points, mesh, interface, motion, *arguments, **keywords)
        return result._replace(is_converged=advance < 0.011 or len(advances) > 5)

    monkeypatch.setattr(installation, "step", fail_long_steps)
    history = run(0.08).state.history
    assert advances == [0.0, 0.02, 0.01, 0.01, 0.01, 0.01, 0.02, 0.02]
    np.testing.assert_array_equal(history.cuts, [0, 1, 0, 0, 0, 0, 0])
    assert history.penetration[-1] == pytest.approx(0.08)


def test_trial_displacement_is_that_of_the_step_before(run, monkeypatch):
    """In proportion to the advance, also of a shorter last step; the first one starts from rest."""
    take_step, starts, results = installation.step, [], []

    def watched(*arguments, start, **keywords):
        results.append(take_step(*arguments, start=start, **keywords))
        starts.append(start)
        return results[-1]

    monkeypatch.setattr(installation, "step", watched)
    run(0.05)
    assert not starts[0].any()
    assert not starts[1].any()
    for k, share in ((2, 1.0), (3, 0.5)):
        expected = share * results[k - 1].equilibrium.displacement
        np.testing.assert_allclose(starts[k], expected, rtol=1e-12, atol=1e-18)


def test_last_short_step_is_cut_to_less_than_what_is_left(run, monkeypatch):
    """Halving the full step would try the same advance again."""
    take_step, advances = installation.step, []

    def fail_once(points, mesh, interface, motion, *arguments, **keywords):
        advances.append(round(float(-motion.translation[1]), 6))
        result = take_step(points, mesh, interface, motion, *arguments, **keywords)
        return result._replace(is_converged=len(advances) != 3)

    monkeypatch.setattr(installation, "step", fail_once)
    run(0.024)
    assert advances == [0.0, 0.02, 0.004, 0.002, 0.002]


def test_step_that_never_converges_is_an_error_in_one_sentence(run):
    numerics = Numerics(max_iterations=3, max_cuts=1, tolerance=1e-9)
    with pytest.raises(NotConvergedError) as error:
        run(0.5, 0.5, numerics=numerics)
    message = str(error.value)
    assert message.startswith("installation: the step to penetration 0.2500 m does not converge")
    assert "1 halvings" in message
    assert "installation.step" in message


def test_start_out_of_equilibrium_is_an_error(run):
    """K0 stress far beyond the strength: there is no geostatic start, and no step to cut."""
    ground = Ground(18e3, 0.2, VonMises(4e6, 0.49, 2e3))
    with pytest.raises(NotConvergedError, match="K0"):
        run(ground=ground)


def test_without_penetration_the_pile_stays_wished_in_place(run):
    state = run(0.0).state
    assert len(state.history.penetration) == 1
    assert state.pile.tip_depth == 2.0
    assert np.abs(state.material_points.displacement).max() < 1e-9


def test_solvers_agree(run, short):
    other = run(0.04, numerics=Numerics(linear_solver="superlu")).state
    expected = short.states[2].history.crowd_force
    np.testing.assert_allclose(other.history.crowd_force, expected, rtol=1e-6, atol=1e-3)


def test_round_pile_in_axisymmetry(run, pile):
    """Forces are those of the whole pile: adhesion on the shaft, bearing capacity of a circle."""
    ground = Ground(0.0, 1.0, CLAY.soil)
    result = run(0.06, ground=ground, kinematics=Kinematics.AXISYMMETRIC)
    history, radius = result.state.history, pile.half_width
    assert result.state.kinematics == Kinematics.AXISYMMETRIC
    adhesion = 2.0 * np.pi * radius * 10e3 * (2.0 + history.penetration[1:])
    np.testing.assert_allclose(history.shaft_force[1:], adhesion, rtol=0.1)
    assert 5.0 < history.base_force[-1] / (np.pi * radius**2 * 20e3) < 14.0
    weight = np.pi * radius**2 * pile.unit_weight * (2.0 + history.penetration)
    total = history.base_force + history.shaft_force
    np.testing.assert_allclose(history.crowd_force, total - weight, rtol=1e-12, atol=1e-6)
    resumed = run(0.06, ground=ground, resume_from=result.states[1])
    assert_bit_equal(result.state, resumed.state)


def test_round_pile_in_heavy_ground_starts_in_exact_equilibrium(run, pile):
    """Means around the rings integrate weight and linear stress times radius exactly."""
    history = run(0.0, kinematics=Kinematics.AXISYMMETRIC).state.history
    weight = np.pi * pile.half_width**2 * 2.0 * 18e3
    assert history.residual_history[0, 0] < 1e-11
    assert abs(history.crowd_force[0]) < 1e-9 * weight
    assert history.base_force[0] == pytest.approx(weight, rel=1e-9)


def test_cell_volumes_add_up_to_the_box(short):
    geometry = cell_geometry(
        short.state.background_mesh, reference_cell(CellType.TRI6), Kinematics.PLANE_STRAIN
    )
    assert (geometry.volume > 0.0).all()
    assert geometry.volume.sum() == pytest.approx(4.0 * 5.6 - 0.5 * 2.7, rel=1e-12)
