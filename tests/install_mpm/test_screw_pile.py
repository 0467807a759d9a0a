"""The screw pile: surface, mesh, programme, and the first steps of an installation."""

import numpy as np
import pytest
from scipy.integrate import trapezoid

from install_mpm import screw_surface
from install_mpm.background_mesh import cell_quality
from install_mpm.constitutive.parameters import CoulombInterface, VonMises
from install_mpm.conventions import rotation_matrix
from install_mpm.far_field import far_field_mismatch
from install_mpm.ground import Ground
from install_mpm.location import relocate
from install_mpm.material_points import MaterialPoints
from install_mpm.options import Box, Numerics, ScrewMeshOptions
from install_mpm.record import StateFileError
from install_mpm.screw_history import ScrewHistory
from install_mpm.screw_installation import install_screw_pile, step_to
from install_mpm.screw_path import Target, last_way, next_target, way_done
from install_mpm.screw_pile import (
    Helix,
    ScrewPile,
    edge_thickness,
    part_names,
    thickness_at,
)
from install_mpm.screw_pile_mesh import generate_screw_mesh
from install_mpm.screw_programme import (
    Phase,
    Pose,
    ProgrammeError,
    ScrewProgramme,
    corners,
    phase_length,
    phase_motion,
    total_length,
)
from install_mpm.screw_record import plate_volume, weight_of
from install_mpm.screw_setup import geostatic_state, mesh_zones, move_mesh, set_up
from install_mpm.screw_shape import distance_to_parts, surface_normals
from install_mpm.state_file import read_installed_state, write_installed_state
from install_mpm.winding import winding_change

HELIX = Helix(diameter=1.0, pitch=0.33, thickness=0.12, height=0.25)
BOX = Box(width=2.75, depth=3.0, headroom=0.5)
SIZES = ScrewMeshOptions(0.25, 0.45, 0.4, 1.2, 0.05, points_per_direction=1)
STRENGTH, ADHESION = 10e3, 0.5


def pile_of(hand="right", **changes):
    return ScrewPile(0.5, 1.2, (HELIX,), 8e3, hand=hand, **changes)


@pytest.fixture(scope="module", params=["right", "left"])
def pile(request):
    return pile_of(request.param)


@pytest.fixture(scope="module")
def right_pile():
    return pile_of()


@pytest.fixture(scope="module")
def mesh(right_pile):
    return generate_screw_mesh(right_pile, BOX, SIZES)


def places_on(pile, part, n, rng):
    """Random places on a part of the surface, from its parametric form."""
    a, r = pile.shaft_radius, HELIX.radius
    winding = rng.uniform(0.3, HELIX.winding - 0.3, n)
    radius, height = rng.uniform(a, r, n), rng.uniform(-0.5, 0.5, n) * HELIX.thickness
    if part == "tip":
        winding, radius = rng.uniform(0, 2 * np.pi, n), rng.uniform(0.01, a, n)
        level = np.full(n, -pile.embedment)
    elif part == "shaft":
        radius, level = np.full(n, a), rng.uniform(-0.4, 0.0, n)
    else:
        if part in ("leading edge", "trailing edge"):
            winding = np.full(n, 0.0 if part == "leading edge" else HELIX.winding)
        elif part == "rim":
            radius = np.full(n, r)
        else:
            height = np.full(n, (0.5 if part == "upper face" else -0.5) * HELIX.thickness)
        level = pile.leading_level(HELIX) + HELIX.pitch * winding / (2 * np.pi) + height
    polar = pile.sense * winding
    return np.column_stack([radius * np.cos(polar), radius * np.sin(polar), level])


@pytest.mark.parametrize("part", ["tip", "shaft", "lower face", "upper face", "rim",
                                  "leading edge", "trailing edge"])  # fmt: skip
def test_places_on_a_part_belong_to_it_and_have_its_normal(pile, part, rng):
    number = part_names(pile).index(part)
    places = places_on(pile, part, 50, rng)
    distance = distance_to_parts(pile, places)
    np.testing.assert_allclose(distance[:, number], 0.0, atol=1e-12)
    normals = surface_normals(pile, np.full(50, number), places)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0)
    step = 1e-4
    inward = distance_to_parts(pile, places + step * normals)[:, number]
    outward = distance_to_parts(pile, places - step * normals)[:, number]
    np.testing.assert_allclose(inward, outward, rtol=2e-2)  # both sides are as far from it
    sideways = np.cross(normals, rng.normal(size=(50, 3)))
    along = distance_to_parts(pile, places + step * sideways)[:, number]
    assert (along < 5e-3 * step).all()


