"""Force and stiffness of interface elements, the gap of a rotating pile, and rigid motion."""

from types import SimpleNamespace

import numpy as np
import pytest

from install_mpm.constitutive import coulomb_interface
from install_mpm.constitutive.parameters import CoulombInterface
from install_mpm.interface import (
    InterfacePoints,
    StepAxes,
    facet_rule,
    global_traction,
    reaction,
    step_axes,
)
from install_mpm.interface_axes import frames
from install_mpm.kernels.interface_force import evaluate_interface
from install_mpm.pile import PileMotion, rigid_displacement

KN, KS, C = 5e4, 8e3, 10.0
N_ELEMENTS, N_POINTS = 3, 3
STATES = {
    "stick": (CoulombInterface(KN, KS, 1e9), 1e-2),
    "slip": (CoulombInterface(KN, KS, C), 1.0),
    "friction": (
        CoulombInterface(KN, KS, C, friction_angle=np.radians(24.0), dilation_angle=0.1),
        1e-3,
    ),
    "open": (CoulombInterface(KN, KS, 1e-3, friction_angle=np.radians(24.0)), 1e-2),
}
SIDES = {"rigid pile": 1, "two sides": 2}


@pytest.fixture(params=[2, 3], ids=["linear", "quadratic"])
def facet_nodes(request):
    return request.param


@pytest.fixture(params=SIDES)
def interface(request, facet_nodes, rng):
    """Interface elements of random place and normal, one of their points inactive."""
    n_nodes = SIDES[request.param] * facet_nodes
    shape_values, weights = facet_rule(facet_nodes, N_POINTS)
    n = N_ELEMENTS * N_POINTS
    nodes = np.array([rng.permutation(12)[:n_nodes] for _ in range(N_ELEMENTS)])
    angle = rng.uniform(0.0, 2.0 * np.pi, n)
    normal = np.column_stack([np.cos(angle), np.sin(angle)])
    traction = rng.normal(size=(n, 2)) * 3.0
    traction[:, 1] = -np.abs(traction[:, 1]) * 20.0
    covered = np.ones(n)
    covered[4] = 0.0
    return SimpleNamespace(
        nodes=nodes,
        shape_values=shape_values,
        covered=covered,
        area=np.tile(weights, N_ELEMENTS) * rng.uniform(0.5, 2.0, n),
        traction=traction,
        axes=StepAxes(frames(normal, 0.1), frames(normal, 0.1), frames(normal, 0.2)),
        pile_displacement=1e-4 * rng.normal(size=(n, 2)),
    )


def evaluate(interface, law, displacement):
    shape = (*interface.nodes.shape, 2)
    force, stiffness = np.empty(shape), np.empty((*shape, *shape[1:]))
    traction = np.empty_like(interface.traction)
    parameters = coulomb_interface.pack(law, np.zeros(len(traction)))
    evaluate_interface(
        interface.nodes, interface.shape_values, interface.area * interface.covered, parameters,
        interface.traction, interface.axes, interface.pile_displacement, displacement, force,
        stiffness, traction,
    )  # fmt: skip
    return SimpleNamespace(force=force, stiffness=stiffness, traction=traction)


def slips(interface, displacement):
    """Pile minus soil in the mid-step frame, (n_elements, n_points, 2): paper, eqs (6)-(9)."""
    n_facet = interface.shape_values.shape[1]
    nodal = displacement[interface.nodes]
    soil = np.einsum("qa,eai->eqi", interface.shape_values, nodal[:, :n_facet])
    own = np.zeros_like(soil)
    if nodal.shape[1] > n_facet:
        own = np.einsum("qa,eai->eqi", interface.shape_values, nodal[:, n_facet:])
    slip = own - soil + interface.pile_displacement.reshape(soil.shape)
    return np.einsum("eqij,eqj->eqi", interface.axes.slip.reshape(N_ELEMENTS, -1, 2, 2), slip)


@pytest.mark.parametrize("state", STATES)
def test_force_is_the_traction_on_both_sides(state, interface, rng):
    law, size = STATES[state]
    displacement = size * rng.normal(size=(12, 2))
    result = evaluate(interface, law, displacement)
    slip = slips(interface, displacement).reshape(-1, 2)
    expected, tangent = np.empty_like(slip), np.empty((len(slip), 2, 2))
    status = np.empty(len(slip), dtype=np.int64)
    coulomb_interface.update_all(
        slip, coulomb_interface.pack(law, np.zeros(len(slip))), interface.traction, expected,
        tangent, status,
    )  # fmt: skip
    if state in ("stick", "slip"):
        assert (status == {"stick": 0, "slip": 1}[state]).all()
    expected[interface.covered == 0.0] = 0.0
    np.testing.assert_allclose(result.traction, expected, atol=1e-10 * np.abs(expected).max())
    on_pile = np.einsum("q,qki,qk->qi", interface.area, interface.axes.traction, expected).reshape(
        N_ELEMENTS, N_POINTS, 2
    )
    share = np.einsum("qa,eqi->eai", interface.shape_values, on_pile)
    n_facet = interface.shape_values.shape[1]
    atol = 1e-10 * np.abs(share).max()
    np.testing.assert_allclose(result.force[:, :n_facet], -share, atol=atol)
    if result.force.shape[1] > n_facet:
        np.testing.assert_allclose(result.force[:, n_facet:], share, atol=atol)