def test_soil_is_outside(pile, rng):
    """A small way against the normal leads away from the axis, below, above or beside the plate."""
    for part, direction in (("lower face", -1.0), ("upper face", 1.0)):
        places = places_on(pile, part, 20, rng)
        normals = surface_normals(pile, np.full(20, part_names(pile).index(part)), places)
        assert (-normals[:, 2] * direction > 0.9).all()
    edge = places_on(pile, "leading edge", 20, rng)
    ahead = -surface_normals(pile, np.full(20, part_names(pile).index("leading edge")), edge)
    turn = np.cross([0.0, 0.0, -pile.sense], edge)  # the pile is screwed in: the edge goes ahead
    assert ((ahead * turn).sum(axis=1) > 0.0).all()


def test_mesh_conforms_to_every_part(mesh, right_pile):
    elements, part, normals = screw_surface.pile_elements(mesh, right_pile)
    names = part_names(right_pile)
    _, area, facet_normal = screw_surface.place_points(elements, mesh)
    of_part = np.bincount(np.repeat(part, 3), area, len(names))
    a, r, t = right_pile.shaft_radius, HELIX.radius, HELIX.thickness
    face = np.pi * (r**2 - a**2)  # a little more, because it climbs
    for name, exact in (("tip", np.pi * a**2), ("lower face", face), ("upper face", face),
                        ("rim", 2 * np.pi * r * t), ("leading edge", (r - a) * t),
                        ("trailing edge", (r - a) * t)):  # fmt: skip
        assert of_part[names.index(name)] == pytest.approx(exact, rel=0.18)
    assert (np.einsum("pi,pi->p", normals, facet_normal) > 0.4).all()  # corners are tilted
    soil_and_air = np.pi * BOX.width**2 * (BOX.depth + BOX.headroom)
    inside = weight_of(right_pile, right_pile.embedment + BOX.headroom) / right_pile.unit_weight
    assert volume_of(mesh).sum() == pytest.approx(soil_and_air - inside, rel=0.02)
    assert cell_quality(mesh).min() > 0.05


def volume_of(mesh):
    corners = mesh.nodes[mesh.cell_nodes[:, :4]]
    return np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6.0


def test_mesh_follows_the_pile_and_is_wound_back(mesh, right_pile):
    programme = ScrewProgramme((Phase("in", 1.0, 1.0),), 0.02)
    problem = problem_of(mesh, right_pile, programme)
    vertices = np.unique(problem.model.elements.nodes[:, :3])
    on_plate = vertices[np.linalg.norm(mesh.nodes[vertices, :2], axis=1) > 0.3]
    for share in (0.05, 0.3, 1.0):
        whole = phase_motion(right_pile, programme.phases[0])
        pose = Pose(share * whole.advance, share * whole.rotation)
        moved = move_mesh(problem, mesh, pose)
        turn = rotation_matrix(pose.rotation, 3)
        expected = mesh.nodes @ turn.T - [0.0, 0.0, pose.advance]
        np.testing.assert_allclose(moved.nodes[on_plate], expected[on_plate], atol=1e-12)
        assert volume_of(moved).sum() == pytest.approx(volume_of(mesh).sum(), rel=2e-3)
        assert cell_quality(moved).min() > 0.3 * cell_quality(mesh).min()
        radius = np.linalg.norm(mesh.nodes[:, :2], axis=1)
        far = radius > mesh_zones(right_pile, BOX).outer_radius
        far &= np.isin(np.arange(len(far)), mesh.cell_nodes[:, :4])  # mid-sides follow these
        wound = np.radians(30.0) * np.round(pose.rotation / np.radians(30.0))
        back = moved.nodes @ rotation_matrix(-wound, 3).T
        np.testing.assert_allclose(back[far], mesh.nodes[far], atol=1e-12)


def test_mesh_conforms_to_a_tapered_plate():
    """Every facet of the plate is found, though its thickness bends where it begins to thin."""
    tapered = Helix(1.0, 0.33, 0.12, 0.25, edge_thickness=0.06, taper_angle=1.0)
    pile = ScrewPile(0.5, 1.2, (tapered,), 8e3)
    mesh = generate_screw_mesh(pile, BOX, ScrewMeshOptions(0.15, 0.3, 0.4, 1.2, 0.05))
    elements, part, _ = screw_surface.pile_elements(mesh, pile)
    _, area, _ = screw_surface.place_points(elements, mesh)
    names = part_names(pile)
    of_part = np.bincount(np.repeat(part, 3), area, len(names))
    a, r = pile.shaft_radius, tapered.radius
    rim = r * (tapered.thickness * tapered.winding - 0.06 * tapered.taper_angle)
    for name, exact in (
        ("lower face", np.pi * (r**2 - a**2)), ("upper face", np.pi * (r**2 - a**2)),
        ("rim", rim), ("leading edge", 0.06 * (r - a)), ("trailing edge", 0.06 * (r - a)),
    ):  # fmt: skip
        assert of_part[names.index(name)] == pytest.approx(exact, rel=0.05)


ROUNDED = {
    "whole plate": Helix(1.0, 0.33, 0.12, 0.25, edges="rounded"),
    "tapered plate": Helix(
        1.0, 0.33, 0.12, 0.25, edge_thickness=0.06, taper_angle=1.0, edges="rounded"
    ),
}


def places_on_nose(pile, helix, end, n, rng):
    """Random places on a rounded edge, from its parametric form: half circles that climb."""
    along, angle = rng.uniform(0.25, 0.49, n), rng.uniform(-1.5, 1.5, n)
    half = edge_thickness(helix) / 2.0
    ahead, rise = half * np.cos(angle), half * np.sin(angle)
    winding = helix.winding if end == "trailing edge" else 0.0
    onward = ahead if end == "trailing edge" else -ahead
    polar = pile.sense * winding
    level = pile.leading_level(helix) + helix.pitch * (winding + onward / along) / (2 * np.pi)
    across = pile.sense * onward
    return np.column_stack([
        along * np.cos(polar) - across * np.sin(polar),
        along * np.sin(polar) + across * np.cos(polar),
        level + rise,
    ])  # fmt: skip


@pytest.mark.parametrize("hand", ["right", "left"])
@pytest.mark.parametrize("end", ["leading edge", "trailing edge"])
@pytest.mark.parametrize("helix", ROUNDED.values(), ids=ROUNDED)
def test_normal_of_a_rounded_edge_is_the_gradient_of_its_distance(helix, end, hand, rng):
    pile = ScrewPile(0.5, 1.2, (helix,), 8e3, hand=hand)
    number = part_names(pile).index(end)
    places = places_on_nose(pile, helix, end, 50, rng)
    np.testing.assert_allclose(distance_to_parts(pile, places)[:, number], 0.0, atol=1e-12)
    assert (distance_to_parts(pile, places).argmin(axis=1) == number).all()
    outside, step = 5e-3, 1e-6  # of the surface the distance has a bend, so a little away from it
    near = places - outside * surface_normals(pile, np.full(50, number), places)
    normals = surface_normals(pile, np.full(50, number), near)
    gradient = np.column_stack([
        distance_to_parts(pile, near + step * unit)[:, number]
        - distance_to_parts(pile, near - step * unit)[:, number]
        for unit in np.eye(3)
    ])  # fmt: skip
    gradient /= np.linalg.norm(gradient, axis=1)[:, None]
    np.testing.assert_allclose(normals, -gradient, atol=1e-7)


def test_faces_go_over_into_a_rounded_edge_without_a_corner(rng):
    """The plate keeps its thickness; one that thins has the slope of its faces there."""
    helix = ROUNDED["whole plate"]
    pile = ScrewPile(0.5, 1.2, (helix,), 8e3)
    names = part_names(pile)
    along = rng.uniform(0.25, 0.5, 20)
    for face, sign in (("lower face", -0.5), ("upper face", 0.5)):
        level = np.full(20, pile.leading_level(helix) + sign * helix.thickness)
        places = np.column_stack([along, np.zeros(20), level])
        of_face, of_edge = (
            surface_normals(pile, np.full(20, names.index(name)), places)
            for name in (face, "leading edge")
        )
        np.testing.assert_allclose(of_edge, of_face, atol=1e-12)