@pytest.mark.parametrize("state", STATES)
def test_stiffness_is_the_derivative_of_the_force(state, interface, rng):
    law, size = STATES[state]
    displacement = size * rng.normal(size=(12, 2))
    result, step = evaluate(interface, law, displacement), 1e-9
    for node, i in np.ndindex(12, 2):
        nudge = np.zeros_like(displacement)
        nudge[node, i] = step
        ends = [evaluate(interface, law, displacement + sign * nudge).force for sign in (1.0, -1.0)]
        derivative = (ends[0] - ends[1]) / (2.0 * step)
        for e, b in np.argwhere(interface.nodes == node):
            column = result.stiffness[e, :, :, b, i]
            np.testing.assert_allclose(column, derivative[e], atol=1e-6 * KN)


def test_only_the_relative_motion_counts(interface, rng):
    """Soil and pile translated alike keep the old traction."""
    law, shift = STATES["stick"][0], np.array([0.3, -0.2])
    together = np.tile(shift, (12, 1))
    n_facet = interface.shape_values.shape[1]
    is_rigid = interface.nodes.shape[1] == n_facet
    interface.pile_displacement = np.tile(shift if is_rigid else 0.0 * shift, (9, 1))
    traction = evaluate(interface, law, together).traction
    expected = np.where(interface.covered[:, None] > 0.0, interface.traction, 0.0)
    np.testing.assert_allclose(traction, expected, atol=1e-9)


@pytest.mark.parametrize("angle", [1e-3, 0.1, 1.0, -0.7])
def test_a_rotating_circle_has_no_gap_in_the_frame_of_the_middle_of_the_step(angle, rng):
    """The chord is normal to the mid-step normal; other frames see a false penetration."""
    direction = rng.uniform(0.0, 2.0 * np.pi, 20)
    radius = 0.7
    normal = -np.column_stack([np.cos(direction), np.sin(direction)])
    chord = rigid_displacement(PileMotion(np.zeros(2), angle), -radius * normal)
    gap = np.einsum("pij,pj->pi", frames(normal, angle / 2.0), chord)[:, 1]
    np.testing.assert_allclose(gap, 0.0, atol=1e-15)
    for other, sign in ((0.0, 1.0), (angle, -1.0)):
        false = np.einsum("pij,pj->pi", frames(normal, other), chord)[:, 1]
        np.testing.assert_allclose(false, sign * radius * (1.0 - np.cos(angle)), rtol=1e-6)


def points_on_circle(direction, radius):
    normal = -np.column_stack([np.cos(direction), np.sin(direction)])
    n = len(normal)
    return InterfacePoints(
        -radius * normal, normal, np.ones(n), np.zeros((n, 2)), np.zeros((n, 5)),
        np.zeros(n, dtype=np.int64), np.ones(n),
    )  # fmt: skip


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0, 1.4])
def test_soil_that_slides_on_a_circle_meets_no_gap_and_the_normal_where_it_is(share, rng):
    """However far the soil turns with the pile; the gap changes by its motion along that normal."""
    radius, angle = 0.7, 0.2
    points = points_on_circle(rng.uniform(0.0, 2.0 * np.pi, 20), radius)
    pile = rigid_displacement(PileMotion(np.zeros(2), angle), points.position)
    soil = rigid_displacement(PileMotion(np.zeros(2), share * angle), points.position)
    swept = np.ones(20, dtype=bool)

    def gap(displacement):
        axes = step_axes(points, swept, angle, pile, displacement)
        return np.einsum("pj,pj->p", axes.slip[:, 1], pile - displacement)

    axes = step_axes(points, swept, angle, pile, soil)
    np.testing.assert_allclose(gap(soil), 0.0, atol=1e-15)
    np.testing.assert_allclose(axes.traction[:, 1], -(points.position + soil) / radius)
    change = 1e-6 * rng.normal(size=soil.shape)
    expected = -np.einsum("pj,pj->p", axes.slip_change[:, 1], change)
    np.testing.assert_allclose((gap(soil + change) - gap(soil - change)) / 2, expected, atol=1e-9)


def test_frames_are_right_handed_rows_of_tangent_and_normal():
    axes = frames(np.array([[1.0, 0.0], [0.0, 1.0]]), 0.0)
    np.testing.assert_allclose(axes[0], [[0.0, 1.0], [1.0, 0.0]])
    np.testing.assert_allclose(axes[1], [[-1.0, 0.0], [0.0, 1.0]])
    quarter = frames(np.array([[1.0, 0.0]]), np.pi / 2.0)
    np.testing.assert_allclose(quarter[0, 1], [0.0, 1.0], atol=1e-15)


def test_rigid_motion_turns_about_the_origin_then_translates(rng):
    position = rng.normal(size=(5, 2))
    motion = PileMotion(np.array([1.0, -2.0]), np.pi / 2.0)
    moved = position + rigid_displacement(motion, position)
    expected = np.column_stack([1.0 - position[:, 1], position[:, 0] - 2.0])
    np.testing.assert_allclose(moved, expected, atol=1e-15)


def test_reaction_is_minus_the_traction_on_the_soil():
    """Compressed shaft and half-covered base: the soil pushes the pile inwards and up."""
    points = InterfacePoints(
        position=np.zeros((2, 2)),
        normal=np.array([[-1.0, 0.0], [0.0, 1.0]]),
        area=np.array([2.0, 3.0]),
        traction=np.array([[0.0, -10.0], [0.0, -4.0]]),
        parameters=np.zeros((2, 7)),
        part=np.array([1, 0]),
        covered=np.array([1.0, 0.5]),
    )
    np.testing.assert_allclose(global_traction(points), [[10.0, 0.0], [0.0, -4.0]])
    np.testing.assert_allclose(reaction(points), [-20.0, 6.0])
    np.testing.assert_allclose(reaction(points, points.part == 0), [0.0, 6.0])