def test_mesh_conforms_to_rounded_edges():
    """Every facet of the pile is found; two chords in a quarter turn are 3 % short of the arc."""
    helix = ROUNDED["tapered plate"]
    pile = ScrewPile(0.5, 1.2, (helix,), 8e3)
    mesh = generate_screw_mesh(pile, BOX, ScrewMeshOptions(0.06, 0.3, 0.4, 1.2, 0.05))
    elements, part, normals = screw_surface.pile_elements(mesh, pile)
    _, area, facet_normal = screw_surface.place_points(elements, mesh)
    names = part_names(pile)
    of_part = np.bincount(np.repeat(part, 3), area, len(names))
    a, r = pile.shaft_radius, helix.radius
    for name in ("leading edge", "trailing edge"):
        assert of_part[names.index(name)] == pytest.approx(np.pi * 0.03 * (r - a), rel=0.05)
    for name in ("lower face", "upper face"):
        assert of_part[names.index(name)] == pytest.approx(np.pi * (r**2 - a**2), rel=0.05)
    assert (np.einsum("pi,pi->p", normals, facet_normal) > 0.4).all()
    soil_and_air = np.pi * BOX.width**2 * (BOX.depth + BOX.headroom)
    inside = weight_of(pile, pile.embedment + BOX.headroom) / pile.unit_weight
    assert volume_of(mesh).sum() == pytest.approx(soil_and_air - inside, rel=0.02)
    assert cell_quality(mesh).min() > 0.02


def test_volume_of_rounded_edges():
    """Half circles between two cylinders, integrated over the distance from the edge."""
    helix = ROUNDED["whole plate"]
    a, r, half = 0.25, helix.radius, helix.thickness / 2.0
    ahead = half * np.sin(np.linspace(0.0, np.pi / 2.0, 20001))
    width = np.sqrt(r**2 - ahead**2) - np.sqrt(a**2 - ahead**2)
    noses = 2.0 * trapezoid(2.0 * np.sqrt(half**2 - ahead**2) * width, ahead)
    blunt = Helix(1.0, 0.33, 0.12, 0.25)
    assert plate_volume(pile_of(), helix) - plate_volume(pile_of(), blunt) == pytest.approx(
        noses, rel=1e-4
    )


def test_volume_of_a_tapered_plate():
    tapered = Helix(1.0, 0.33, 0.12, 0.25, edge_thickness=0.04, taper_angle=1.0)
    winding = np.linspace(0.0, tapered.winding, 200001)
    mean = trapezoid(thickness_at(tapered, winding), winding)
    assert plate_volume(pile_of(), tapered) == pytest.approx(
        mean * (tapered.radius**2 - 0.25**2) / 2.0, rel=1e-6
    )


# --- programme ------------------------------------------------------------------------------------


def test_a_right_handed_pile_is_screwed_in_by_negative_rotation():
    motion = phase_motion(pile_of(), Phase("in", turns=2.0, advancement_ratio=0.5))
    assert motion.rotation == pytest.approx(-4.0 * np.pi)
    assert motion.advance == pytest.approx(0.33)
    assert phase_motion(pile_of("left"), Phase("in", 2.0, 0.5)).rotation > 0.0


WAY = ScrewProgramme(
    (Phase("in", 1.0, 1.0), Phase("push", advance=0.1), Phase("rest", advance=0.0, steps=2),
     Phase("out", -0.5, 1.0)),
    0.02,
    release=False,
)  # fmt: skip


def history_after(targets, loads=(0.0, 0.0)):
    """What the path reads of a history whose steps have met their targets exactly."""
    columns = [
        [target.pose.advance for target in targets], [target.pose.rotation for target in targets],
        [loads[0]] * len(targets), [loads[1]] * len(targets),
        [target.phase for target in targets], [target.share for target in targets],
    ]  # fmt: skip
    names = ("penetration", "rotation", "crowd_force", "torque", "phase", "phase_share")
    blank = dict.fromkeys(ScrewHistory._fields, np.zeros(len(targets)))
    return ScrewHistory(**{**blank, **dict(zip(names, map(np.array, columns), strict=True))})


def walk(pile, programme, size, loads=(0.0, 0.0)):
    """Targets of all steps of a size, met exactly."""
    targets = [Target(0, 0.0, 0.0, Pose(0.0, 0.0))]
    while True:
        target = next_target(pile, programme, history_after(targets, loads), size)
        if target is None:
            return targets
        targets.append(target)


def test_the_path_goes_through_the_ends_of_the_phases():
    pile = pile_of()
    targets = walk(pile, WAY, 0.02)
    ends = [target.pose for target in targets if target.share == 1.0]
    np.testing.assert_allclose(ends, corners(pile, WAY)[1:], rtol=1e-12)
    assert ends[0].advance == pytest.approx(0.33)
    assert ends[1].advance == ends[2].advance == pytest.approx(0.43)
    assert ends[3] == pytest.approx((0.33 + 0.1 - 0.165, -np.pi))
    assert [target.phase for target in targets] == sorted(target.phase for target in targets)
    assert sum(target.way for target in targets) == pytest.approx(total_length(pile, WAY))
    assert sum(target.phase == 2 for target in targets) == 2  # the rest
    history = history_after(targets)
    assert way_done(pile, WAY, history) == pytest.approx(total_length(pile, WAY))
    assert last_way(pile, WAY, history) == pytest.approx(targets[-1].way)


def test_a_phase_ends_with_a_whole_step_though_sizes_do_not_divide_it():
    pile, programme = pile_of(), ScrewProgramme((Phase("push", advance=0.1),), 0.03, release=False)
    ways = [target.way for target in walk(pile, programme, 0.03)]
    np.testing.assert_allclose(ways, [0.0, 0.03, 0.03, 0.03, 0.01])
    assert len(walk(pile, programme, 0.1 * (1.0 - 1e-10))) == 2  # no stub is left


def test_loads_rise_in_the_steps_of_a_phase_from_those_before():
    pile = pile_of()
    turning = Phase("in", 0.2, crowd_force=50e3, steps=2)
    left = Phase("free", crowd_force=10e3, torque=0.0, steps=4)
    programme = ScrewProgramme((turning, left), 0.05)
    targets = walk(pile, programme, 0.05, loads=(10e3, 4e3))[1:]
    of = {n: [target for target in targets if target.phase == n] for n in range(3)}
    forces = [target.crowd_force for target in of[0]]
    np.testing.assert_allclose(forces[:3], [30e3, 50e3, 50e3])
    assert all(target.torque is None for target in of[0])
    assert phase_length(pile, programme, turning) == pytest.approx(0.2 * np.pi)
    np.testing.assert_allclose([target.torque for target in of[1]], [3e3, 2e3, 1e3, 0.0])
    assert all(target.crowd_force == pytest.approx(10e3) for target in of[1])
    release = [(target.crowd_force, target.torque) for target in of[2]]  # follows the phases
    np.testing.assert_allclose(release, np.outer([0.75, 0.5, 0.25, 0.0], [10e3, 4e3]))
    poses = {target.pose for target in of[1] + of[2]}
    assert poses == {of[0][-1].pose}  # where it was: the rest is found


@pytest.mark.parametrize(
    ("phase", "said"),
    [
        (Phase("in", 1.0, 1.0, advance=0.1), "both"),
        (Phase("in", 1.0, advance=0.1, crowd_force=1e3), "both advance and crowd_force"),
        (Phase("in", 1.0, 1.0, crowd_force=1e3), "both advancement_ratio and crowd_force"),
        (Phase("in", 1.0, crowd_force=1e3, torque=0.0), "both turns and torque"),
        (Phase("in", 1.0), "does not say how far"),
        (Phase("in", 0.0, 1.0), "advancement_ratio without turns"),
        (Phase("in", torque=0.0), "does not say how far"),
    ],
)
def test_phases_that_cannot_be_are_refused(phase, said):
    with pytest.raises(ProgrammeError, match=said):
        phase_motion(pile_of(), phase)


# --- installation ---------------------------------------------------------------------------------


def ground():
    return Ground(soil=VonMises(200 * STRENGTH, 0.49, STRENGTH), unit_weight=8e3, k0=1.0)


def law():
    stiffness = 50 * 200 * STRENGTH
    return CoulombInterface(stiffness, stiffness / 10, adhesion_factor=ADHESION)


def problem_of(mesh, pile, programme):
    return set_up(ground(), pile, law(), BOX, programme, Numerics(tolerance=1e-6), mesh)


@pytest.fixture(scope="module")
def installed(right_pile):
    """States after every step of a few steps."""
    states = []
    install_screw_pile(
        ground(), right_pile, law(), BOX, SIZES,
        ScrewProgramme((Phase("in", 0.03, 1.0),), 0.02), Numerics(tolerance=1e-6), "title = 'x'",
        observe=lambda state, progress: states.append(state),
    )  # fmt: skip
    return states


@pytest.fixture(scope="module")
def history(installed):
    """History up to the last step before the rig lets go."""
    whole = installed[-1].history
    loaded = whole.release_share == 0.0
    return type(whole)(*(field[loaded] for field in whole))


def test_tangential_torque_of_every_part_is_that_of_full_adhesion(history, right_pile):
    """On the exact surface, however coarse its facets are: adhesion times moment of the area."""
    tangential = history.part_torque[-1] - history.part_normal_torque[-1]
    a, r, names = right_pile.shaft_radius, HELIX.radius, part_names(right_pile)
    face, tau = 2.0 * np.pi / 3.0 * (r**3 - a**3), ADHESION * STRENGTH
    climb = np.hypot(1.0, HELIX.pitch / (2.0 * np.pi * r))  # PC3: the rim slips along the helix
    for name, exact in (
        ("tip", 2.0 * np.pi / 3.0 * a**3), ("lower face", face), ("upper face", face),
        ("rim", 2.0 * np.pi * r**2 * HELIX.thickness / climb),
    ):  # fmt: skip
        assert tangential[names.index(name)] == pytest.approx(tau * exact, rel=0.03)


def test_pressure_on_shaft_and_tip_has_no_torque(history, right_pile):
    names = part_names(right_pile)
    for name in ("tip", "shaft"):
        normal = history.part_normal_torque[-1, names.index(name)]
        assert abs(normal) < 1e-9 * abs(history.torque[-1])


def test_resultants_on_the_pile_are_those_of_the_supports(history):
    """All six, to the tolerance: in every step, the first one at rest included."""
    assert (history.far_force_mismatch <= 1e-6).all()
    assert (history.far_moment_mismatch <= 1e-6).all()


def test_partly_filled_cells_have_no_moment(mesh, right_pile):
    """Soil is taken away behind the trailing edge; the soft stress holds what is left in a step."""
    programme = ScrewProgramme((Phase("in", 0.03, 1.0),), 0.03)
    problem = problem_of(mesh, right_pile, programme)
    state = geostatic_state(problem, mesh, SIZES, "title = 'x'")
    edge = [0.375, 0.0, right_pile.leading_level(HELIX) + HELIX.pitch]
    away = np.linalg.norm(state.material_points.position - edge, axis=1)
    stays = (away > 0.3) | ((away > 0.2) & (np.arange(len(away)) % 5 == 0))
    points = MaterialPoints(*(field[stays] for field in state.material_points))
    state = state._replace(material_points=points)
    target = Target(phase=0, share=0.1, way=0.0, pose=Pose(1e-3, -0.02))
    result = step_to(problem, state, target)
    assert result.is_converged
    assert result.counts.partly_filled_cells > 20
    equilibrium = result.equilibrium
    end = mesh.nodes + equilibrium.displacement
    moments = np.cross(end, equilibrium.internal_force)
    assert np.abs(moments.sum(axis=0)).max() < 1e-11 * np.abs(moments).sum()
    loads = equilibrium.reaction + equilibrium.external_force
    assert max(far_field_mismatch(equilibrium.contact, end, loads)) <= 1e-6
    assert equilibrium.newton.mismatch <= 1e-6


def test_work_of_the_rig_is_taken_up_by_interface_and_soil(history):
    taken = history.interface_work + history.soil_work - history.weight_work
    np.testing.assert_allclose(history.rig_work[1:], taken[1:], rtol=1e-3)
    assert (history.interface_work[1:] > 0.0).all()


def test_the_rig_lets_go(installed, history):
    """Torque and crowd force go in equal shares; the pile springs back a little."""
    whole = installed[-1].history
    shares = whole.release_share[len(history.travel) :]
    np.testing.assert_allclose(shares, [0.25, 0.5, 0.75, 1.0])
    radius = HELIX.radius
    loads = np.column_stack([whole.crowd_force, whole.torque / radius])
    before = loads[len(history.travel) - 1]
    expected = (1.0 - shares)[:, None] * before
    error = np.linalg.norm(loads[len(history.travel) :] - expected, axis=1)
    assert (error <= 1e-4 * np.linalg.norm(before)).all()
    back = abs(whole.rotation[-1]) - abs(history.rotation[-1])
    assert -np.radians(2.0) < back < 0.0


def test_mass_is_conserved(installed):
    masses = [state.material_points.mass.sum() for state in installed]
    np.testing.assert_allclose(masses, masses[0], rtol=1e-12)


@pytest.mark.parametrize("step", [1, -3])
def test_a_resumed_installation_is_bit_equal(step, installed, right_pile, tmp_path):
    """From a file, while the rig drives or lets go: every array of the last state is the same."""
    write_installed_state(tmp_path / "state.h5", installed[step], "test")
    resumed = install_screw_pile(
        ground(), right_pile, law(), BOX, SIZES,
        ScrewProgramme((Phase("in", 0.03, 1.0),), 0.02), Numerics(tolerance=1e-6), "title = 'x'",
        resume_from=read_installed_state(tmp_path / "state.h5"),
    )  # fmt: skip
    for group in ("material_points", "background_mesh", "interface", "pile", "history", "control"):
        for name, one, other in zip(
            getattr(resumed, group)._fields, getattr(resumed, group),
            getattr(installed[-1], group), strict=True,
        ):  # fmt: skip
            np.testing.assert_array_equal(one, other, err_msg=f"{group}/{name}")


def test_a_checkpoint_from_before_phases_were_recorded_is_not_resumed(installed, right_pile):
    history = installed[1].history
    old = installed[1]._replace(history=history._replace(phase=np.full_like(history.phase, -1)))
    with pytest.raises(StateFileError, match="older version of screwpile"):
        install_screw_pile(
            ground(), right_pile, law(), BOX, SIZES,
            ScrewProgramme((Phase("in", 0.03, 1.0),), 0.03), Numerics(tolerance=1e-6), "",
            resume_from=old,
        )  # fmt: skip


# --- quality of the state -------------------------------------------------------------------------


def test_winding_undisturbed_ground_back_changes_nothing_and_scattered_stress_it_does(
    mesh, right_pile, rng
):
    problem = problem_of(mesh, right_pile, ScrewProgramme((Phase("in", 1.0, 1.0),), 0.02))
    before, pose = np.radians(-14.0), Pose(0.0, np.radians(-16.0))
    state = geostatic_state(problem, mesh, SIZES, "")
    moved = move_mesh(problem, mesh, pose)
    points, _ = relocate(state.material_points, moved)
    interface = screw_surface.follow(
        state.interface, problem.model.elements, problem.normals, pose.rotation, moved,
        problem.ground, problem.law, problem.strength_share,
    )  # fmt: skip
    none = winding_change(problem, points, moved, interface, np.radians(-15.5), pose)
    assert np.isnan(none).all()
    still = winding_change(problem, points, moved, interface, before, pose)
    weight = 8e3 * np.pi * right_pile.shaft_radius**2 * right_pile.embedment
    assert still.winding_stress_change < 1e-3
    assert abs(still.winding_force_change) < 1e-2 * weight
    pressure = 1e3 * rng.normal(size=len(points.mass))
    scattered = points._replace(
        kirchhoff_stress=points.kirchhoff_stress - pressure[:, None, None] * np.eye(3),
        elastic_log_strain=points.elastic_log_strain
        - pressure[:, None, None] / (200 * STRENGTH / (1 - 2 * 0.49)) * np.eye(3),
    )
    changed = winding_change(problem, scattered, moved, interface, before, pose)
    assert changed.winding_stress_change > 10.0 * still.winding_stress_change
    assert abs(changed.winding_torque_change) > abs(still.winding_torque_change)
    assert changed.winding_energy_change != 0.0


def test_what_is_recorded_of_the_points(history, installed):
    assert (history.mass_error <= 1e-12).all()
    assert (history.volume_error <= 1e-12).all()
    assert history.pressure_scatter[0] < 1e-2 * STRENGTH  # undisturbed
    assert (history.pressure_scatter[1:] > history.pressure_scatter[0]).all()
    assert np.isnan(history.winding_stress_change).all()  # it has turned by less than 15 degrees
    assert history.phase_share[-1] == 1.0
    assert np.isnan(history.advancement_ratio[0])
    np.testing.assert_allclose(history.advancement_ratio[1:], 1.0)
